"""Simplex noise that repeats, in 2-D and 3-D: what "simplex" becomes when it is given a period.

The classic shear has no periods in whole cells. These lattices have (S. Gustavson, I. McEwan, "Tiling simplex
noise and flow noise in two and three dimensions", JCGT 11(1), 2022); everything else is as in `simplex.py`.

2-D: rows one apart, whose points are one apart and, in odd rows, half a step aside; so the period along y
must be even. Triangles of base and height 1: a third larger than the classic ones. u = x + y/2, v = y shears
them to halves of squares. A corner ends at the nearest opposite side, at r² = 4/5.

3-D: the points of the whole numbers and those half a cell from them along all axes, which is the classic
lattice turned until it lies along the axes: simplices, kernel and scale are the same. u = y + z, v = x + z,
w = x + y makes them sixths of cubes.

A lattice point is hashed by where it lies, not by its number in the sheared lattice: wrapping is then that of
each axis. In 2-D that is its row and the cell that its column is in; in 3-D twice its coordinates, whole
numbers that are all even or all odd.
"""

from __future__ import annotations

from .gradients import gradient2, unscale
from .kernels import kernel
from .lanes import floor, fma, larger, select, to_float, to_int
from .lattice import axis_hash, axis_pair, index, inlined, neighbour, pair
from .simplex import S3, _share3, _slopes3

REACH2 = 0.8  # squared
S2 = 7.555  # makes 1 the largest possible value


@inlined
def _around(cell, period):
    """A cell, the one before and the one after."""
    return cell, neighbour(cell, -1, period), neighbour(cell, 1, period)


@inlined
def _cell_at(around, twice):
    """The cell in which a place lies, of which `twice` is the double, counted from the middle cell."""
    here, before, after = around
    return select(twice < 0.0, before, select(twice > 1.5, after, here))


@inlined
def _corner2(around, word, hy, x, y, column):
    """Index and way of the corner so far (twice) along x; `y` is its way."""
    return index(axis_hash(_cell_at(around, column), word), hy), fma(column, -0.5, x), y


@inlined
def _corners2(cells, offsets, words, periods):
    around = _around(cells[0], periods[0])
    hy0, hy1 = axis_pair(cells[1], words[1], periods[1])
    x, y = offsets
    aside = to_float(cells[1] & 1)  # half a step in odd rows
    u = fma(y + aside, 0.5, x)
    whole = floor(u)
    low = fma(whole, 2.0, -aside)
    first = u - whole > y
    middle = low + select(first, 2.0, -1.0)
    return (
        _corner2(around, words[0], hy0, x, y, low),
        _corner2(around, words[0], select(first, hy0, hy1), x, y - select(first, 0.0, 1.0), middle),
        _corner2(around, words[0], hy1, x, y - 1.0, low + 1.0),
    )


@inlined
def _slopes2(corner):
    h, x, y = corner
    t = larger(0.0, fma(-x, x, fma(-y, y, REACH2)))
    cube = t * t * t
    fall = cube * t
    gx, gy = gradient2(h)
    ramp = fma(gx, x, gy * y)
    pull = -8.0 * cube * ramp
    return fall * ramp, fma(fall, gx, pull * x), fma(fall, gy, pull * y)


@kernel("simplex_periodic", 2, derivatives=True)
def periodic2_slopes(cells, offsets, words, periods):
    a, b, c = _corners2(cells, offsets, words, periods)
    av, ax, ay = _slopes2(a)
    bv, bx, by = _slopes2(b)
    cv, cx, cy = _slopes2(c)
    return (av + bv + cv) * S2, (ax + bx + cx) * S2, (ay + by + cy) * S2


@kernel("simplex_periodic", 2)
def periodic2(cells, offsets, words, periods):
    return (periodic2_slopes(cells, offsets, words, periods)[0],)  # LLVM drops the rest


@inlined
def _corner3(arounds, words, offsets, i, j, k):
    """Index and way of a corner of the sheared lattice."""
    x, y, z = j + k - i, i + k - j, i + j - k  # twice its place
    ax, ay, az = arounds
    return (
        index(pair(_plane(ax, words[0], x), _plane(ay, words[1], y)), _plane(az, words[2], z)),
        fma(x, -0.5, offsets[0]),
        fma(y, -0.5, offsets[1]),
        fma(z, -0.5, offsets[2]),
    )


@inlined
def _plane(around, word, twice):
    """The hash of a plane of the lattice."""
    cell = _cell_at(around, twice)
    return axis_hash(cell + cell + (to_int(twice) & 1), word)


@inlined
def _corners3(cells, offsets, words, periods):
    arounds = (
        _around(cells[0], periods[0]),
        _around(cells[1], periods[1]),
        _around(cells[2], periods[2]),
    )
    x, y, z = offsets
    u, v, w = y + z, x + z, x + y
    i, j, k = floor(u), floor(v), floor(w)
    u, v, w = u - i, v - j, w - k
    uv, uw, vw = u > v, u > w, v > w
    return (
        _corner3(arounds, words, offsets, i, j, k),
        # a step along the axis of the largest offset
        _corner3(
            arounds,
            words,
            offsets,
            i + select(uv & uw, 1.0, 0.0),
            j + select(~uv & vw, 1.0, 0.0),
            k + select(uw | vw, 0.0, 1.0),
        ),
        # and then one along all but that of the smallest
        _corner3(
            arounds,
            words,
            offsets,
            i + select(uv | uw, 1.0, 0.0),
            j + select(~uv | vw, 1.0, 0.0),
            k + select(uw & vw, 0.0, 1.0),
        ),
        _corner3(arounds, words, offsets, i + 1.0, j + 1.0, k + 1.0),
    )


@kernel("simplex_periodic", 3)
def periodic3(cells, offsets, words, periods):
    a, b, c, d = _corners3(cells, offsets, words, periods)
    fall, ramp = _share3(a)
    total = fall * ramp
    fall, ramp = _share3(b)
    total = fma(fall, ramp, total)
    fall, ramp = _share3(c)
    total = fma(fall, ramp, total)
    fall, ramp = _share3(d)
    return (unscale(fma(fall, ramp, total)) * S3,)


@kernel("simplex_periodic", 3, derivatives=True)
def periodic3_slopes(cells, offsets, words, periods):
    a, b, c, d = _corners3(cells, offsets, words, periods)
    av, ax, ay, az = _slopes3(a)
    bv, bx, by, bz = _slopes3(b)
    cv, cx, cy, cz = _slopes3(c)
    dv, dx, dy, dz = _slopes3(d)
    return (
        unscale(av + bv + cv + dv) * S3,
        unscale(ax + bx + cx + dx) * S3,
        unscale(ay + by + cy + dy) * S3,
        unscale(az + bz + cz + dz) * S3,
    )
