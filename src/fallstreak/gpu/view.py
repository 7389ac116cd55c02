"""The camera as shaders see it: the uniform struct that every pass may bind as `view`."""

from __future__ import annotations

from .struct import Struct

VIEW = Struct(
    "View",
    [
        ("clip_from_world", "mat4x4f", "of camera-relative positions, jittered; reverse-Z, infinite"),
        ("world_from_clip", "mat4x4f", "its inverse"),
        ("clip_from_world_still", "mat4x4f", "without the jitter"),
        (
            "previous_clip_from_world",
            "mat4x4f",
            "last frame's, of this frame's camera-relative positions, no jitter",
        ),
        ("up", "vec3f", "local vertical at the camera, world axes"),
        ("altitude", "f32", "m, camera above the sea-level sphere"),
        ("camera", "vec3f", "m, camera in world east-north-up coordinates"),
        ("planet_radius", "f32", "m"),
        ("size", "vec2f", "pixels"),
        ("inverse_size", "vec2f", "1 / pixels"),
        ("jitter", "vec2f", "pixels"),
        ("near", "f32", "m"),
        ("pixel_angle", "f32", "radians per pixel at the centre"),
        ("time", "f32", "s since the scene's start"),
        ("delta_time", "f32", "s since the last frame"),
        ("frame", "u32", "index of the frame"),
        ("seed", "u32", "the world's seed"),
    ],
)
