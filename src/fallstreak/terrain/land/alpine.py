"""Mountains that ice and water have shaped: float64 twin of ``alpine.wesl``."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..octaves import wide
from ..pattern import smoothstep
from .erosion import Gullies, Relief, carve, fill, roughen
from .shape import LandShape
from .shoreline import wash

MASSIF = (0.5, 0.45, 0.32)  # amplitudes of the large forms over the relief, each half as wide as the last
SCALE = 0.85  # of all heights, so that summits stand about one relief above the valleys
FLOOR, SAG, SILL = 0.42, 0.35, 0.03  # of the relief: depth of valley floors, how far they follow, their edge
FINEST_GULLY, COARSEST_ROCK, FINEST_ROCK = 6, 9, 0
CRAGS = (
    0.12,
    0.5,
)  # of the relief above the base: from where on rock stands on gentle ground too, and all over
LIFT, SOFT, CALM = 3.3, 0.22, 0.5  # of the gullies, over relief by feature size
SHARP, FINER = 0.7, 0.88  # how much of it is folded into crests; roughness of an octave over the last
ROCK, TURF = 0.3, 0.02  # amplitude over wavelength of the noise, on steep ground and on flat


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
        a, b, c = (np.stack(wide(east, north, self.power + 1 - i, self.seed)) for i in range(3))
        massif = MASSIF[0] * a + MASSIF[1] * b + MASSIF[2] * c
        form = SCALE * self.relief * massif
        land = Relief(form[0], form[1], form[2], np.clip(2.5 * massif[0], -1.0, 1.0), np.zeros(east.shape))
        bold = float(np.clip(self.relief / self.feature, 0.004, 0.2))
        gullies = Gullies(0.9, 0.98, LIFT * bold, 0.75, SOFT * bold, CALM * bold, 0.88)
        strength = SCALE * (0.7 + 0.6 * self.roughness)
        land = carve(land, east, north, self.power - 1, FINEST_GULLY, step, self.seed, gullies, strength)
        floor = SAG * form
        floor[0] -= FLOOR * self.relief
        land, bare = fill(land, floor, SILL * self.relief)
        land, beach = wash(land, self.water_level - self.base, bare)
        slope2 = land.slope_east**2 + land.slope_north**2
        crags = smoothstep(CRAGS[0], CRAGS[1], land.height / self.relief)
        steep = slope2 / (slope2 + 0.5)
        rocky = (0.5 + self.roughness) * bare * (steep + crags * (1.0 - steep))
        rough = (TURF * (0.3 + 0.7 * bare) + ROCK * rocky) * (1.0 - 0.8 * beach)
        land = roughen(land, east, north, COARSEST_ROCK, FINEST_ROCK, step, self.seed, rough, SHARP, FINER)
        zero = np.zeros(east.shape)
        opened = 0.8 + 0.2 * np.clip(0.5 + 0.5 * land.crest, 0.0, 1.0)
        return LandShape(
            self.base + land.height, zero + self.water_level, zero, zero, np.sqrt(land.lost), opened
        )


def large_power(feature_size: float) -> int:
    """The power of two nearest to the size of the large forms (m)."""
    return int(np.clip(np.floor(np.log2(feature_size) + 0.5), 7, 17))
