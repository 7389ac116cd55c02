"""A layer of the sky with every number known: what the scene says, and what is usual of its genus."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from math import cos, radians, sin
from typing import Any

import numpy as np

from ...noise.hashing import octave_seed
from ..genera import GENERA, Genus
from ..shapes import SWELL, CloudModel
from .uniform import HEIGHTS

SEED = 0x5C10D5  # clouds have nothing to do with what else follows from the world's seed
SURFACE = 0.25
"""Of the field, see ``density``."""
CLOSED = 0.93
"""Part of its circle that a closed cloud fills."""
FINER = 4.3
"""The fine noise over the coarse."""


@dataclass(frozen=True)
class Layer:
    """One layer, in SI units; angles in radians, counter-clockwise from east.

    Attributes
    ----------
    genus : Genus
    models : tuple of CloudModel
    seed : int
        Of its lattice.
    coverage, clustering : float
    base, base_spread, extinction, soft : float
        m, m, 1/m, m; see `Genus`.
    radius, height : (float, float)
        m, smallest and largest.
    cell, jitter : float
        m; part of the cell.
    wind : (float, float)
        m/s, where it blows to.
    towards : float
        Direction of the wind.
    lifetime : float
        s; 0: for ever.
    tile : float
        m, see `Genus`.
    gap : float
        By how much boxes must widen for a cloud to be closed, over its radius.
    """

    genus: Genus
    models: tuple[CloudModel, ...]
    seed: int
    coverage: float
    clustering: float
    base: float
    base_spread: float
    soft: float
    extinction: float
    radius: tuple[float, float]
    height: tuple[float, float]
    cell: float
    wind: tuple[float, float]
    towards: float
    lifetime: float
    tile: float
    gap: float

    @classmethod
    def of(cls, world: Any, index: int, models: tuple[CloudModel, ...]) -> Layer:
        """The layer of a world's ``clouds.layers``, as copies of `models`."""
        given = world.clouds.layers[index]
        usual = GENERA[given.genus]
        thickness = _or(given.thickness, usual.thickness)
        # a thin layer has thin edges
        part = min(thickness / usual.thickness, 1.0)
        speed, towards = _or(given.wind_speed, usual.wind), radians(270.0 - given.wind_from)
        return cls(
            genus=usual,
            models=models,
            seed=octave_seed(octave_seed(world.seed, SEED) + given.seed, index),
            coverage=given.cover,
            clustering=_or(given.clustering, usual.clustering),
            base=_or(given.base, usual.base),
            base_spread=usual.base_spread * part,
            soft=usual.soft * part,
            extinction=_or(given.extinction, usual.extinction),
            radius=(usual.radius[0] * given.size, usual.radius[1] * given.size),
            height=(usual.height[0] * thickness, usual.height[1] * thickness),
            cell=usual.cell * given.size,
            wind=(speed * cos(towards), speed * sin(towards)),
            towards=towards,
            lifetime=_or(given.lifetime, usual.lifetime),
            tile=usual.tile * given.size,
            gap=sum(gap_of(model) for model in models) / len(models),
        )

    @property
    def bounds(self) -> tuple[float, float]:
        """Heights between which all of its matter lies, m above the sea."""
        top = max(model.top / model.height for model in self.models)
        half = 0.5 * self.base_spread
        return self.base - half, self.base + half + top * self.height[1]

    @property
    def body(self) -> float:
        """Mean half size of its clouds' boxes, across or upright, whichever is less, m: the size of lumps."""
        large = 0.25  # mean of a cube of a random number
        radius = self.radius[0] + large * (self.radius[1] - self.radius[0])
        height = self.height[0] + (0.6 * large + 0.2) * (self.height[1] - self.height[0])
        across = sum(float(m.boxes["half"][:, :2].mean()) / m.radius for m in self.models)
        upright = sum(float(m.boxes["half"][:, 2].mean()) / m.height for m in self.models)
        return min(radius * across, height * upright) / len(self.models)

    @property
    def blobs(self) -> np.ndarray:
        """Eight sizes of blobs, evenly from a fourth of `body` to two cells, m."""
        return np.geomspace(0.25 * self.body, 2.0 * self.cell, 8)


@lru_cache(maxsize=128)
def gap_of(model: CloudModel) -> float:
    """By how much a model's boxes must widen to fill `CLOSED` of its circle, over its radius.

    Seen from above, heights left aside; found by bisection.
    """
    side = np.linspace(-1.0, 1.0, 49) * model.radius
    east, north = (a.ravel() for a in np.meshgrid(side, side))
    within = np.hypot(east, north) < model.radius
    places = np.stack([east[within], north[within]], 1)
    low, high = 0.0, 1.0
    for _ in range(7):
        middle = 0.5 * (low + high)
        if _filled(model, places, middle * model.radius) < CLOSED:
            low = middle
        else:
            high = middle
    return 0.0 if low == 0.0 else high


def _filled(model: CloudModel, places: np.ndarray, wider: float) -> float:
    """Part of places (n, 2) that a model covers, heights left aside."""
    x = _away(model, places, wider)
    return float(((np.maximum(1.0 - 0.5 * x, 0.0) ** 2).sum(1) > SURFACE).mean())


@lru_cache(maxsize=128)
def outline_of(model: CloudModel) -> np.ndarray:
    """Area of a model at heights from its base to `CloudModel.top`, over that of its disc.

    Returns
    -------
    (17,)
        The disc has half of the area of a circle of `CloudModel.reach`. Noise is left aside.
    """
    side = np.linspace(-1.0, 1.0, 41) * model.reach
    east, north = (a.ravel() for a in np.meshgrid(side, side))
    across = _away(model, np.stack([east, north], 1), 0.0)
    area = (side[1] - side[0]) ** 2 / (0.5 * np.pi * model.reach**2)
    shares = []
    for part in np.linspace(0.0, 1.0, HEIGHTS + 1):
        z = (part * model.top - model.boxes["centre"][:, 2]) / (SWELL * model.boxes["half"][:, 2])
        field = (np.maximum(1.0 - 0.5 * (across + z * z), 0.0) ** 2).sum(1)
        shares.append(float((field > SURFACE).sum()) * area)
    return np.array(shares)


def _away(model: CloudModel, places: np.ndarray, wider: float) -> np.ndarray:
    """Squared horizontal distances of places (n, 2) from a model's boxes, in their sizes: (n, boxes)."""
    boxes = model.boxes
    v = places[:, None] - boxes["centre"][:, :2]
    c, s = boxes["cosine"], boxes["sine"]
    size = SWELL * (boxes["half"][:, :2] + wider)
    x = (c * v[..., 0] + s * v[..., 1]) / size[:, 0]
    y = (c * v[..., 1] - s * v[..., 0]) / size[:, 1]
    return x * x + y * y


def _or(given: float | None, usual: float) -> float:
    return usual if given is None else float(given)
