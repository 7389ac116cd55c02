"""High mountains in summer, on the CPU: float64 twin of ``alpine.wesl``."""

from __future__ import annotations

import numpy as np

from ..pattern import missing, smoothstep, speckle, threshold
from ..steepness import slopes_within
from .cover import Covers, Sites

PALETTE = ("granite", "scree", "turf", "grass", "canopy", "gravel")

GRANITE, LICHEN = np.array([0.168, 0.163, 0.156]), np.array([0.078, 0.075, 0.071])
SCREE, GRAVEL = np.array([0.255, 0.247, 0.234]), np.array([0.240, 0.228, 0.205])
TURF, HEATH = np.array([0.080, 0.092, 0.036]), np.array([0.078, 0.076, 0.037])
MEADOW, WOODS = np.array([0.070, 0.094, 0.030]), np.array([0.026, 0.036, 0.017])
BED, LAYER = 230.0, 47.0  # m, from one bed of rock to the next, and of thinner ones
TREE_LINE, TURF_LINE = 2200.0, 3000.0


def cover(site: Sites) -> Covers:
    """What covers places."""
    east, north, step, height = np.broadcast_arrays(
        *(np.asarray(x, float) for x in (site.east, site.north, site.step, site.height))
    )

    slope, uneven = slopes_within(site.normal, site.slope)

    def noise(power, number):
        return speckle(east, north, power, step, site.seed + number)

    broad, wide, middle, small, fine, grit = (
        noise(power, 601 + i) for i, power in enumerate((12, 10, 8, 6, 4, 2))
    )
    crack, lost_grit = noise(0, 607), missing(2, step)
    lost_wide, lost_middle, lost_small, lost_fine = (missing(power, step) for power in (10, 8, 6, 4))
    lost_broad = missing(12, step)

    told = np.clip(2.0 - 2.0 * step * np.minimum(slope, 4.0) / BED, 0.0, 1.0)
    turns = height / BED + 2.2 * wide + 2.0 * broad + 0.7 * middle
    beds = told * np.sin(2.0 * np.pi * (turns - np.floor(turns)))
    seen = np.clip(2.0 - 4.0 * step * np.minimum(slope, 4.0) / LAYER, 0.0, 1.0)
    turns = height / LAYER + 4.0 * wide + 1.5 * middle + 0.4 * small
    layers = seen * np.sin(2.0 * np.pi * (turns - np.floor(turns)))

    high = (height - TREE_LINE) / 1000.0
    rough = uneven + 0.02 * lost_middle + 0.04 * lost_small + 0.09 * (lost_fine + lost_grit)
    value = (
        slope
        + 0.15 * middle
        + 0.2 * small
        + 0.3 * fine
        + 0.3 * grit
        + 0.25 * high
        - 0.6 * site.hollow
        + 0.25 * beds
    )
    rock = threshold(value, 0.90, 0.16, rough)
    rough = uneven + 0.16 * (lost_middle + lost_small) + 0.09 * lost_fine
    value = slope + 0.3 * high + 0.35 * site.hollow + 0.4 * (middle + small) + 0.3 * fine
    loose = threshold(value, 1.02, 0.15, rough) * smoothstep(0.25, 0.65, value - 0.3 * high)
    rough = 0.16 * (lost_broad + lost_wide + lost_middle + uneven) + 0.09 * lost_small
    value = high + 0.4 * (broad + wide + middle) + 0.3 * small + 0.4 * (slope - 0.4)
    barren = threshold(value, (TURF_LINE - TREE_LINE) / 1000.0, 0.22, rough)

    value = 0.2 * broad + 0.25 * wide + 0.22 * middle + 0.15 * small - 0.06 * np.maximum(site.hollow, 0.0)
    rough = 0.04 * lost_broad + 0.0625 * lost_wide + 0.0484 * lost_middle + 0.0225 * lost_small
    below = threshold(value - high, 0.0, 0.07, rough)
    rough = lost_wide + lost_middle + 0.5 * lost_small + 4.0 * uneven
    glade = threshold(wide + middle + 0.7 * small + 2.0 * (0.3 - slope), 0.34, 0.12, rough)
    alp = threshold(high + 0.15 * middle + 0.1 * wide, -0.25, 0.25, 0.0225 * lost_middle + 0.01 * lost_wide)
    heath = threshold(
        middle + 0.8 * small + 0.8 * fine, 0.12, 0.12, lost_middle + 0.64 * (lost_small + lost_fine)
    )
    flood = threshold(
        0.045 - slope + 0.05 * small + 0.04 * middle,
        0.02,
        0.012,
        uneven + 0.0025 * lost_small + 0.0016 * lost_middle,
    )
    shore = smoothstep(-1.6, -0.4, site.water)

    soft = (1.0 - rock) * (1.0 - shore)
    rubble = (np.maximum(loose - rock, 0.0) + (1.0 - np.maximum(loose, rock)) * barren) * (1.0 - shore)
    green = soft - rubble
    trees = green * below * (1.0 - glade)
    stones = (green - trees) * flood * 0.5 + (1.0 - rock) * shore
    grown = green - trees - (green - trees) * flood * 0.5
    meadow, turf = grown * (1.0 - alp), grown * alp
    shares = (rock, rubble, turf, meadow, trees, stones)

    tone = (1.0 + 0.3 * middle + 0.3 * small + 0.4 * fine + 0.4 * grit + 0.3 * crack)[..., None]
    value = 0.5 * (wide + middle + small + fine) + 0.3 * (beds + layers + site.hollow)
    rough = 0.25 * (lost_wide + lost_middle + lost_small + lost_fine)
    rough = rough + 0.045 * (1.0 - told * told) + 0.045 * (1.0 - seen * seen)
    stain = threshold(value, 0.0, 0.12, rough)
    stone = _mix(GRANITE, LICHEN, stain) * tone
    sward = _mix(TURF, HEATH, heath) * (1.0 + 0.3 * (small + fine))[..., None]
    tint = rock[..., None] * stone + rubble[..., None] * (SCREE * tone)
    tint = tint + turf[..., None] * sward + stones[..., None] * GRAVEL
    tint = tint + meadow[..., None] * (MEADOW * (1.0 + 0.3 * middle + 0.3 * small)[..., None])
    tint = tint + trees[..., None] * (WOODS * (1.0 + 0.6 * small + 0.6 * fine)[..., None])
    wetness = np.maximum(shore, 0.2 * np.maximum(site.hollow, 0.0) * soft)
    growth = trees + 0.12 * below * meadow
    return Covers(np.stack(np.broadcast_arrays(*shares), -1), np.maximum(tint, 0.008), wetness, growth)


def _mix(a, b, t):
    return a + (b - a) * np.asarray(t)[..., None]
