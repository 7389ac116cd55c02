"""What the shaders of the field are told of a frame: every layer's numbers, and where the camera is in it."""

from __future__ import annotations

from ...gpu import Struct

LAYERS = 8
CLOUD_BYTES = 64
"""Of a record in ``clouds.cells``, see ``cloud.wesl``."""
KNOTS = (0.0, 0.1, 0.25, 0.4, 0.5, 0.65, 0.75, 0.9, 1.0)
"""Coverages at which a layer is calibrated."""
HEIGHTS = 16
"""Equal parts of a layer's heights whose mean extinction is known."""

CLOUD_FIELD = Struct(
    "CloudField",
    [
        ("cells", "array<vec4i, 8>", "camera's cell; layer of the coverage maps or −1; number of models"),
        ("words", "array<vec4u, 8>", "hash words: of the phases (x, y), of this generation (z, w)"),
        ("next", "array<vec4u, 8>", "hash words of the next generation (x, y); first model; seed of patches"),
        ("place", "array<vec4f, 8>", "camera from its cell's corner (x, y), m; cell, m; jitter, cells"),
        ("life", "array<vec4f, 8>", "age of phase 0, 0..1; 1 if clouds age; coverage; clustering"),
        ("size", "array<vec4f, 8>", "least and largest radius, least and largest height, m"),
        ("base", "array<vec4f, 8>", "base, m; its spread, m; extinction, 1/m; direction of the wind, rad"),
        ("bounds", "array<vec4f, 8>", "lowest and highest matter, m; alignment; m over which bases set in"),
        ("axes", "array<vec4f, 8>", "unit vector along the wind; 1/m: of the noise along and across"),
        ("origin", "array<vec4f, 8>", "camera in the noise: coarse along, across; fine along, across"),
        ("noise", "array<vec4f, 8>", "amplitude; width of edges; shear; mean half size of boxes, m"),
        ("look", "array<vec4f, 8>", "shares of the noise's channels"),
        (
            "widening",
            "array<vec4f, 8>",
            "gaps between boxes over a cloud's radius; steps of blobs; nothing (z, w)",
        ),
        ("map", "array<vec4f, 8>", "camera on the coverage map, 0..1 (x, y); 1/m (z, w)"),
        ("knots_low", "array<vec4f, 8>", "clouds needed at knots 1 to 4 of the calibration"),
        ("knots_high", "array<vec4f, 8>", "and at knots 5 to 8"),
        ("blobs_low", "array<vec4f, 8>", "exponents of the opacity of blobs, by size"),
        ("blobs_high", "array<vec4f, 8>", "and of larger ones"),
    ],
)
