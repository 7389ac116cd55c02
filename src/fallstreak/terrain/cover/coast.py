"""A coast of limestone, on the CPU: float64 twin of ``coast.wesl``."""

from __future__ import annotations

import numpy as np

from ..pattern import missing, smoothstep, speckle, threshold
from ..steepness import slopes_within
from .cover import Covers, Sites

PALETTE = ("sand", "limestone", "grass", "shrubs", "canopy", "gravel")

SAND, SHINGLE = np.array([0.420, 0.340, 0.235]), np.array([0.250, 0.230, 0.200])
CHALK, STAIN = np.array([0.360, 0.330, 0.275]), np.array([0.200, 0.180, 0.145])
SWARD, STRAW = np.array([0.072, 0.092, 0.032]), np.array([0.135, 0.118, 0.055])
SCRUB, WOODS = np.array([0.058, 0.064, 0.028]), np.array([0.030, 0.042, 0.016])
WEED = np.array([0.060, 0.050, 0.026])
BEACH = 4.5  # m above the water that waves throw sand to


def cover(site: Sites) -> Covers:
    """What covers places."""
    east, north, step = np.broadcast_arrays(
        *(np.asarray(x, float) for x in (site.east, site.north, site.step))
    )

    slope, uneven = slopes_within(site.normal, site.slope)

    def noise(power, number):
        return speckle(east, north, power, step, site.seed + number)

    broad, wide, middle, small, fine, grit = (
        noise(power, 661 + i) for i, power in enumerate((12, 10, 8, 6, 4, 2))
    )
    crack, lost_grit = noise(0, 667), missing(2, step)
    lost_wide, lost_middle, lost_small, lost_fine = (missing(power, step) for power in (10, 8, 6, 4))
    above = np.minimum(-site.water, 1e3)

    rough = 0.6 * uneven + 0.02 * lost_middle + 0.04 * lost_small + 0.09 * (lost_fine + lost_grit)
    value = slope + 0.15 * middle + 0.2 * small + 0.3 * fine + 0.3 * grit
    # bare where waves reach
    rock = threshold(value, 0.84, 0.20, rough)
    washed = smoothstep(6.0, 1.0, above)
    rock = np.maximum(rock, washed * threshold(value, 0.34, 0.1, rough))
    rough = 4.0 * lost_middle + 9.0 * lost_small + step * step * slope**2 / 12.0 / 5.0
    strand = threshold(BEACH - above + 2.0 * middle + 3.0 * small, 0.0, 1.2, rough)
    rough = uneven + 0.04 * (lost_middle + lost_small)
    shingle = threshold(slope + 0.2 * (middle + small), 0.20, 0.08, rough)

    # wind keeps the seaward ground low
    rough = 0.25 * lost_wide + 0.25 * lost_middle + 0.16 * lost_small
    bushy = threshold(
        0.012 * np.minimum(above, 60.0) + 0.5 * (wide + middle) + 0.4 * small - 0.2 * site.hollow,
        0.42,
        0.2,
        rough,
    )
    rough = 0.36 * lost_wide + 0.25 * lost_middle + 0.0625 * lost_small
    value = 0.004 * np.minimum(above, 200.0) + 0.5 * broad + 0.6 * wide + 0.5 * middle + 0.25 * small
    wooded = threshold(value + 0.15 * site.hollow - 0.12 * site.relief, 0.42, 0.15, rough)
    dry = threshold(wide + middle + 0.8 * small, 0.05, 0.3, lost_wide + lost_middle + 0.64 * lost_small)

    soft = 1.0 - rock
    beach = soft * strand
    stones = beach * shingle
    sand = beach - stones
    green = soft - beach
    trees = green * wooded
    shrubs = (green - trees) * bushy * 0.8
    grass = green - trees - shrubs
    shares = (sand, rock, grass, shrubs, trees, stones)

    wet = smoothstep(1.0, 0.1, above + 0.6 * small)
    tone = (1.0 + 0.3 * small + 0.35 * fine + 0.4 * grit + 0.3 * crack)[..., None]
    stain = threshold(middle + small + fine, 0.12, 0.2, lost_middle + lost_small + lost_fine)
    stone = CHALK + (STAIN - CHALK) * (0.6 * stain)[..., None]
    dark = (washed * 0.8 * smoothstep(2.5, 0.5, above))[..., None]
    stone = stone + (WEED - stone) * dark
    sward = SWARD + (STRAW - SWARD) * dry[..., None]
    tint = (
        sand[..., None] * SAND * (1.0 + 0.1 * small + 0.06 * fine)[..., None] + rock[..., None] * stone * tone
    )
    tint = tint + stones[..., None] * SHINGLE * tone
    tint = tint + grass[..., None] * sward * (1.0 + 0.25 * (small + fine))[..., None]
    tint = tint + shrubs[..., None] * SCRUB * (1.0 + 0.4 * (small + fine))[..., None]
    tint = tint + trees[..., None] * WOODS * (1.0 + 0.6 * (small + fine))[..., None]
    growth = trees + 0.4 * shrubs
    return Covers(np.stack(np.broadcast_arrays(*shares), -1), np.maximum(tint, 0.008), wet, growth)
