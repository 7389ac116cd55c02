"""Dust over basalt, on the CPU: float64 twin of ``mars.wesl``."""

from __future__ import annotations

import numpy as np

from ..pattern import missing, speckle, threshold
from .cover import Covers, Sites

PALETTE = ("dust", "sand", "basalt", "scree", "gravel", "soil")

DUST, SAND = np.array([0.330, 0.178, 0.086]), np.array([0.150, 0.088, 0.056])
STONE = np.array([0.130, 0.092, 0.070])


def cover(site: Sites) -> Covers:
    """What covers places."""
    east, north, step, seed = site.east, site.north, np.asarray(site.step, float), site.seed
    wide = speckle(east, north, 12, step, seed + 401)
    middle = speckle(east, north, 9, step, seed + 402)
    small = speckle(east, north, 6, step, seed + 403)
    heaps = speckle(east, north, 3, step, seed + 404)
    pebbles = speckle(east, north, 0, step, seed + 405)
    lost_middle, lost_small, lost_heaps = missing(9, step), missing(6, step), missing(3, step)

    steep = 2.2 * site.slope + 0.12 * site.relief - 0.3 * site.hollow
    noise = 0.8 * middle + 0.7 * small + 0.5 * heaps
    bare = threshold(steep + noise, 0.80, 0.35, 0.64 * lost_middle + 0.49 * lost_small + 0.25 * lost_heaps)
    rubble = 0.64 * lost_small + 0.25 * lost_heaps
    broken = threshold(0.75 - site.slope + 0.8 * small - 0.5 * heaps, 0.0, 0.3, rubble)
    dark = threshold(wide + 0.6 * middle, 0.1, 0.45, missing(12, step) + 0.36 * lost_middle)
    wind = lost_small + 0.64 * lost_middle + 0.81 * lost_heaps
    swept = 0.75 * threshold(small - 0.8 * middle + 0.9 * heaps, 0.22, 0.2, wind)
    crust = 0.35 * threshold(middle - small, 0.1, 0.3, lost_middle + lost_small)

    fine = 1.0 - bare
    loose = fine * (1.0 - swept)
    bright = loose * (1.0 - 0.6 * dark)
    shares = (
        bright * (1.0 - crust),
        loose * 0.6 * dark,
        bare * (1.0 - broken),
        bare * broken,
        fine * swept,
        bright * crust,
    )
    ground = DUST + (0.6 * dark)[..., None] * (SAND - DUST)
    ground = ground + (0.8 * bare + 0.25 * fine * swept)[..., None] * (STONE - ground)
    tint = ground * (1.0 + 0.3 * small + 0.3 * heaps + 0.35 * pebbles)[..., None]
    zero = np.zeros(tint.shape[:-1])
    return Covers(np.stack(np.broadcast_arrays(*shares), -1), tint, zero, zero)
