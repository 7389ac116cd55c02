"""Sand seas, on the CPU: float64 twin of ``dunes.wesl``."""

from __future__ import annotations

import numpy as np

from ..pattern import missing, smoothstep, speckle, threshold
from ..steepness import slopes_within
from .cover import Covers, Sites

PALETTE = ("sand", "gravel", "shrubs", "soil", "sandstone", "mud")

ORANGE, PALE = np.array([0.400, 0.235, 0.118]), np.array([0.470, 0.340, 0.210])
GRAVEL, CRUST = np.array([0.260, 0.190, 0.130]), np.array([0.310, 0.220, 0.145])
SCRUB, CLAY = np.array([0.120, 0.108, 0.062]), np.array([0.360, 0.300, 0.225])


def cover(site: Sites) -> Covers:
    """What covers places."""
    east, north, step = np.broadcast_arrays(
        *(np.asarray(x, float) for x in (site.east, site.north, site.step))
    )

    slope, uneven = slopes_within(site.normal, site.slope)

    def noise(power, number):
        return speckle(east, north, power, step, site.seed + number)

    broad, wide, middle, small, fine = (noise(power, 641 + i) for i, power in enumerate((12, 10, 7, 5, 2)))
    lost_wide, lost_middle, lost_small = (missing(power, step) for power in (10, 7, 5))

    # the older sand is the redder; slip faces and crests show what the wind has just brought
    age = np.clip(0.5 + 1.0 * broad + 0.5 * wide - 0.06 * site.relief, 0.0, 1.0)
    hollow = 0.12 - slope + 0.1 * site.hollow - 0.35 * site.relief
    rough = uneven + 0.01 * lost_wide + 0.01 * lost_middle
    flat = threshold(hollow + 0.1 * wide + 0.1 * middle, 0.08, 0.06, rough)
    clay = flat * threshold(wide + 0.5 * middle, 0.30, 0.1, lost_wide + 0.25 * lost_middle)
    stony = flat * threshold(
        middle + 0.6 * small - wide, 0.0, 0.25, lost_middle + 0.36 * lost_small + lost_wide
    )
    scrub = (0.1 + 0.25 * flat) * threshold(
        small + middle + 0.5 * wide, 0.32, 0.1, lost_small + lost_middle + 0.25 * lost_wide
    )
    shore = smoothstep(-1.2, -0.2, site.water)

    dry = 1.0 - shore
    shrubs = dry * (1.0 - clay) * scrub
    mud = dry * clay + shore
    gravel = np.maximum((1.0 - shrubs - mud) * stony, 0.0)
    crust = np.maximum(1.0 - shrubs - mud - gravel, 0.0) * 0.3 * flat
    sand = np.maximum(1.0 - shrubs - mud - gravel - crust, 0.0)
    shares = (sand, gravel, shrubs, crust, 0.0 * sand, mud)

    grain = (1.0 + 0.12 * middle + 0.1 * small + 0.08 * fine)[..., None]
    tint = sand[..., None] * (PALE + (ORANGE - PALE) * age[..., None]) * grain
    tint = tint + gravel[..., None] * GRAVEL * (1.0 + 0.4 * small)[..., None] + crust[..., None] * CRUST
    tint = tint + shrubs[..., None] * SCRUB + mud[..., None] * CLAY
    growth = 0.2 * shrubs
    return Covers(np.stack(np.broadcast_arrays(*shares), -1), tint, shore, growth)
