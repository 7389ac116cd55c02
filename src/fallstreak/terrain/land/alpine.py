"""Mountains that ice and water have shaped: float64 twin of ``alpine.wesl``."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..octaves import wide
from ..pattern import smoothstep
from .erosion import Relief, fill
from .ridges import bluntness, couloirs, crags, fold, ledges
from .shape import LandShape
from .shoreline import wash

MASSIF = (0.55, 0.3)  # amplitudes of the large forms over the relief, each half as long as the last
RANGE, SPUR = 1.1, 0.75  # the same of the ranges' ridges and of those that leave them, half as long again
CREST = 0.26  # of a ridge's amplitude: how high it stands above the mean
BEND, WIND = 0.6, 0.3  # how far larger forms push ridges aside
FLOOR, SAG, SILL = 0.45, 0.5, 0.03  # of the relief: depth of valley floors, how far they follow, their edge
COARSEST_COULOIR, FINEST_COULOIR = -2, 6  # the first counts from the large forms' power of two
COULOIR, COULOIR_FINER, SOFT = 0.84, 0.94, 0.12
BED, BED_FINE = 150.0, 38.0  # m, from one cliff of a wall up to the next
DIP = (2.0, 3.0)  # beds that they rise and fall by, along the large forms
COARSEST_ROCK, FINEST_ROCK = 7, 1
# of the relief above the base: from where on rock stands on gentle ground too, and all over
CRAGS = (0.12, 0.5)
SHARP, FINER = 0.8, 0.95  # how much of it is folded into crests; roughness of an octave over the last
CLIFF = 0.5  # fourth power of the slope that is half rock
VALLEY, COULOIR_DARK = 0.2, 0.5  # of the sky is hidden between ranges and in couloirs
ROCK, TURF = 0.29, 0.02  # amplitude over wavelength of the noise, on steep ground and on flat


class Alpine:
    """Ranges with sharp crests, cirques and flat-floored valleys; numbers as in `LAND`.

    Attributes
    ----------
    native : m, the step from which on only materials add detail
    outside : m, height of the globe beyond the map
    shift_bound : m, the largest shift of a sample from its place on the map
    """

    native = 0.5
    shift_bound = 0.0

    def __init__(self, land: Any, seed: int):
        self.base, self.relief, self.roughness = land.base_height, land.relief, land.roughness
        self.water_level, self.seed = land.water_level, seed
        self.feature, self.power = land.feature_size, large_power(land.feature_size)
        self.outside = self.base - FLOOR * self.relief

    def bounds(self) -> tuple[float, float]:
        """Lowest and highest height anywhere, m."""
        return self.base - 1.2 * self.relief - 20.0, self.base + 2.0 * self.relief + 50.0

    def shape(self, east: np.ndarray, north: np.ndarray, step: np.ndarray | float) -> LandShape:
        """The land at places (m) as a mesh with `step` metres between vertices can carry it."""
        east, north, step = np.broadcast_arrays(*(np.asarray(x, np.float64) for x in (east, north, step)))
        a, b, c, d, e = (np.stack(wide(east, north, self.power + 1 - i, self.seed)) for i in range(5))
        massif = MASSIF[0] * a + MASSIF[1] * b
        ranges, away = ridge(c + BEND * b + WIND * d + WIND * WIND * e, RANGE, self.power - 1, step)
        # spurs are high where ranges are, none in the valleys
        spurs, aside = ridge(d + BEND * c + WIND * e, SPUR, self.power - 2, step)
        high = smoothstep(-0.35, 0.25, ranges[0])
        form = self.relief * (massif + ranges + high * spurs)
        away = 1.0 / (1.0 / away + high / aside)
        land = Relief(form[0], form[1], form[2], np.clip(2.0 * ranges[0], -1.0, 1.0), np.zeros(east.shape))
        depth = COULOIR * (0.5 + self.roughness) + np.zeros(east.shape)
        land = couloirs(
            land,
            away,
            east,
            north,
            self.power + COARSEST_COULOIR,
            FINEST_COULOIR,
            step,
            self.seed,
            depth,
            COULOIR_FINER,
            SOFT,
        )
        floor = SAG * self.relief * massif
        floor[0] -= FLOOR * self.relief
        land, bare = fill(land, floor, SILL * self.relief)
        land, beach = wash(land, self.water_level - self.base, bare)
        slope2 = land.slope_east**2 + land.slope_north**2 + land.lost
        steep = slope2**2 / (slope2**2 + CLIFF)
        hard = (1.0 - beach) * bare * steep * smoothstep(-0.3, 0.3, d[0] + 0.5 * c[0])
        land = ledges(land, BED, DIP[0] * b[0] + DIP[1] * c[0], 1.2 * hard, step)
        summits = smoothstep(CRAGS[0], CRAGS[1], land.height / self.relief)
        rocky = (0.5 + self.roughness) * bare * (steep + 0.6 * summits * (1.0 - steep))
        rough = (TURF * (0.3 + 0.7 * bare) + ROCK * rocky) * (1.0 - 0.8 * beach)
        land = crags(land, east, north, COARSEST_ROCK, FINEST_ROCK, step, self.seed, rough, SHARP, FINER)
        land = ledges(land, BED_FINE, 8.0 * d[0] + 5.0 * c[0], 0.6 * hard, step)
        zero = np.zeros(east.shape)
        opened = 1.0 - (VALLEY + COULOIR_DARK * bare * steep) * np.clip(0.5 - 0.5 * land.crest, 0.0, 1.0)
        return LandShape(
            self.base + land.height, zero + self.water_level, zero, zero, np.sqrt(land.lost), opened
        )


def ridge(noise: np.ndarray, amplitude: float, power: int, step: np.ndarray):
    """Noise (value and slopes, stacked) folded into ridges, and how far away the nearest is (m)."""
    size, bent = fold(noise[0], bluntness(power, step))
    out = -amplitude * bent * noise
    out[0] = amplitude * (CREST - size)
    return out, size / np.sqrt(noise[1] ** 2 + noise[2] ** 2 + (0.2 * 2.0**-power) ** 2)


def large_power(feature_size: float) -> int:
    """The power of two nearest to the size of the large forms (m)."""
    return int(np.clip(np.floor(np.log2(feature_size) + 0.5), 7, 17))
