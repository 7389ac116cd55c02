"""How many clouds give the coverage that is asked for: found once for each layer, by looking.

A few random columns of air through a patch of the layer, at several numbers of clouds per cell: the share of
columns whose optical depth counts as a cloud (`Genus.visible_depth`), optical depth and filled volume by
height. The first, turned round, is what cells need; the others are what puffs larger than clouds see.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np

from ..shapes import pack
from . import density
from .cells import clouds_of
from .layers import Layer
from .uniform import HEIGHTS, KNOTS

_WANTED = (0.08, 0.17, 0.3, 0.45, 0.65, 0.85, 1.0, 1.3, 1.75, 2.4, 3.4, 5.0, 7.0)
MOST = 0.995
"""Coverage beyond which nothing more is asked for."""
_QUICK = 36  # cells along a side of the patch that is looked at; one column in each
_SEED = 5
_VERSION = b"2"  # to be raised when cells.py, density.py or volume.py change what they give
DATA = Path(__file__).parent / "data" / "calibration.npz"


@dataclass(frozen=True, eq=False)
class Calibration:
    """What `calibrate` found.

    Attributes
    ----------
    knots : (9,)
        Mean number of clouds that a cell needs for the coverages `KNOTS`.
    profile : (9, 17)
        Optical depth below the ends of 16 equal parts of `Layer.bounds`, scaled so that the last is
        −ln of the mean transmittance of columns.
    filled : (9, 17)
        Mean density (0 to 1) below the same heights, times height, m.
    blobs : (8,)
        Exponents of the opacity of blobs of `Layer.blobs` sizes, see `mean.fitted`; ones where nobody looked.
    """

    knots: np.ndarray
    profile: np.ndarray
    filled: np.ndarray
    blobs: np.ndarray


def calibration_of(layer: Layer) -> Calibration:
    """The calibration of a layer: the shipped one if all that counts is as usual, else a new one (.5 s)."""
    key = key_of(layer)
    found = _kept.get(key) or _shipped().get(key)
    if found is None:
        found = calibrate(layer, _QUICK)
    _kept[key] = found
    return found


_kept: dict[str, Calibration] = {}


def key_of(layer: Layer) -> str:
    """A hash of all that the calibration of a layer depends on."""
    numbers = [
        *(layer.base_spread, layer.soft, layer.extinction, *layer.radius, *layer.height, layer.cell),
        *(layer.lifetime > 0.0, layer.tile, layer.gap, layer.genus.jitter, layer.genus.aligned),
        *(layer.genus.amplitude, layer.genus.edge, layer.genus.stretch, layer.genus.shear, *layer.genus.look),
        *(layer.genus.visible_depth, *KNOTS, *_WANTED, HEIGHTS),
    ]
    digest = hashlib.sha256(_VERSION + np.array(numbers, np.float64).round(9).tobytes())
    for model in layer.models:
        digest.update(model.boxes.tobytes())
    return digest.hexdigest()[:24]


FIELDS = ("knots", "profile", "filled", "blobs")


@cache
def _shipped() -> dict[str, Calibration]:
    with np.load(DATA) as held:
        tables = {name: held[name] for name in held.files}
    return {
        str(key): Calibration(*(tables[name][i] for name in FIELDS)) for i, key in enumerate(tables["keys"])
    }


def calibrate(layer: Layer, side: int) -> Calibration:
    """Look how much of the sky numbers of clouds cover, in side² columns: error of the share .5 / side."""
    low, high = layer.bounds
    patch = _Patch(layer, side)
    shares, profiles, filled = [0.0], [np.zeros(HEIGHTS + 1)], [np.zeros(HEIGHTS + 1)]
    part = (high - low) / HEIGHTS
    for wanted in _WANTED:
        clouds = patch.clouds(wanted)
        density, extinction = patch.seen(clouds)
        depths = extinction * part
        columns = depths.sum(1)
        shares.append(float((columns > layer.genus.visible_depth).mean()))
        below = np.concatenate([[0.0], np.cumsum(depths.mean(0))])
        profiles.append(below * -np.log(np.exp(-columns).mean()) / max(below[-1], 1e-9))
        filled.append(np.concatenate([[0.0], np.cumsum(density.mean(0))]) * part)
    # clouds that fall anywhere cover 1 − exp(−their number): nearly straight in this scale; where more clouds
    # change nothing, the fewest count
    clear = -np.log(1.0 - np.minimum(np.maximum.accumulate(shares), MOST)) + 1e-6 * np.arange(len(shares))
    grid = (0.0, *_WANTED)
    knots = np.interp(-np.log(1.0 - np.minimum(KNOTS, MOST)), clear, grid)
    tables = [
        np.stack([np.interp(knots, grid, column) for column in np.transpose(rows)], 1)
        for rows in (profiles, filled)
    ]
    return Calibration(knots, tables[0], tables[1], np.ones(len(layer.blobs)))


class _Patch:
    """A square of cells with one random column of air in each."""

    def __init__(self, layer: Layer, side: int):
        self.layer = replace(layer, wind=(0.0, 0.0), base=0.0, towards=0.0, seed=_SEED)
        self.packed = pack(layer.models)
        across = side + 2
        i, j = np.meshgrid(np.arange(across), np.arange(across))
        self.cells = np.stack([i.ravel(), j.ravel()], 1) - 1
        x, y = (a.ravel() for a in np.meshgrid(np.arange(side), np.arange(side)))
        steps = (np.arange(-1, 2)[:, None] * across + np.arange(-1, 2)).ravel()
        self.rows = np.repeat(((y + 1) * across + x + 1)[:, None] + steps, HEIGHTS, 0)
        random = np.random.default_rng(_SEED)
        places = (np.stack([x, y], 1) + random.uniform(size=(side * side, 2))) * layer.cell
        low, high = self.layer.bounds
        heights = low + (np.arange(HEIGHTS) + 0.5) * (high - low) / HEIGHTS
        self.points = np.column_stack([np.repeat(places, HEIGHTS, 0), np.tile(heights, len(places))])
        self.noise = density.noise_at(self.layer, self.points, 0.0)

    def clouds(self, wanted: float) -> np.ndarray:
        """The patch's clouds where cells have so many on average."""
        return clouds_of(self.layer, self.cells, 0.0, np.full(len(self.cells), wanted))

    def seen(self, clouds: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Density and extinction (columns, 16), 1/m, at the middles of equal parts of the layer's heights."""
        boxes, models = self.packed.boxes, self.packed.models
        field, water = density.gathered(self.layer, boxes, models, clouds, self.rows, self.points)
        full = density.eaten(self.layer, field, self.noise)
        full[field <= 0.0] = 0.0
        extinction = water / np.maximum(field, 1e-12) * full
        return full.reshape(-1, HEIGHTS), extinction.reshape(-1, HEIGHTS)
