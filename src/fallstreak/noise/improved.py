"""Improved noise exactly as Ken Perlin published it (2002): his permutation, his gradients, his fade.

It repeats after 256 cells along each axis; seeds and octaves are other places of the same field. In 2-D it
is the plane z = 0 of the noise in 3-D. `perlin` looks the same, does not repeat, and costs half.
"""

from __future__ import annotations

from .gradients import gradient3, unscale
from .kernels import kernel
from .lanes import fma
from .lattice import fade, inlined
from .permutation import ORIGIN, lattice_pair, permuted

X, Y, Z = ORIGIN[:3]


@inlined
def _edge(a, b, k, x, y, z, u):
    """Interpolate along x between two corners whose last look-up is still to come."""
    gx, gy, gz = gradient3(permuted(a + k))
    near = fma(gx, x, fma(gy, y, gz * z))
    gx, gy, gz = gradient3(permuted(b + k))
    return fma(u, fma(gx, x - 1.0, fma(gy, y, fma(gz, z, -near))), near)


@kernel("improved", 2)
def improved2(cells, offsets, words, periods):
    x, y = offsets
    i0, i1 = lattice_pair(cells[0], words[0], X, periods[0])
    j0, j1 = lattice_pair(cells[1], words[1], Y, periods[1])
    k = (words[2] ^ Z) & 255
    a, b = permuted(i0), permuted(i1)
    u = fade(x)
    low = _edge(permuted(a + j0), permuted(b + j0), k, x, y, x * 0.0, u)
    high = _edge(permuted(a + j1), permuted(b + j1), k, x, y - 1.0, x * 0.0, u)
    return (unscale(fma(fade(y), high - low, low)),)


@kernel("improved", 3)
def improved3(cells, offsets, words, periods):
    x, y, z = offsets
    i0, i1 = lattice_pair(cells[0], words[0], X, periods[0])
    j0, j1 = lattice_pair(cells[1], words[1], Y, periods[1])
    k0, k1 = lattice_pair(cells[2], words[2], Z, periods[2])
    a, b = permuted(i0), permuted(i1)
    aa, ba, ab, bb = permuted(a + j0), permuted(b + j0), permuted(a + j1), permuted(b + j1)
    u, v = fade(x), fade(y)
    low = _edge(aa, ba, k0, x, y, z, u)
    high = _edge(ab, bb, k0, x, y - 1.0, z, u)
    floor = fma(v, high - low, low)
    low = _edge(aa, ba, k1, x, y, z - 1.0, u)
    high = _edge(ab, bb, k1, x, y - 1.0, z - 1.0, u)
    ceiling = fma(v, high - low, low)
    return (unscale(fma(fade(z), ceiling - floor, floor)),)
