"""What shadows are told of a frame."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ..gpu import Struct
from ..world.state import key_light, map_coordinates

if TYPE_CHECKING:
    from ..world.state import FrameState

SHADOWS = Struct(
    "Shadows",
    [
        ("key", "vec3f", "unit, world axes, towards the light that throws shadows"),
        ("moonlit", "f32", "1: that light is the moon's, 0: the sun's"),
        ("camera", "vec2f", "rad, the camera on the map over the planet's radius"),
        ("contact", "f32", "m, length of contact shadows"),
        ("turn", "f32", "of noise: another in each frame and sample"),
    ],
)


def shadow_values(state: FrameState, light: Any, contact: float) -> tuple[dict[str, Any], np.ndarray]:
    """Every field of `SHADOWS` for a frame, and the key light's direction in float64.

    Parameters
    ----------
    light : record of the uniform ``sky.light``
    contact : m
    """
    centre = state.camera.position + np.array([0.0, 0.0, state.planet_radius])
    key = key_light(light, centre / np.linalg.norm(centre))
    moonlit = bool(np.array_equal(key, np.asarray(light["moon_direction"], np.float64)))
    east, north = map_coordinates(state.camera.position, state.planet_radius)
    values = {
        "key": key,
        "moonlit": float(moonlit),
        "camera": (east / state.planet_radius, north / state.planet_radius),
        "contact": contact,
        "turn": float((state.index + state.sample) % 64),
    }
    return values, key
