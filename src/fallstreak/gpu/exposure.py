"""How bright the film is, as shaders see it: the struct `Exposure` of the history buffer `frame.exposure`.

It lies this low in the house because every pass that draws into `frame.hdr` multiplies its luminance by
`scale` of `frame.exposure@previous`, so that half floats hold starlight and the sun's disc alike.
"""

from __future__ import annotations

from .struct import Struct

EXPOSURE = Struct(
    "Exposure",
    [
        ("scale", "f32", "picture value per cd/m²: what the next frame multiplies into frame.hdr"),
        ("ev100", "f32", "the same as an exposure value at ISO 100"),
        ("luminance", "f32", "cd/m², what the meter saw"),
        ("pre_scale", "f32", "picture value per cd/m² that frame.hdr and frame.resolved of this frame hold"),
    ],
)
