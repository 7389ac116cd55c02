"""Which cloud a cell of a layer's lattice holds: float64 twin of ``cells.wesl`` and ``coverage.wesl``.

A cell holds one cloud after the other. Its phase, a number of its own, says how old the present one is; when
that has dissolved, the next begins with other random bits. How many clouds there are follows from coverage by
a calibration (`calibration`): with coverage more cells have a cloud, and where all have one, clouds widen.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from math import floor

import numpy as np

from ...noise import patterns
from ...noise.hashing import SCRAMBLE, axis_words
from ..shapes import SWELL
from .layers import Layer
from .uniform import KNOTS

PATCH = 10
"""Cells between places where coverage differs."""
SOFTNESS = 0.06
"""Of the step from no cloud to a whole one, as coverage rises."""
OUTER = 1.2
"""A cloud may be so much wider than its ellipsoids and still be held by its own cell and those around."""
PHASES = 0xFFFFFFFF  # the generation whose bits are phases
_STEP = np.uint32(0x9E3779B9)

CLOUD = np.dtype(
    [
        ("place", np.float64, 2),
        ("base", np.float64),
        ("yaw", np.float64),
        ("scale", np.float64, 2),
        ("formation", np.float64),
        ("extinction", np.float64),
        ("radius", np.float64),
        ("top", np.float64),
        ("model", np.int64),
        ("seed", np.uint32),
        ("swell", np.float64),
    ]
)
"""As ``cloud.wesl`` has it, but for `place`: m on the map, east and north."""


@dataclass(frozen=True)
class Age:
    """Where a layer is in its clouds' lives: the age of phase 0, and the words of three generations."""

    part: float
    phases: tuple[int, int]
    now: tuple[int, int]
    next: tuple[int, int]

    @classmethod
    def of(cls, layer: Layer, time: float) -> Age:
        """At a time, s since the scene's start."""
        lives = time / layer.lifetime if layer.lifetime > 0.0 else 0.0
        generation = floor(lives)
        return cls(
            lives - generation,
            _words(layer.seed, PHASES),
            _words(layer.seed, generation & 0x7FFFFFFF),
            _words(layer.seed, (generation + 1) & 0x7FFFFFFF),
        )


@lru_cache(256)
def _words(seed: int, generation: int) -> tuple[int, int]:
    x, y, *_ = axis_words(seed, generation)
    return x, y


def bits_of(cells: np.ndarray, words: tuple[int, int]) -> np.ndarray:
    """Random bits of cells (n, 2), uint32 (n,)."""
    with np.errstate(over="ignore"):
        t = cells.astype(np.int64).astype(np.uint32) * np.uint32(0x9E3779B1) + np.array(words, np.uint32)
        planes = ((t ^ (t >> np.uint32(16))) & np.uint32(0xFFFF)) | np.uint32(0x8001)
        p = planes[:, 0] * planes[:, 1] * np.uint32(SCRAMBLE[0])
        p = (p ^ (p >> np.uint32(15))) * np.uint32(SCRAMBLE[1])
        return p ^ (p >> np.uint32(15))


def number(seed: np.ndarray, k: int) -> np.ndarray:
    """The k-th number of cells, 0 to 1."""
    return (_mixed(seed, k) >> np.uint32(9)) / 8388608.0


def _mixed(seed: np.ndarray, k: int) -> np.ndarray:
    with np.errstate(over="ignore"):
        h = seed + np.uint32(k) * _STEP
        h = (h ^ (h >> np.uint32(16))) * np.uint32(0x85EBCA6B)
        h = (h ^ (h >> np.uint32(13))) * np.uint32(0xC2B2AE35)
        return h ^ (h >> np.uint32(16))


def needed(knots: np.ndarray, coverage: np.ndarray) -> np.ndarray:
    """Mean number of clouds that a cell needs for a coverage; `knots` as `Calibration` has them."""
    return np.interp(coverage, KNOTS, knots)


def patchy(layer: Layer, places: np.ndarray, coverage: np.ndarray, strength: float = 1.0) -> np.ndarray:
    """Coverage of the patches at places of the lattice (n, 2), in cells, about a mean."""
    x, y = (places / PATCH).T
    v = patterns.value(x, y, layer.seed)
    swing = strength * layer.clustering * 4.0 * coverage * (1.0 - coverage)
    return np.clip(coverage + swing * v, 0.0, 1.0)


def clouds_of(layer: Layer, cells: np.ndarray, time: float, wanted: np.ndarray, first: int = 0) -> np.ndarray:
    """The clouds of cells.

    Parameters
    ----------
    cells : (n, 2) integers
    time : float
        s since the scene's start.
    wanted : (n,)
        Mean number of clouds that a cell needs there, see `needed`.
    first : int
        Number of the layer's first model among all layers'.

    Returns
    -------
    (n,) of `CLOUD`
    """
    age = Age.of(layer, time)
    seed = bits_of(cells, age.now)
    spread = np.maximum(wanted, 1.0)
    alive = np.ones(len(cells))
    if layer.lifetime > 0.0:
        old = age.part + number(bits_of(cells, age.phases), 0)
        seed = np.where(old >= 1.0, bits_of(cells, age.next), seed)
        old = np.where(old >= 1.0, old - 1.0, old)
        # where many overlap none is missed: they live longer
        rise, fall = 0.18 / spread, 0.28 / spread
        alive = _smooth(0.0, rise, old) * (1.0 - _smooth(1.0 - fall, 1.0, old))
    full = (np.minimum(wanted, 1.0) * (1.0 + SOFTNESS) - number(seed, 0)) / SOFTNESS
    formation = np.clip(full, 0.0, 1.0) * alive

    grown = np.sqrt(spread)
    jitter = layer.genus.jitter / grown
    middle = (cells + 0.5) * layer.cell + np.asarray(layer.wind) * time
    off = 2.0 * np.stack([number(seed, 1), number(seed, 2)], 1) - 1.0
    which = np.minimum((number(seed, 7) * len(layer.models)).astype(np.int64), len(layer.models) - 1)
    bound = np.array([(m.radius, m.height, m.reach, m.top) for m in layer.models])[which]
    large = number(seed, 4) ** 3
    swell = layer.gap * (1.0 - 1.0 / spread)
    room = (1.5 - jitter) * layer.cell / (OUTER * (1.0 + SWELL * swell))
    radius = np.minimum(_mix(*layer.radius, large) * grown, room)
    height = _mix(*layer.height, 0.6 * large + 0.4 * number(seed, 5))

    out = np.zeros(len(cells), CLOUD)
    out["place"] = middle + layer.cell * jitter[:, None] * off
    out["base"] = layer.base + layer.base_spread * (number(seed, 6) - 0.5)
    out["yaw"] = layer.towards + (1.0 - layer.genus.aligned) * 2.0 * np.pi * (number(seed, 3) - 0.5)
    scale = np.stack([radius / bound[:, 0], height / bound[:, 1]], 1)
    out["scale"] = scale * _mix(0.55, 1.0, formation)[:, None]
    out["formation"] = formation
    out["extinction"] = layer.extinction * (0.85 + 0.3 * number(seed, 8))
    out["swell"] = swell * bound[:, 0]
    out["radius"] = (bound[:, 2] + SWELL * np.sqrt(2.0) * out["swell"]) * out["scale"][:, 0]
    out["radius"][formation <= 0.0] = 0.0
    out["top"] = out["base"] + bound[:, 3] * out["scale"][:, 1]
    out["model"] = first + which
    out["seed"] = _mixed(seed, 9)
    return out


def _mix(a: float, b: float, t: np.ndarray) -> np.ndarray:
    return a + (b - a) * t


def _smooth(low: float | np.ndarray, high: float | np.ndarray, x: np.ndarray) -> np.ndarray:
    t = np.clip((x - low) / (high - low), 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t)
