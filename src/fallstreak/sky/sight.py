"""What of the heavens is in the picture."""

from __future__ import annotations

from math import sqrt

import numpy as np


def in_sight(view: np.ndarray, direction: np.ndarray, radius: float) -> bool:
    """Whether a square about a direction may touch the picture.

    Parameters
    ----------
    view : record of `View`
    direction : (3,) unit vector, world axes
    radius : half the square's width at distance 1; a few pixels are added
    """
    # stored by columns: x, y, z, w of each world axis
    axes = np.asarray(view["clip_from_world_still"], np.float64)[:3]
    x, y, w = axes[:, 0], axes[:, 1], axes[:, 3]
    inward = np.array([w - x, w + x, w - y, w + y])  # normals of the sides of what the camera sees
    reach = sqrt(2.0) * (radius + 4.0 * float(view["pixel_angle"]))
    return bool((inward @ direction + reach * np.linalg.norm(inward, axis=1) > 0.0).all())
