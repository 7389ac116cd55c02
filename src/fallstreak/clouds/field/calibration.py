"""How many clouds give the coverage that is asked for: found once for each layer, by looking.

A few random columns of air through a patch of the layer, at several numbers of clouds per cell: the share of
columns whose optical depth counts as a cloud (`Genus.visible_depth`), and the mean extinction by height. The
first, turned round, is what cells need; the second is what puffs larger than clouds see.
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
    profile : (9, 16)
        Mean extinction at these coverages, 1/m, at the middles of 16 equal parts of `Layer.bounds`.
    """

    knots: np.ndarray
    profile: np.ndarray


@lru_cache(maxsize=32)
def calibrate(layer: Layer) -> Calibration:
    """Look how much of the sky numbers of clouds cover; error of the share about .01."""
    shares, profiles = [0.0], [np.zeros(HEIGHTS)]
    for wanted in _WANTED:
        extinction = columns(layer, wanted)
        low, high = layer.bounds
        depth = extinction.sum(1) * (high - low) / HEIGHTS
        shares.append(float((depth > layer.genus.visible_depth).mean()))
        profiles.append(extinction.mean(0))
    # equal shares where more clouds change nothing: the fewest count
    rising = np.maximum.accumulate(shares) + 1e-6 * np.arange(len(shares))
    goal = np.minimum(KNOTS, 0.995)
    knots = np.interp(goal, rising, (0.0, *_WANTED))
    table = np.array([np.interp(knots, (0.0, *_WANTED), column) for column in np.transpose(profiles)]).T
    return Calibration(knots, table)


def columns(layer: Layer, wanted: float, side: int = _SIDE) -> np.ndarray:
    """Extinction in one random column of each cell of a square of cells.

    Parameters
    ----------
    wanted : float
        Mean number of clouds of a cell.

    Returns
    -------
    (side², 16), 1/m
        At the middles of equal parts of the layer's heights.
    """
    random = np.random.default_rng(layer.seed & 0xFFFF)
    packed = pack(layer.models)
    still = replace(layer, wind=(0.0, 0.0))
    across = side + 2
    i, j = np.meshgrid(np.arange(across), np.arange(across))
    cells = np.stack([i.ravel(), j.ravel()], 1) - 1
    clouds = clouds_of(still, cells, 0.0, np.full(len(cells), wanted))
    x, y = (a.ravel() for a in np.meshgrid(np.arange(side), np.arange(side)))
    steps = (np.arange(-1, 2)[:, None] * across + np.arange(-1, 2)).ravel()
    rows = ((y + 1) * across + x + 1)[:, None] + steps
    place = (np.stack([x, y], 1) + random.uniform(size=(side * side, 2))) * layer.cell
    low, high = layer.bounds
    height = low + (np.arange(HEIGHTS) + 0.5) * (high - low) / HEIGHTS
    points = np.column_stack([np.repeat(place, HEIGHTS, 0), np.tile(height, len(place))])
    pairs = np.repeat(rows, HEIGHTS, 0)
    field, water = density.gathered(still, packed.boxes, packed.models, clouds, pairs, points)
    out = np.zeros(len(points))
    at = np.flatnonzero(field > 0.0)
    noise = density.noise_at(still, points[at], 0.0)
    out[at] = water[at] / field[at] * density.eaten(still, field[at], noise)
    return out.reshape(len(place), HEIGHTS)
