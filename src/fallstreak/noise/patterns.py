"""Perlin noise in the scale that looks are made in, standard deviation 0.25: twin of ``patterns.wesl``.

2-D, in numpy and float64: what a scene asks for on the CPU is little, and a first picture shall not wait for
a compiler. The values are those of `fallstreak.noise.sample`.
"""

from __future__ import annotations

from functools import lru_cache
from math import floor, isfinite

import numpy as np
from numpy.typing import ArrayLike

from .directions import GRADIENTS2
from .hashing import MULTIPLIER, axis_hash, axis_words, index

SCALE = 0.7569  # 0.25 over the standard deviation of Perlin noise in 2-D

_GX, _GY = np.array(GRADIENTS2).T
_words = lru_cache(1024)(axis_words)


def value(x: ArrayLike, y: ArrayLike, seed: int) -> np.ndarray:
    """One octave of 2-D noise.

    Parameters
    ----------
    x, y : arrays, broadcast against each other
        In cells, taken as float64.
    seed : int
        Any; taken modulo 2^32.

    Returns
    -------
    float64 array
        Mean 0, standard deviation 0.25, at most about 0.77.
    """
    if _is_one_place(x, y):
        return _slope_at(float(x), float(y), seed)[0]  # type: ignore[arg-type]
    (fx, fy), ((_, _, a), (_, _, b), (_, _, c), (_, _, d)) = _corners(x, y, seed)
    u = _fade(fx)
    near = a + u * (b - a)
    return SCALE * (near + _fade(fy) * (c + u * (d - c) - near))


def slope(x: ArrayLike, y: ArrayLike, seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """As `value`, with the derivatives along x and y, per cell."""
    if _is_one_place(x, y):
        return _slope_at(float(x), float(y), seed)  # type: ignore[arg-type]
    return _mixed(*_corners(x, y, seed))


def _is_one_place(x: ArrayLike, y: ArrayLike) -> bool:
    return np.ndim(x) == 0 and np.ndim(y) == 0 and isfinite(x) and isfinite(y)  # type: ignore[arg-type]


def _slope_at(x: float, y: float, seed: int):
    """`slope` at one place in plain numbers: a camera asks for the ground below it in every frame, and numpy
    takes ten times as long for an array of one."""
    column, row = floor(x), floor(y)
    fx, fy = x - column, y - row
    word_x, word_y, *_ = _words(seed & 0xFFFFFFFF, 0)
    hx = axis_hash(column, word_x), axis_hash(column + 1, word_x)
    hy = axis_hash(row, word_y), axis_hash(row + 1, word_y)
    corners = []
    for j in (0, 1):
        for i in (0, 1):
            gx, gy = GRADIENTS2[index(hx[i], hy[j], 8)]
            corners.append((gx, gy, gx * (fx - i) + gy * (fy - j)))
    return tuple(np.float64(number) for number in _mixed((fx, fy), corners))


def _mixed(place, corners):
    """Value and derivatives in a cell, from what its corners give."""
    (fx, fy), ((ax, ay, a), (bx, by, b), (cx, cy, c), (dx, dy, d)) = place, corners
    u, v = _fade(fx), _fade(fy)
    k = a - b - c + d
    found = a + u * (b - a) + v * (c - a) + u * v * k
    along_x = ax + u * (bx - ax) + v * (cx - ax) + u * v * (ax - bx - cx + dx) + _rise(fx) * (b - a + v * k)
    along_y = ay + u * (by - ay) + v * (cy - ay) + u * v * (ay - by - cy + dy) + _rise(fy) * (c - a + u * k)
    return SCALE * found, SCALE * along_x, SCALE * along_y


def _corners(x: ArrayLike, y: ArrayLike, seed: int):
    """Places in the cell; for its corners (0,0), (1,0), (0,1), (1,1) the gradient and its product with the
    way."""
    x, y = np.broadcast_arrays(np.asarray(x, np.float64), np.asarray(y, np.float64))
    columns, rows = np.floor(x), np.floor(y)
    fx, fy = x - columns, y - rows
    word_x, word_y, *_ = _words(seed & 0xFFFFFFFF, 0)
    hx, hy = _planes(columns, word_x), _planes(rows, word_y)
    corners = []
    for j in (0, 1):
        for i in (0, 1):
            index = (hx[i] * hy[j] >> np.uint32(16)) & np.uint32(7)
            gx, gy = _GX[index], _GY[index]
            corners.append((gx, gy, gx * (fx - i) + gy * (fy - j)))
    return (fx, fy), corners


def _planes(cell: np.ndarray, word: int) -> tuple[np.ndarray, np.ndarray]:
    """`hashing.axis_hash` of a cell's own lattice plane and of the next."""
    with np.errstate(over="ignore"):
        own = np.asarray(cell.astype(np.int64).astype(np.uint32)) * np.uint32(MULTIPLIER) + np.uint32(word)
        both = own, own + np.uint32(MULTIPLIER)
    return tuple(((t ^ (t >> np.uint32(16))) & np.uint32(0xFFFF)) | np.uint32(0x8001) for t in both)  # type: ignore[return-value]


def _fade(t: np.ndarray) -> np.ndarray:
    return t * t * t * (t * (t * 6.0 - 15.0) + 10.0)


def _rise(t: np.ndarray) -> np.ndarray:
    """The derivative of `_fade`."""
    return 30.0 * t * t * (t * (t - 2.0) + 1.0)
