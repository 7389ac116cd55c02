"""What a system is told of one frame: its time, its seed, its camera; and the geometry of the curved world.

World space is metres, east-north-up at the anchor on the sea-level sphere, float64 on the CPU; the planet's
centre lies at (0, 0, -radius). Map coordinates (east, north) are azimuthal equidistant about the anchor, so
that distances and directions from it are true.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from datetime import datetime
from typing import Any

import numpy as np

NEAR = 0.1
"""Distance of the near plane in metres; the far plane is at infinity."""


@dataclass(frozen=True)
class CameraState:
    """A camera at one moment.

    Attributes
    ----------
    position : (3,) float64
        World coordinates, m.
    rotation : (3, 3) float64
        World from camera; the camera looks along its -z, y is up, x is right.
    fov : float
        Vertical field of view, radians.
    """

    position: np.ndarray
    rotation: np.ndarray
    fov: float
    near: float = NEAR


@dataclass(frozen=True)
class FrameState:
    """One frame of a world.

    Attributes
    ----------
    index : int
        Number of the frame; the random sequence of the frame depends on it and the seed alone.
    time : float
        Simulated seconds since the scene's start.
    utc : datetime
        The same moment as a date, with zone.
    delta : float
        Simulated seconds since the frame before.
    size : (int, int)
        Width and height in pixels.
    camera, previous_camera : CameraState
        Now and in the frame before (the same for stills).
    jitter : (float, float)
        Offset of the sampling points in pixels, right and down.
    sample : int
        Of a still, which of its samples this is.
    seconds, previous_seconds : float
        Of the sequence, now and in the frame before (the same for stills): the clock of keyframes.
    """

    index: int
    time: float
    utc: datetime
    delta: float
    seed: int
    size: tuple[int, int]
    planet_radius: float
    camera: CameraState
    previous_camera: CameraState
    jitter: tuple[float, float] = (0.0, 0.0)
    sample: int = 0
    seconds: float = 0.0
    previous_seconds: float = 0.0
    values: dict[str, object] = field(default_factory=dict, repr=False, compare=False)

    @property
    def altitude(self) -> float:
        """Height of the camera above the sea-level sphere, m."""
        return height_of(self.camera.position, self.planet_radius)


def position_on_planet(east: float, north: float, height: float, radius: float) -> np.ndarray:
    """World coordinates of a place on the map.

    Parameters
    ----------
    east, north : float
        Map coordinates, m.
    height : float
        Above the sea-level sphere, m.
    radius : float
        Of the planet, m.
    """
    distance = float(np.hypot(east, north))
    angle = distance / radius
    unit = np.array([east, north]) / distance if distance > 0 else np.zeros(2)
    across = (radius + height) * np.sin(angle)
    # 1 - cos without cancellation keeps millimetres near the anchor.
    drop = 2.0 * (radius + height) * np.sin(angle / 2.0) ** 2
    return np.array([across * unit[0], across * unit[1], height - drop])


def height_of(position: np.ndarray, radius: float) -> float:
    """Height above the sea-level sphere of world coordinates, m."""
    x, y, z = (float(c) for c in position)
    r = np.sqrt(x * x + y * y + (z + radius) ** 2)
    # (r² - R²) / (r + R) keeps precision where r - R would lose it.
    return float((x * x + y * y + z * (z + 2.0 * radius)) / (r + radius))


def map_coordinates(position: np.ndarray, radius: float) -> tuple[float, float]:
    """Map coordinates (east, north) below world coordinates, m."""
    x, y, z = (float(c) for c in position)
    across = np.hypot(x, y)
    if across == 0.0:
        return 0.0, 0.0
    distance = radius * np.arctan2(across, z + radius)
    return float(x / across * distance), float(y / across * distance)


def local_axes(east: float, north: float, radius: float) -> np.ndarray:
    """Axes of a place on the map, as columns (east, north, up) in world coordinates.

    The anchor's axes carried along the great circle, so that map directions stay map directions.
    """
    distance = float(np.hypot(east, north))
    if distance == 0.0:
        return np.eye(3)
    angle = distance / radius
    s, c = np.sin(angle), np.cos(angle)
    ux, uy = east / distance, north / distance
    along = np.array([ux * c, uy * c, -s])
    up = np.array([ux * s, uy * s, c])
    side = np.array([-uy, ux, 0.0])
    return np.stack([along * ux - side * uy, along * uy + side * ux, up], axis=1)


def camera_rotation(heading: float, pitch: float, roll: float, axes: np.ndarray) -> np.ndarray:
    """World from camera.

    Parameters
    ----------
    heading : float
        Radians clockwise from north.
    pitch, roll : float
        Radians; up and right wing down are positive.
    axes : (3, 3)
        Local axes as `local_axes` gives them.
    """
    forward = np.array([np.sin(heading) * np.cos(pitch), np.cos(heading) * np.cos(pitch), np.sin(pitch)])
    right = np.array([np.cos(heading), -np.sin(heading), 0.0])
    up = np.array([-np.sin(heading) * np.sin(pitch), -np.cos(heading) * np.sin(pitch), np.cos(pitch)])
    c, s = np.cos(roll), np.sin(roll)
    # A right roll tips the camera's up towards its right.
    rolled_right, rolled_up = right * c - up * s, up * c + right * s
    return axes @ np.stack([rolled_right, rolled_up, -forward], axis=1)


def clip_from_camera(
    fov: float, size: tuple[int, int], near: float, jitter: tuple[float, float]
) -> np.ndarray:
    """Reverse-Z projection with an infinite far plane: depth = near / distance, 0 infinitely far."""
    width, height = size
    f = 1.0 / np.tan(fov / 2.0)
    return np.array(
        [
            [f * height / width, 0.0, 2.0 * jitter[0] / width, 0.0],
            [0.0, f, -2.0 * jitter[1] / height, 0.0],
            [0.0, 0.0, 0.0, near],
            [0.0, 0.0, -1.0, 0.0],
        ]
    )


def view_values(state: FrameState) -> dict[str, object]:
    """The fields of the `View` uniform for a frame; matrices are computed in float64."""
    camera, before = state.camera, state.previous_camera
    still = clip_from_camera(camera.fov, state.size, camera.near, (0.0, 0.0))
    jittered = clip_from_camera(camera.fov, state.size, camera.near, state.jitter)
    previous = _from_world(clip_from_camera(before.fov, state.size, before.near, (0.0, 0.0)), before)
    # Camera-relative positions of now, shifted to be relative to the camera before.
    previous[:, 3] += previous[:, :3] @ (camera.position - before.position)
    centre = camera.position + np.array([0.0, 0.0, state.planet_radius])
    width, height = state.size
    return {
        "clip_from_world": _from_world(jittered, camera),
        "world_from_clip": _to_world(jittered, camera),
        "clip_from_world_still": _from_world(still, camera),
        "previous_clip_from_world": previous,
        "up": centre / np.linalg.norm(centre),
        "altitude": state.altitude,
        "camera": camera.position,
        "planet_radius": state.planet_radius,
        "size": state.size,
        "inverse_size": (1.0 / width, 1.0 / height),
        "jitter": state.jitter,
        "near": camera.near,
        "pixel_angle": 2.0 * np.tan(camera.fov / 2.0) / height,
        "time": state.time,
        "delta_time": state.delta,
        "frame": state.index & 0xFFFFFFFF,
        "seed": state.seed & 0xFFFFFFFF,
    }


def _from_world(clip_from_camera: np.ndarray, camera: CameraState) -> np.ndarray:
    """Clip space from world axes about the camera."""
    matrix = clip_from_camera.copy()
    matrix[:, :3] = clip_from_camera[:, :3] @ camera.rotation.T
    return matrix


def _to_world(p: np.ndarray, camera: CameraState) -> np.ndarray:
    """The inverse of `_from_world`, written down: the projection has six entries."""
    inverse = np.zeros((4, 4))
    inverse[0, 0], inverse[0, 3] = 1.0 / p[0, 0], p[0, 2] / p[0, 0]
    inverse[1, 1], inverse[1, 3] = 1.0 / p[1, 1], p[1, 2] / p[1, 1]
    inverse[2, 3] = -1.0
    inverse[3, 2] = 1.0 / p[2, 3]
    inverse[:3] = camera.rotation @ inverse[:3]
    return inverse


def key_light(light: Any, up: np.ndarray) -> np.ndarray:
    """Unit direction towards sun or moon, whichever throws shadows and lights the clouds.

    Clouds twelve kilometres up lose the sun when it stands some 3.5 degrees under the horizon; the moon takes
    over later, where neither shows.

    Parameters
    ----------
    light : record of the uniform ``sky.light``
    up : (3,), the vertical at the camera
    """
    sun = np.asarray(light["sun_direction"], np.float64)
    moon = np.asarray(light["moon_direction"], np.float64)
    moonlit = float(np.asarray(light["moon_illuminance"])[1]) > 0.0
    return moon if float(up @ sun) < np.sin(np.radians(-7.0)) and moonlit else sun
