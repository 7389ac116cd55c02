"""Perlin's gradient noise ("Improving noise", 2002) with gradients from a hash instead of a permutation
table.

This file is also the pattern for another kind. A kind is one function per number of dimensions,

    noise(cells, offsets, words, periods) -> (value,)            or, with derivatives, (value, d/dx, d/dy,
    ...)

of tuples with one element per axis: `cells` integer lanes, `offsets` float lanes 0..1 from the cell's lower
corner, `words` integer lanes (see `hashing.py`), `periods` integer lanes or None. It is registered by
decorating it with ``@kernel(kind, dimensions, derivatives=False)`` from `kernels.py`, and the module's name
is added to ``kernels.MODULES``. It is generic over the width of the lanes: use operators, functions of
`lanes.py`, `lattice.py` and `gradients.py`, and for helpers the decorator ``@inlined``. Derivatives are per
cell. `fractal.py` adds octaves up.
"""

from __future__ import annotations

from .gradients import FOUR_SCALE, gradient2, gradient3, gradient4, unscale
from .kernels import kernel
from .lanes import fma
from .lattice import axis_pair, fade, index, inlined, pair


@inlined
def _edge2(hx0, hx1, hy, x, y, u):
    """Interpolate along x between two corners."""
    gx, gy = gradient2(index(hx0, hy))
    near = fma(gx, x, gy * y)
    gx, gy = gradient2(index(hx1, hy))
    # the difference to the near corner starts the sum, which saves subtracting it
    return fma(u, fma(gx, x - 1.0, fma(gy, y, -near)), near)


@kernel("perlin", 2)
def perlin2(cells, offsets, words, periods):
    x, y = offsets
    hx0, hx1 = axis_pair(cells[0], words[0], periods[0])
    hy0, hy1 = axis_pair(cells[1], words[1], periods[1])
    u = fade(x)
    low = _edge2(hx0, hx1, hy0, x, y, u)
    high = _edge2(hx0, hx1, hy1, x, y - 1.0, u)
    return (fma(fade(y), high - low, low),)


@inlined
def _edge3(e0, e1, hz, x, y, z, u):
    gx, gy, gz = gradient3(index(e0, hz))
    near = fma(gx, x, fma(gy, y, gz * z))
    gx, gy, gz = gradient3(index(e1, hz))
    return fma(u, fma(gx, x - 1.0, fma(gy, y, fma(gz, z, -near))), near)


@kernel("perlin", 3)
def perlin3(cells, offsets, words, periods):
    x, y, z = offsets
    hx0, hx1 = axis_pair(cells[0], words[0], periods[0])
    hy0, hy1 = axis_pair(cells[1], words[1], periods[1])
    hz0, hz1 = axis_pair(cells[2], words[2], periods[2])
    e00, e10, e01, e11 = pair(hx0, hy0), pair(hx1, hy0), pair(hx0, hy1), pair(hx1, hy1)
    u, v = fade(x), fade(y)
    low = _edge3(e00, e10, hz0, x, y, z, u)
    high = _edge3(e01, e11, hz0, x, y - 1.0, z, u)
    floor = fma(v, high - low, low)
    low = _edge3(e00, e10, hz1, x, y, z - 1.0, u)
    high = _edge3(e01, e11, hz1, x, y - 1.0, z - 1.0, u)
    ceiling = fma(v, high - low, low)
    return (unscale(fma(fade(z), ceiling - floor, floor)),)


@inlined
def _edge4(e0, e1, k, x, y, z, w, u):
    gx, gy, gz, gw = gradient4(index(e0, k))
    near = fma(gx, x, fma(gy, y, fma(gz, z, gw * w)))
    gx, gy, gz, gw = gradient4(index(e1, k))
    return fma(u, fma(gx, x - 1.0, fma(gy, y, fma(gz, z, fma(gw, w, -near)))), near)


@inlined
def _face4(e00, e10, e01, e11, k, x, y, z, w, u, v):
    low = _edge4(e00, e10, k, x, y, z, w, u)
    high = _edge4(e01, e11, k, x, y - 1.0, z, w, u)
    return fma(v, high - low, low)


@kernel("perlin", 4)
def perlin4(cells, offsets, words, periods):
    x, y, z, w = offsets
    hx0, hx1 = axis_pair(cells[0], words[0], periods[0])
    hy0, hy1 = axis_pair(cells[1], words[1], periods[1])
    hz0, hz1 = axis_pair(cells[2], words[2], periods[2])
    hw0, hw1 = axis_pair(cells[3], words[3], periods[3])
    e00, e10, e01, e11 = pair(hx0, hy0), pair(hx1, hy0), pair(hx0, hy1), pair(hx1, hy1)
    u, v, s = fade(x), fade(y), fade(z)
    floor = _face4(e00, e10, e01, e11, pair(hz0, hw0), x, y, z, w, u, v)
    ceiling = _face4(e00, e10, e01, e11, pair(hz1, hw0), x, y, z - 1.0, w, u, v)
    before = fma(s, ceiling - floor, floor)
    floor = _face4(e00, e10, e01, e11, pair(hz0, hw1), x, y, z, w - 1.0, u, v)
    ceiling = _face4(e00, e10, e01, e11, pair(hz1, hw1), x, y, z - 1.0, w - 1.0, u, v)
    after = fma(s, ceiling - floor, floor)
    return (unscale(fma(fade(w), after - before, before)) * FOUR_SCALE,)
