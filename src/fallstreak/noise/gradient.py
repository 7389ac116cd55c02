"""Gradient noise on a hashed lattice, numpy twin of ``gradient.wesl``: the same integers, the same heights.

Perlin's noise ("Improving noise", 2002: quintic fade) with gradients drawn from a hash of the lattice point
instead of a permutation table, so that it repeats only after 2^32 cells. Coordinates are split into an
integer cell and a fraction by whoever calls, because a float32 on the GPU cannot hold both far from the
origin.
"""

from __future__ import annotations

import numpy as np

#: makes the standard deviation of one octave 0.25 (measured over 2 million points); the largest is about 1.2
AMPLITUDE = 1.42


def hash_lattice(x: np.ndarray, y: np.ndarray, seed: int) -> np.ndarray:
    """Hash integer lattice points to uint32, two full rounds so that neighbouring seeds do not correlate.

    Parameters
    ----------
    x, y : integer arrays of one shape (any integer type; taken modulo 2^32)
    seed : int
    """
    with np.errstate(over="ignore"):
        row = _mix(np.asarray(y).astype(np.uint32) + np.uint32(seed & 0xFFFFFFFF) * np.uint32(0x9E3779B1))
        return _mix(np.asarray(x).astype(np.uint32) + row)


def _mix(h: np.ndarray) -> np.ndarray:
    # A bijection of 32 bits with low bias (constants found by search: C. Wellons, "hash prospector").
    h = np.asarray(h, np.uint32)
    h = (h ^ (h >> np.uint32(16))) * np.uint32(0x7FEB352D)
    h = (h ^ (h >> np.uint32(15))) * np.uint32(0x846CA68B)
    return h ^ (h >> np.uint32(16))


def gradient_noise(x: np.ndarray, y: np.ndarray, seed: int = 0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """One octave of 2-D gradient noise.

    Parameters
    ----------
    x, y : float arrays of one shape, in cells (the lattice has spacing 1)
    seed : int

    Returns
    -------
    value, d/dx, d/dy : float64 arrays of that shape; the value has standard deviation 0.25 and mean 0.
    """
    (fx, fy), ((ax, ay, a), (bx, by, b), (cx, cy, c), (dx, dy, d)) = _corners(x, y, seed)
    ux, uy = _fade(fx), _fade(fy)
    dux, duy = _fade_slope(fx), _fade_slope(fy)
    k = a - b - c + d
    value = a + ux * (b - a) + uy * (c - a) + ux * uy * k
    slope_x = ax + ux * (bx - ax) + uy * (cx - ax) + ux * uy * (ax - bx - cx + dx) + dux * (b - a + uy * k)
    slope_y = ay + ux * (by - ay) + uy * (cy - ay) + ux * uy * (ay - by - cy + dy) + duy * (c - a + ux * k)
    return value * AMPLITUDE, slope_x * AMPLITUDE, slope_y * AMPLITUDE


def gradient_value(x: np.ndarray, y: np.ndarray, seed: int = 0) -> np.ndarray:
    """The value of `gradient_noise` alone, at half the cost."""
    (fx, fy), (a, b, c, d) = _corners(x, y, seed)
    ux = _fade(fx)
    near = a[2] + ux * (b[2] - a[2])
    return (near + _fade(fy) * (c[2] + ux * (d[2] - c[2]) - near)) * AMPLITUDE


def _corners(x, y, seed):
    """Fractions in the cell; for its four corners the gradient and its product with the way from there."""
    x, y = np.broadcast_arrays(np.asarray(x, np.float64), np.asarray(y, np.float64))
    cell_x, cell_y = np.floor(x), np.floor(y)
    fx, fy = x - cell_x, y - cell_y
    column = cell_x.astype(np.int64).astype(np.uint32)
    row = cell_y.astype(np.int64).astype(np.uint32)
    start = np.uint32(seed * 0x9E3779B1 & 0xFFFFFFFF)
    one = np.uint32(1)
    corners = []
    for j in (0, 1):
        line = _mix(row + (start + one if j else start))
        for i in (0, 1):
            h = _mix(column + (line + one if i else line))
            gx = (h & np.uint32(0xFFFF)).astype(np.float64) / 32768.0 - 1.0
            gy = (h >> np.uint32(16)).astype(np.float64) / 32768.0 - 1.0
            corners.append((gx, gy, gx * (fx - i) + gy * (fy - j)))
    return (fx, fy), corners


def fbm(x: np.ndarray, y: np.ndarray, octaves: int, seed: int = 0, gain: float = 0.5) -> np.ndarray:
    """Fractional Brownian motion: ``octaves`` octaves, each twice as fine and ``gain`` times as strong.

    The sum of the amplitudes is 1 for gain 0.5 and many octaves. Octave ``i`` uses ``seed + i``.
    """
    total = np.zeros(np.broadcast(x, y).shape)
    for octave in range(octaves):
        scale = 2.0**octave
        total += (
            gain ** (octave + 1)
            * gradient_noise(np.asarray(x) * scale, np.asarray(y) * scale, seed + octave)[0]
        )
    return total


def _fade(t: np.ndarray) -> np.ndarray:
    return t * t * t * (t * (t * 6.0 - 15.0) + 10.0)


def _fade_slope(t: np.ndarray) -> np.ndarray:
    return 30.0 * t * t * (t * (t - 2.0) + 1.0)
