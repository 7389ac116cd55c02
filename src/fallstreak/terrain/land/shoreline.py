"""What waves make of land that stands in water: float64 twin of ``shoreline.wesl``."""

from __future__ import annotations

import numpy as np

from .erosion import Relief

BEACH, FLAT = (
    9.0,
    0.8,
)  # m above and below the water that waves have levelled; how much of the slope they took
CLIFF, EDGE, BACK = 22.0, 9.0, 200.0  # m: height of cliffs; where they stand; where the land forgets them


def wash(land: Relief, water: float, rocky: np.ndarray) -> tuple[Relief, np.ndarray]:
    """Level a shelf at the water's edge, raise what stands behind it to a cliff where it is `rocky` (0..1).

    Also returns 1 on the beach … 0 away from it. Far above and below the water nothing changes.
    """
    x = land.height - water
    u, v, w = x / BEACH, np.maximum(x, 0.0) / EDGE, x / BACK
    near = 1.0 / (1.0 + u * u)
    foot, far = 1.0 / (1.0 + v * v), 1.0 / (1.0 + w * w)
    cliff = CLIFF * rocky
    height = water + x * (1.0 - FLAT * near * near) + cliff * v * v * foot * far * far
    rise = 1.0 - FLAT * near * near * (1.0 - 4.0 * u * u * near)
    rise = rise + cliff * v * foot * far * far * (2.0 / EDGE * foot - 4.0 / BACK * v * w * far)
    lost = land.lost * rise * rise
    return Relief(height, land.slope_east * rise, land.slope_north * rise, land.crest, lost), near * near
