"""What of the heavens is in the picture."""

from __future__ import annotations

from math import hypot, sqrt

import numpy as np


def in_sight(view: np.ndarray, direction: np.ndarray, radius: float) -> bool:
    """Whether a square about a direction may touch the picture.

    Parameters
    ----------
    view : record of `View`
    direction : (3,) unit vector, world axes
    radius : half the square's width at distance 1; a few pixels are added
    """
    # plain numbers, for NumPy takes longer with so few; rows of the matrix that makes x, y, z, w
    x, y, _, w = zip(*view["clip_from_world_still"].tolist()[:3], strict=True)
    east, north, up = direction.tolist()
    reach = sqrt(2.0) * (radius + 4.0 * float(view["pixel_angle"]))
    for row in (x, y):
        for sign in (1.0, -1.0):  # normals of the sides of what the camera sees, inward
            a, b, c = w[0] + sign * row[0], w[1] + sign * row[1], w[2] + sign * row[2]
            if a * east + b * north + c * up + reach * hypot(a, b, c) <= 0.0:
                return False
    return True
