"""How many clouds give the coverage that is asked for: found once for each layer, by looking.

A few random columns of air through a patch of the layer, at several numbers of clouds per cell: the share of
columns whose optical depth counts as a cloud (`Genus.visible_depth`), the area of the clouds, and optical depth
by height. The first, turned round, is what cells need; the others are what puffs larger than clouds see.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from ..shapes import pack
from . import density
from .cells import clouds_of
from .layers import Layer
from .uniform import HEIGHTS, KNOTS

_WANTED = (0.08, 0.17, 0.3, 0.45, 0.65, 0.85, 1.0, 1.3, 1.75, 2.4, 3.4, 5.0, 7.0)
_SIDE = 32  # cells along a side of the patch; one column in each


@dataclass(frozen=True, eq=False)
class Calibration:
    """What `calibrate` found.

    Attributes
    ----------
    knots : (9,)
        Mean number of clouds that a cell needs for the coverages `KNOTS`.
    discs : (9,)
        Area of the clouds' discs over that of the cells.
    profile : (9, 17)
        Optical depth below the ends of 16 equal parts of `Layer.bounds`, scaled so that the last is
        −ln of the mean transmittance of columns.
    """

    knots: np.ndarray
    discs: np.ndarray
    profile: np.ndarray


@lru_cache(maxsize=32)
def calibrate(layer: Layer) -> Calibration:
    """Look how much of the sky numbers of clouds cover; error of the share about .01."""
    low, high = layer.bounds
    patch = _Patch(layer)
    shares, discs, profiles = [0.0], [0.0], [np.zeros(HEIGHTS + 1)]
    for wanted in _WANTED:
        clouds = patch.clouds(wanted)
        depths = patch.extinction(clouds) * (high - low) / HEIGHTS
        columns = depths.sum(1)
        shares.append(float((columns > layer.genus.visible_depth).mean()))
        discs.append(
            float((clouds["formation"] * clouds["radius"] ** 2).mean()) * 0.5 * np.pi / layer.cell**2
        )
        below = np.concatenate([[0.0], np.cumsum(depths.mean(0))])
        profiles.append(below * -np.log(np.exp(-columns).mean()) / max(below[-1], 1e-9))
    # equal shares where more clouds change nothing: the fewest count
    rising = np.maximum.accumulate(shares) + 1e-6 * np.arange(len(shares))
    grid = (0.0, *_WANTED)
    knots = np.interp(np.minimum(KNOTS, 0.995), rising, grid)
    area = np.interp(knots, grid, discs) + 1e-4 * np.arange(len(KNOTS))
    profile = np.stack([np.interp(knots, grid, column) for column in np.transpose(profiles)], 1)
    return Calibration(knots, area, profile)


class _Patch:
    """A square of cells with one random column of air in each."""

    def __init__(self, layer: Layer):
        self.layer = replace(layer, wind=(0.0, 0.0))
        self.packed = pack(layer.models)
        across = _SIDE + 2
        i, j = np.meshgrid(np.arange(across), np.arange(across))
        self.cells = np.stack([i.ravel(), j.ravel()], 1) - 1
        x, y = (a.ravel() for a in np.meshgrid(np.arange(_SIDE), np.arange(_SIDE)))
        steps = (np.arange(-1, 2)[:, None] * across + np.arange(-1, 2)).ravel()
        self.rows = np.repeat(((y + 1) * across + x + 1)[:, None] + steps, HEIGHTS, 0)
        random = np.random.default_rng(layer.seed)
        places = (np.stack([x, y], 1) + random.uniform(size=(_SIDE * _SIDE, 2))) * layer.cell
        low, high = layer.bounds
        heights = low + (np.arange(HEIGHTS) + 0.5) * (high - low) / HEIGHTS
        self.points = np.column_stack([np.repeat(places, HEIGHTS, 0), np.tile(heights, len(places))])
        self.noise = density.noise_at(self.layer, self.points, 0.0)

    def clouds(self, wanted: float) -> np.ndarray:
        """The patch's clouds where cells have so many on average."""
        return clouds_of(self.layer, self.cells, 0.0, np.full(len(self.cells), wanted))

    def extinction(self, clouds: np.ndarray) -> np.ndarray:
        """(columns, 16), 1/m, at the middles of equal parts of the layer's heights."""
        boxes, models = self.packed.boxes, self.packed.models
        field, water = density.gathered(self.layer, boxes, models, clouds, self.rows, self.points)
        full = density.eaten(self.layer, field, self.noise)
        return (water / np.maximum(field, 1e-12) * full).reshape(-1, HEIGHTS)
