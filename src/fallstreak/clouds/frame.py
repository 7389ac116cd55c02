"""What every pass of the clouds is told of a frame; the field has a uniform of its own (`field`)."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..gpu import Struct
from ..world.state import FrameState, map_coordinates

CLOUD_FRAME = Struct(
    "CloudFrame",
    [
        ("camera_map", "vec2f", "m, camera on the map, east and north of the anchor"),
        ("camera_height", "f32", "m above sea level"),
        ("planet_radius", "f32", "m"),
        ("key", "vec3f", "unit, towards the light that counts: the sun, at night the moon; world axes"),
        ("visibility", "f32", "m"),
        ("time", "f32", "s of scene time, modulo 4096, for what swirls"),
        ("seed", "u32", "of the world"),
    ],
)


def frame_values(state: FrameState, *, visibility: float, key: np.ndarray) -> dict[str, Any]:
    """Every field of `CLOUD_FRAME` for a frame.

    Parameters
    ----------
    visibility : m
    key : (3,), see `world.state.key_light`
    """
    return {
        "camera_map": map_coordinates(state.camera.position, state.planet_radius),
        "camera_height": state.altitude,
        "planet_radius": state.planet_radius,
        "key": key,
        "visibility": visibility,
        "time": state.time % 4096.0,
        "seed": state.seed & 0xFFFFFFFF,
    }
