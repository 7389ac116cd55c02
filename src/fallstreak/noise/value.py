"""Value noise: a random number at every lattice point, between them Perlin's quintic fade.

Cheap, and it shows: extrema sit on the lattice, and a tenth of the energy is where the lower octaves draw.
"""

from __future__ import annotations

from .kernels import kernel
from .lanes import fma, to_float
from .lattice import axis_pair, fade, inlined, pair

SCALE = 2.0**-31  # of a signed 16-bit number that stands in the upper half


@inlined
def _corner(a, b):
    """The number that a corner draws, times 2^31; shifting up clears what stands above the 16 bits."""
    return to_float(pair(a, b) << 16)


@inlined
def _edge(a0, a1, b, u):
    near = _corner(a0, b)
    return fma(u, _corner(a1, b) - near, near)


@kernel("value", 2)
def value2(cells, offsets, words, periods):
    hx0, hx1 = axis_pair(cells[0], words[0], periods[0])
    hy0, hy1 = axis_pair(cells[1], words[1], periods[1])
    u = fade(offsets[0])
    low = _edge(hx0, hx1, hy0, u)
    return (SCALE * fma(fade(offsets[1]), _edge(hx0, hx1, hy1, u) - low, low),)


@kernel("value", 3)
def value3(cells, offsets, words, periods):
    hx0, hx1 = axis_pair(cells[0], words[0], periods[0])
    hy0, hy1 = axis_pair(cells[1], words[1], periods[1])
    hz0, hz1 = axis_pair(cells[2], words[2], periods[2])
    e00, e10, e01, e11 = pair(hx0, hy0), pair(hx1, hy0), pair(hx0, hy1), pair(hx1, hy1)
    u, v = fade(offsets[0]), fade(offsets[1])
    low = _edge(e00, e10, hz0, u)
    floor = fma(v, _edge(e01, e11, hz0, u) - low, low)
    low = _edge(e00, e10, hz1, u)
    ceiling = fma(v, _edge(e01, e11, hz1, u) - low, low)
    return (SCALE * fma(fade(offsets[2]), ceiling - floor, floor),)
