"""Gently rolling land with shallow valleys: float64 twin of ``plains.wesl``."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..octaves import wide
from .alpine import large_power
from .erosion import Gullies, Relief, carve, fill, roughen
from .shape import LandShape
from .shoreline import wash

ROLL = (0.9, 0.6, 0.3)  # amplitudes of the large forms over the relief, each half as wide as the last
VALLEYS = 7.0  # slope of the valleys' sides, over relief by feature size
FLOOR, SAG, SILL = 0.3, 0.7, 0.03  # of the relief: depth of valley floors, how far they follow, their edge
FINEST_VALLEY, COARSEST_HUMP, FINEST_HUMP = 6, 6, 0
HUMPS = 0.006  # amplitude over wavelength of the noise


class Plains:
    """Plains; see `world.terrain` for the parameters (`LAND`).

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
        self.feature, self.water_level, self.seed = land.feature_size, land.water_level, seed
        self.outside = self.base

    def bounds(self) -> tuple[float, float]:
        """Lowest and highest height anywhere, m."""
        return self.base - 2.2 * self.relief - 5.0, self.base + 2.2 * self.relief + 30.0

    def shape(self, east: np.ndarray, north: np.ndarray, step: np.ndarray | float) -> LandShape:
        """The land at places (m) as a mesh with `step` metres between vertices can carry it."""
        east, north, step = np.broadcast_arrays(*(np.asarray(x, np.float64) for x in (east, north, step)))
        power = large_power(self.feature)
        forms = [np.stack(wide(east, north, power + 1 - i, self.seed)) for i in range(3)]
        roll = ROLL[0] * forms[0] + ROLL[1] * forms[1] + ROLL[2] * forms[2]
        form = self.relief * roll
        crest = np.clip(2.0 * roll[0], -1.0, 1.0)
        land = Relief(form[0], form[1], form[2], crest, np.zeros(east.shape))
        side = VALLEYS * self.relief / self.feature
        valleys = Gullies(0.6, 0.85, side * (0.5 + self.roughness), 0.8, 0.5 * side, 0.8 * side, 0.3)
        land = carve(land, east, north, power - 1, FINEST_VALLEY, step, self.seed, valleys)
        floor = SAG * form
        floor[0] -= FLOOR * self.relief
        land, bare = fill(land, floor, SILL * self.relief)
        land, beach = wash(land, self.water_level - self.base, bare)
        rough = HUMPS * (0.5 + self.roughness) * (0.2 + 0.8 * bare) * (1.0 - 0.8 * beach)
        land = roughen(land, east, north, COARSEST_HUMP, FINEST_HUMP, step, self.seed, rough)
        zero = np.zeros(east.shape)
        return LandShape(
            self.base + land.height, zero + self.water_level, zero, zero, np.sqrt(land.lost), zero + 1.0
        )
