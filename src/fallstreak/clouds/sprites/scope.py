"""What the passes of the sprites are told: from where clouds are seen, and which of them the ring shows."""

from __future__ import annotations

from ...gpu import Struct
from ..field.uniform import LAYERS

BLOCK = 4000.0
"""Side of a block of clouds, m: a block is in the ring or it is not."""
STEEPEST = 0.38
"""Rise over distance of what a picture of the ring can show."""
LIMIT = 3048.0
"""Clouds so much higher or lower than the camera are not in the ring, m."""

RING_VIEW = Struct(
    "RingView",
    [
        ("height", "f32", "m, the camera's when the ring was begun"),
        ("radius", "f32", "m"),
        ("weight", "f32", "0…1, how much of the ring is to be seen"),
        ("first", "u32", "layer of the first of its pictures"),
        ("middle", "vec3f", "m, its middle, camera-relative, world axes"),
        ("east", "vec3f", "its axes, world axes"),
        ("north", "vec3f", ""),
        ("up", "vec3f", ""),
        (
            "layers",
            f"array<vec4f, {LAYERS}>",
            "camera from the ring's middle, which drifts with the layer, m; 1: may be in the ring",
        ),
    ],
)

SPRITE_SCOPE = Struct(
    "SpriteScope",
    [
        ("shift", "vec2f", "m, added to offsets on the map: from the camera to where clouds are seen from"),
        (
            "slices",
            "vec2f",
            "m, distance of the blocks that the ring is drawn of now, nearest and farthest",
        ),
        ("square", "vec4f", "m, in which they are: west, south, east, north border from the ring's middle"),
        ("behind", "f32", "m, sprites farther than that are drawn before the ring"),
        ("shown", RING_VIEW, "the ring in sight"),
        ("next", RING_VIEW, "the one that is being made, or comes in"),
    ],
)
