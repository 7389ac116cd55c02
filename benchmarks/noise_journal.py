"""The Infinity journal's way to fast noise of 2007, step by step, one sample after the other.

Straightforward Improved noise, then a fast conversion to integers, then a table of random values in place of
the gradients. In double precision, compiled by Numba, without vectors. Timed beside the journal's
own 7270, 3324 and 1027 ms; what remains of such tables with today's vectors is the kind "table".
"""

from __future__ import annotations

import ctypes
import ctypes.util
from collections.abc import Callable

import numpy as np
from numba import njit

STEPS = ("plain", "rounding", "table")
PUBLISHED = {"plain": 7270.0, "rounding": 3324.0, "table": 1027.0}  # ms on a Pentium 4

_random = np.random.default_rng(2007)
_P = np.tile(_random.permutation(256), 2).astype(np.uint16)
_VALUES = _random.uniform(-0.7, 0.7, 512)

# Compilers of the time called the C library for it; today it is one instruction unless one asks for that.
_floor = ctypes.CDLL(ctypes.util.find_library("m")).floor
_floor.restype, _floor.argtypes = ctypes.c_double, [ctypes.c_double]


def runner(step: str, points: tuple[np.ndarray, ...], octaves: int) -> Callable[[], object]:
    """A function of no arguments that fills all points by one of `STEPS`."""
    fill, out = _LOOPS[step], np.empty(len(points[0]))
    return lambda: fill(*points, octaves, out)


@njit
def _fade(t):
    return t * t * t * (t * (t * 6.0 - 15.0) + 10.0)


@njit
def _lerp(t, a, b):
    return a + t * (b - a)


@njit
def _slope(h, x, y, z):
    h &= 15
    u = x if h < 8 else y
    v = y if h < 4 else (x if h == 12 or h == 14 else z)
    return (u if h & 1 == 0 else -u) + (v if h & 2 == 0 else -v)


@njit
def _improved(x, y, z, i, j, k):
    i, j, k = i & 255, j & 255, k & 255
    u, v, w = _fade(x), _fade(y), _fade(z)
    a, b = _P[i] + j, _P[i + 1] + j
    aa, ab, ba, bb = _P[a] + k, _P[a + 1] + k, _P[b] + k, _P[b + 1] + k
    low = _lerp(
        v,
        _lerp(u, _slope(_P[aa], x, y, z), _slope(_P[ba], x - 1, y, z)),
        _lerp(u, _slope(_P[ab], x, y - 1, z), _slope(_P[bb], x - 1, y - 1, z)),
    )
    high = _lerp(
        v,
        _lerp(u, _slope(_P[aa + 1], x, y, z - 1), _slope(_P[ba + 1], x - 1, y, z - 1)),
        _lerp(u, _slope(_P[ab + 1], x, y - 1, z - 1), _slope(_P[bb + 1], x - 1, y - 1, z - 1)),
    )
    return _lerp(w, low, high)


@njit
def _table(x, y, z, i, j, k):
    i, j, k = i & 255, j & 255, k & 255
    u, v, w = _fade(x), _fade(y), _fade(z)
    a, b = _P[i] + j, _P[i + 1] + j
    aa, ab, ba, bb = _P[a] + k, _P[a + 1] + k, _P[b] + k, _P[b + 1] + k
    low = _lerp(v, _lerp(u, _VALUES[aa], _VALUES[ba]), _lerp(u, _VALUES[ab], _VALUES[bb]))
    high = _lerp(
        v,
        _lerp(u, _VALUES[aa + 1], _VALUES[ba + 1]),
        _lerp(u, _VALUES[ab + 1], _VALUES[bb + 1]),
    )
    return _lerp(w, low, high)


@njit
def _call_floor(x):
    return np.int64(_floor(x))


@njit
def _fast_floor(x):
    whole = np.int64(x)
    return whole - (x < whole)


def _loop(noise, floor):
    @njit
    def fill(x, y, z, octaves, out):
        for n in range(len(out)):
            total, weight, scale = 0.0, 1.0, 1.0
            for _ in range(octaves):
                px, py, pz = scale * x[n], scale * y[n], scale * z[n]
                i, j, k = floor(px), floor(py), floor(pz)
                total += weight * noise(px - i, py - j, pz - k, i, j, k)
                weight *= 0.5
                scale *= 2.0
            out[n] = total

    return fill


_LOOPS = {
    "plain": _loop(_improved, _call_floor),
    "rounding": _loop(_improved, _fast_floor),
    "table": _loop(_table, _fast_floor),
}
