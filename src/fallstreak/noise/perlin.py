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

from .directions import FOUR_SCALE
from .gradients import gradient2, gradient3, gradient4, unscale
from .kernels import kernel
from .lanes import fma
from .lattice import axis_pair, fade, fade_slope, index, inlined, mix, pair


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


# -- with derivatives: each interpolation carries those of its ends, and adds its own slope to its axis ---


@inlined
def _edge2_slopes(hx0, hx1, hy, x, y, u, du):
    ax, ay = gradient2(index(hx0, hy))
    near = fma(ax, x, ay * y)
    bx, by = gradient2(index(hx1, hy))
    rise = fma(bx, x - 1.0, fma(by, y, -near))
    return fma(u, rise, near), fma(du, rise, mix(u, ax, bx)), mix(u, ay, by)


@kernel("perlin", 2, derivatives=True)
def perlin2_slopes(cells, offsets, words, periods):
    x, y = offsets
    hx0, hx1 = axis_pair(cells[0], words[0], periods[0])
    hy0, hy1 = axis_pair(cells[1], words[1], periods[1])
    u, du, v = fade(x), fade_slope(x), fade(y)
    a, ax, ay = _edge2_slopes(hx0, hx1, hy0, x, y, u, du)
    b, bx, by = _edge2_slopes(hx0, hx1, hy1, x, y - 1.0, u, du)
    rise = b - a
    return fma(v, rise, a), mix(v, ax, bx), fma(fade_slope(y), rise, mix(v, ay, by))


@inlined
def _edge3_slopes(e0, e1, k, x, y, z, u, du):
    ax, ay, az = gradient3(index(e0, k))
    near = fma(ax, x, fma(ay, y, az * z))
    bx, by, bz = gradient3(index(e1, k))
    rise = fma(bx, x - 1.0, fma(by, y, fma(bz, z, -near)))
    return fma(u, rise, near), fma(du, rise, mix(u, ax, bx)), mix(u, ay, by), mix(u, az, bz)


@inlined
def _face3_slopes(e00, e10, e01, e11, k, x, y, z, u, du, v, dv):
    a, ax, ay, az = _edge3_slopes(e00, e10, k, x, y, z, u, du)
    b, bx, by, bz = _edge3_slopes(e01, e11, k, x, y - 1.0, z, u, du)
    rise = b - a
    return fma(v, rise, a), mix(v, ax, bx), fma(dv, rise, mix(v, ay, by)), mix(v, az, bz)


@kernel("perlin", 3, derivatives=True)
def perlin3_slopes(cells, offsets, words, periods):
    x, y, z = offsets
    hx0, hx1 = axis_pair(cells[0], words[0], periods[0])
    hy0, hy1 = axis_pair(cells[1], words[1], periods[1])
    hz0, hz1 = axis_pair(cells[2], words[2], periods[2])
    e00, e10, e01, e11 = pair(hx0, hy0), pair(hx1, hy0), pair(hx0, hy1), pair(hx1, hy1)
    u, du, v, dv, w = fade(x), fade_slope(x), fade(y), fade_slope(y), fade(z)
    a, ax, ay, az = _face3_slopes(e00, e10, e01, e11, hz0, x, y, z, u, du, v, dv)
    b, bx, by, bz = _face3_slopes(e00, e10, e01, e11, hz1, x, y, z - 1.0, u, du, v, dv)
    rise = b - a
    return (
        unscale(fma(w, rise, a)),
        unscale(mix(w, ax, bx)),
        unscale(mix(w, ay, by)),
        unscale(fma(fade_slope(z), rise, mix(w, az, bz))),
    )


@inlined
def _edge4_slopes(e0, e1, k, x, y, z, w, u, du):
    ax, ay, az, aw = gradient4(index(e0, k))
    near = fma(ax, x, fma(ay, y, fma(az, z, aw * w)))
    bx, by, bz, bw = gradient4(index(e1, k))
    rise = fma(bx, x - 1.0, fma(by, y, fma(bz, z, fma(bw, w, -near))))
    slope = fma(du, rise, mix(u, ax, bx))
    return fma(u, rise, near), slope, mix(u, ay, by), mix(u, az, bz), mix(u, aw, bw)


@inlined
def _face4_slopes(e00, e10, e01, e11, k, x, y, z, w, u, du, v, dv):
    a, ax, ay, az, aw = _edge4_slopes(e00, e10, k, x, y, z, w, u, du)
    b, bx, by, bz, bw = _edge4_slopes(e01, e11, k, x, y - 1.0, z, w, u, du)
    rise = b - a
    return fma(v, rise, a), mix(v, ax, bx), fma(dv, rise, mix(v, ay, by)), mix(v, az, bz), mix(v, aw, bw)


@inlined
def _cube4_slopes(e00, e10, e01, e11, k0, k1, x, y, z, w, u, du, v, dv, s, ds):
    a, ax, ay, az, aw = _face4_slopes(e00, e10, e01, e11, k0, x, y, z, w, u, du, v, dv)
    b, bx, by, bz, bw = _face4_slopes(e00, e10, e01, e11, k1, x, y, z - 1.0, w, u, du, v, dv)
    rise = b - a
    return fma(s, rise, a), mix(s, ax, bx), mix(s, ay, by), fma(ds, rise, mix(s, az, bz)), mix(s, aw, bw)


@kernel("perlin", 4, derivatives=True)
def perlin4_slopes(cells, offsets, words, periods):
    x, y, z, w = offsets
    hx0, hx1 = axis_pair(cells[0], words[0], periods[0])
    hy0, hy1 = axis_pair(cells[1], words[1], periods[1])
    hz0, hz1 = axis_pair(cells[2], words[2], periods[2])
    hw0, hw1 = axis_pair(cells[3], words[3], periods[3])
    e00, e10, e01, e11 = pair(hx0, hy0), pair(hx1, hy0), pair(hx0, hy1), pair(hx1, hy1)
    u, du, v, dv, s, ds = fade(x), fade_slope(x), fade(y), fade_slope(y), fade(z), fade_slope(z)
    k0, k1 = pair(hz0, hw0), pair(hz1, hw0)
    a, ax, ay, az, aw = _cube4_slopes(e00, e10, e01, e11, k0, k1, x, y, z, w, u, du, v, dv, s, ds)
    k0, k1 = pair(hz0, hw1), pair(hz1, hw1)
    b, bx, by, bz, bw = _cube4_slopes(e00, e10, e01, e11, k0, k1, x, y, z, w - 1.0, u, du, v, dv, s, ds)
    rise, t = b - a, fade(w)
    return (
        unscale(fma(t, rise, a)) * FOUR_SCALE,
        unscale(mix(t, ax, bx)) * FOUR_SCALE,
        unscale(mix(t, ay, by)) * FOUR_SCALE,
        unscale(mix(t, az, bz)) * FOUR_SCALE,
        unscale(fma(fade_slope(w), rise, mix(t, aw, bw))) * FOUR_SCALE,
    )
