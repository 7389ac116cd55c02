"""Where maps lie: float64 on the CPU, in the plane that faces the light."""

from __future__ import annotations

from dataclasses import dataclass
from math import copysign

import numpy as np

MARGIN = 0.1
"""Of a map's reach, by which the camera may leave its middle."""


def basis(key: np.ndarray) -> np.ndarray:
    """Rows (across, along, towards the light) of a right-handed orthonormal basis, (3, 3).

    It depends on the light alone, and turns without a jump as that passes overhead: Duff et al. 2017,
    "Building an Orthonormal Basis, Revisited".
    """
    x, y, z = (float(c) for c in key)
    sign = copysign(1.0, z)
    a = -1.0 / (sign + z)
    b = x * y * a
    return np.array([[1.0 + sign * x * x * a, sign * b, -sign * x], [b, sign + y * y * a, -y], [x, y, z]])


@dataclass(frozen=True, eq=False)
class Window:
    """A box in the light's axes that a map holds.

    Attributes
    ----------
    axes : (3, 3)
        Rows of `basis`.
    middle : (3,)
        In these axes, of world coordinates, m.
    half : (3,)
        Half of its size along each, m.
    """

    axes: np.ndarray
    middle: np.ndarray
    half: np.ndarray

    def rows(self, origin: np.ndarray) -> np.ndarray:
        """(3, 4): texture coordinates u (right), v (down) and depth (1 towards the light) of a position
        relative to `origin`."""
        scale = 0.5 / self.half * np.array([1.0, -1.0, 1.0])
        rows = np.empty((3, 4))
        rows[:, :3] = self.axes * scale[:, None]
        rows[:, 3] = (self.axes @ origin - self.middle) * scale + 0.5
        return rows

    def clip(self, origin: np.ndarray) -> np.ndarray:
        """(4, 4), clip space from positions relative to `origin`, as `View.clip_from_world`."""
        rows = self.rows(origin)
        matrix = np.zeros((4, 4))
        matrix[0] = 2.0 * rows[0]
        matrix[1] = -2.0 * rows[1]
        matrix[2] = rows[2]
        matrix[0, 3] -= 1.0
        matrix[1, 3] += 1.0
        matrix[3, 3] = 1.0
        return matrix

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Window) and all(
            np.array_equal(getattr(self, name), getattr(other, name)) for name in ("axes", "middle", "half")
        )

    def eye(self, camera: np.ndarray) -> np.ndarray:
        """Its middle as seen from a camera, world axes, m: a place that stays while it is kept."""
        return self.axes.T @ self.middle - camera

    def texel(self, texels: int) -> float:
        """Width of a texel, m."""
        return 2.0 * float(self.half[0]) / texels


def about(axes: np.ndarray, centres: np.ndarray, radii: np.ndarray) -> Window:
    """The smallest square window that holds spheres.

    Parameters
    ----------
    centres : (n, 3)
        World axes, m.
    radii : (n,)
        m.
    """
    places = centres @ axes.T
    low, high = (places - radii[:, None]).min(0), (places + radii[:, None]).max(0)
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    # a few texels around, so that no shadow touches the border
    wide = 1.01 * max(half[0], half[1])
    return Window(axes, middle, np.array([wide, wide, 1.01 * half[2]]))


def slice_around(
    axes: np.ndarray,
    camera: np.ndarray,
    rotation: np.ndarray,
    tangents: tuple[float, float],
    near: float,
    far: float,
    above: float,
) -> Window:
    """The window around a slice of the camera's view, as tight as it goes: it changes as the camera turns.

    Parameters
    ----------
    rotation : (3, 3)
        World from camera.
    tangents : of half the horizontal and vertical fields of view
    near, far : m along the view axis
    above : m towards the light, where there may be what throws shadows into it
    """
    corners = np.array(
        [
            (x * tangents[0] * z, y * tangents[1] * z, -z)
            for z in (near, far)
            for x in (-1.0, 1.0)
            for y in (-1.0, 1.0)
        ]
    )
    places = (camera + corners @ rotation.T) @ axes.T
    low, high = places.min(0), places.max(0)
    high[2] += above
    return Window(axes, 0.5 * (low + high), 0.5 * (high - low))
