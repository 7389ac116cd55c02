"""Patterns for what covers the ground, on the CPU: float64 twin of ``pattern.wesl``."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..noise.scatter import hash_lattice, mix_bits, unit_float
from .octaves import octave, octave_weight


def smoothstep(low: float | np.ndarray, high: float | np.ndarray, x: np.ndarray) -> np.ndarray:
    """0 below `low`, 1 above `high`, smooth between."""
    t = np.clip((x - low) / (high - low), 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t)


def faded(east, north, power: int, step, seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Noise of wavelength 2^power m and its slopes, faded by what samples `step` metres apart can carry."""
    value, along_east, along_north = octave(east, north, power, seed)
    weight = octave_weight(power, step)
    return weight * value, weight * along_east, weight * along_north


def speckle(east, north, power: int, step, seed: int) -> np.ndarray:
    """The value of `faded`."""
    return faded(east, north, power, step, seed)[0]


def missing(power: int, step) -> np.ndarray:
    """Variance of what a step leaves out of an octave."""
    weight = octave_weight(power, step)
    return 0.0625 * (1.0 - weight * weight)


def threshold(value, middle: float, half: float, lost) -> np.ndarray:
    """From 0 below `middle` to 1 above, over ±`half` or, for a variance `lost` of `value`, wider."""
    wide = np.sqrt(half * half + 5.0 * np.asarray(lost))
    return smoothstep(-wide, wide, value - middle)


class Cell(NamedTuple):
    """The nearest of one random centre per lattice cell."""

    distance: np.ndarray
    """To it, in cells."""
    border: np.ndarray
    """How much farther the second nearest is, in cells."""
    hash: np.ndarray
    centre: tuple[np.ndarray, np.ndarray]
    """The way to it, east and north, in cells."""


def cells(east, north, power: int, jitter: float, seed: int) -> Cell:
    """The nearest of one random centre per lattice cell 2^power m wide (Worley 1996)."""
    x, y = np.broadcast_arrays(np.asarray(east) / 2.0**power, np.asarray(north) / 2.0**power)
    column, row = np.floor(x), np.floor(y)
    first = np.full(x.shape, 64.0)
    second = first.copy()
    own = np.zeros(x.shape, np.uint32)
    east_of, north_of = np.zeros(x.shape), np.zeros(x.shape)
    for i in (-1, 0, 1):
        for j in (-1, 0, 1):
            h = hash_lattice((column + i).astype(np.int64), (row + j).astype(np.int64), seed)
            across = i + 0.5 + jitter * ((h & np.uint32(0xFFFF)) / 65536.0 - 0.5) - (x - column)
            along = j + 0.5 + jitter * ((h >> np.uint32(16)) / 65536.0 - 0.5) - (y - row)
            d = across**2 + along**2
            nearer = d < first
            second = np.where(nearer, first, np.minimum(second, d))
            own = np.where(nearer, mix_bits(h + np.uint32(0x51)), own)
            first = np.where(nearer, d, first)
            east_of, north_of = np.where(nearer, across, east_of), np.where(nearer, along, north_of)
    distance = np.sqrt(first)
    return Cell(distance, np.sqrt(second) - distance, own, (east_of, north_of))


def random(h: np.ndarray, index: int) -> np.ndarray:
    """The number `index` of a hash, 0…1."""
    with np.errstate(over="ignore"):
        return unit_float(mix_bits(h + np.uint32(index * 0x9E3779B1 & 0xFFFFFFFF)))
