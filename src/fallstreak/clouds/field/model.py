"""The field of a world on the CPU, float64: what the shaders evaluate, and what they are told."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...world.files import changed
from ..shapes import load, pack, shipped
from . import density
from .calibration import Calibration, calibration_of
from .cells import clouds_of, needed, patchy
from .coverage import CoverageMap, read_coverage
from .layers import Layer, outline_of

_CHUNK = 1 << 17  # places at a time


class Field:
    """All layers of clouds of a world.

    Parameters
    ----------
    layers : sequence of Layer
    maps : sequence of CoverageMap or None
        For each layer.
    calibrations : sequence of Calibration, optional
        For each layer; looked up or made unless given.

    Attributes
    ----------
    packed : shapes.Packed
        All layers' models.
    outlines : (models, 17)
        See `layers.outline_of`.
    first : list of int
        Each layer's first model in it.
    """

    def __init__(
        self,
        layers: tuple[Layer, ...],
        maps: tuple[CoverageMap | None, ...],
        calibrations: tuple[Calibration, ...] | None = None,
    ):
        self.layers, self.maps = layers, maps
        self.packed = pack([model for layer in layers for model in layer.models])
        self.outlines = np.stack([outline_of(model) for layer in layers for model in layer.models] or [[]])
        counts = [len(layer.models) for layer in layers]
        self.first = [sum(counts[:i]) for i in range(len(counts))]
        self.calibrations = calibrations or tuple(calibration_of(layer) for layer in layers)

    def coverage(self, index: int, east: np.ndarray, north: np.ndarray) -> np.ndarray:
        """Coverage that is asked for of a layer at places, without patches."""
        share = self.layers[index].coverage
        plan = self.maps[index]
        return np.full(np.shape(east), share) if plan is None else share * plan.at(east, north)

    def clouds(self, index: int, cells: np.ndarray, time: float) -> np.ndarray:
        """The clouds of cells (n, 2) of a layer, (n,) of `cells.CLOUD`."""
        layer = self.layers[index]
        middle = (np.asarray(cells) + 0.5) * layer.cell + np.asarray(layer.wind) * time
        asked = patchy(layer, np.asarray(cells) + 0.5, self.coverage(index, middle[:, 0], middle[:, 1]))
        wanted = needed(self.calibrations[index].knots, asked)
        return clouds_of(layer, cells, time, wanted, self.first[index])

    def extinction(self, points: np.ndarray, time: float) -> np.ndarray:
        """Extinction at places (n, 3), m: (n,), 1/m."""
        out = np.zeros(len(points))
        for start in range(0, len(points), _CHUNK):
            part = slice(start, start + _CHUNK)
            for index in range(len(self.layers)):
                out[part] += self.layer_extinction(index, points[part], time)
        return out

    def layer_extinction(self, index: int, points: np.ndarray, time: float) -> np.ndarray:
        """As `extinction`, of one layer."""
        layer = self.layers[index]
        out = np.zeros(len(points))
        low, high = layer.bounds
        at = np.flatnonzero((points[:, 2] > low) & (points[:, 2] < high))
        if len(at):
            field, water = self.gathered(index, points[at], time)
            cloudy = np.flatnonzero(field > 0.0)
            at, field, water = at[cloudy], field[cloudy], water[cloudy]
            noise = density.noise_at(layer, points[at], time)
            out[at] = water / field * density.eaten(layer, field, noise)
        return out

    def gathered(self, index: int, points: np.ndarray, time: float) -> tuple[np.ndarray, np.ndarray]:
        """A layer's field at places, before noise, and the same weighted by extinction."""
        clouds, pairs = self.around(index, points, time)
        boxes, models = self.packed.boxes, self.packed.models
        return density.gathered(self.layers[index], boxes, models, clouds, pairs, points)

    def around(self, index: int, points: np.ndarray, time: float) -> tuple[np.ndarray, np.ndarray]:
        """Clouds (m,) of the cells around places (n, 3), and the nine rows of them for each (n, 9)."""
        layer = self.layers[index]
        drifting = points[:, :2] - np.asarray(layer.wind) * time
        cells, rows = neighbours(np.floor(drifting / layer.cell).astype(np.int64))
        return self.clouds(index, cells, time), rows


def neighbours(cells: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The cells in and around cells, each once, and for each cell the nine rows of them.

    Parameters
    ----------
    cells : (n, 2) int64

    Returns
    -------
    around : (m, 2) int64
    rows : (n, 9) int64
    """
    low = cells.min(0) - 1
    span = cells.max(0) - low + 2
    if float(span[0]) * float(span[1]) <= 4e6:  # a table is faster than a search
        flat = (cells[:, 1] - low[1]) * span[0] + cells[:, 0] - low[0]
        steps = (np.arange(-1, 2)[:, None] * span[0] + np.arange(-1, 2)).ravel()
        used = np.zeros(span[0] * span[1], bool)
        own = np.unique(flat)
        for step in steps:
            used[own + step] = True
        rows = np.cumsum(used) - 1
        found = np.flatnonzero(used)
        around = np.stack([found % span[0] + low[0], found // span[0] + low[1]], 1)
        return around, rows[flat[:, None] + steps]
    offsets = np.stack(np.meshgrid(np.arange(-1, 2), np.arange(-1, 2)), -1).reshape(-1, 2)
    every = (cells[:, None] + offsets).reshape(-1, 2)
    around, rows = np.unique(every, axis=0, return_inverse=True)
    return around, rows.reshape(-1, 9)


def field_of(world: Any) -> Field:
    """The field of a world; kept for the worlds asked last, because calibrating it takes a second.

    Raises
    ------
    WorldError
        For files of models and of coverage that cannot be read.
    """
    clouds = world.clouds
    stamps = tuple(changed(path) for layer in clouds.layers for _, path in layer.paths)
    layers = clouds.model_dump_json(include={"layers"})
    place = world.place.latitude, world.place.longitude, world.planet.radius
    key = (layers, world.seed, stamps, world.folder, place)
    if key not in _kept:
        while len(_kept) >= 4:
            del _kept[next(iter(_kept))]
        _kept[key] = _made(world)
    return _kept[key]


_kept: dict[Any, Field] = {}


def _made(world: Any) -> Field:
    layers, maps = [], []
    for index, layer in enumerate(world.clouds.layers):
        models = tuple(load(model_names(layer), world.folder))
        layers.append(Layer.of(world, index, models))
        maps.append(read_coverage(world, index))
    return Field(tuple(layers), tuple(maps))


def model_names(layer: Any) -> list[str]:
    """The models of a layer: its own, or those shipped for its genus."""
    if layer.models:
        return list(layer.models)
    return [name for name in shipped() if name == layer.genus or name.startswith(f"{layer.genus}_")]
