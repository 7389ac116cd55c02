"""Cellular noise (Worley 1996): distances to the nearest and second nearest of points, one to a cell.

A point may lie anywhere in its cell, so that nothing of the lattice shows. The nearest can then be two cells
away, and the usual block of three cells along each axis misses it now and then, which shows as a cut. Here
that block is searched first; where some lane has found nothing nearer than what is around the block could be,
the ring of cells around it is searched as well, which makes the distances exact and costs little, because it
is seldom.

Distances are Euclidean, in cells, not rescaled: `cellular_f1` the nearest, `cellular_f2` the second nearest,
`cellular_f2f1` their difference, which is 0 on the walls between the cells of the points.
"""

from __future__ import annotations

from llvmlite import ir
from numba.core import types

from .hashing import SCRAMBLE
from .kernels import kernel
from .lanes import as_float, fma, larger, root, shift_right, smaller
from .lattice import axis_hash, inlined, neighbour, pair
from .vectors import TRUTH, Lanes, intrinsic

FIRST, SECOND = SCRAMBLE
ONE = 0x3F800000  # the bits of 1.0, whose mantissa takes 23 bits of a number 0..1
MANTISSA = 0x7FFFFF
FAR = 100.0  # further than any point, squared


@intrinsic
def any_true(typingctx, mask):
    """Whether a truth holds in any lane, as a Python truth."""
    if not isinstance(mask, Lanes) or mask.element != TRUTH:
        return None

    def codegen(context, builder, sig, args):
        if mask.width == 1:
            return args[0]
        bits = builder.bitcast(args[0], ir.IntType(mask.width))
        return builder.icmp_unsigned("!=", bits, ir.Constant(bits.type, 0))

    return types.boolean(mask), codegen


@inlined
def _whole(h):
    """A 16-bit hash as a number of 32 bits."""
    return h & 0xFFFF


@inlined
def _axis(cell, step, word, period):
    """The hash of the lattice plane up to two cells away."""
    near = neighbour(cell, (step > 0) - (step < 0), period)
    if step > 1 or step < -1:  # one by one, because a period may be a single cell
        near = neighbour(near, (step > 0) - (step < 0), period)
    return axis_hash(near, word)


@inlined
def _bits(a, b):
    """`hashing.bits` of two factors, of which the second was multiplied by FIRST."""
    p = a * b
    p = (p ^ shift_right(p, 15)) * SECOND
    return p ^ shift_right(p, 15)


@inlined
def _unit(bits):
    """1 plus a number 0..1 from the low 23 bits."""
    return as_float((bits & MANTISSA) | ONE)


@inlined
def _gap(x, step):
    """How far the cells so many steps away are along one axis, squared."""
    outside = larger(larger(step - x, x - (step + 1)), 0.0)
    return outside * outside


@inlined
def _side(x):
    """The way to the nearer side of the cell."""
    return smaller(x, 1.0 - x)


@inlined
def _nearer(d, near, far):
    """Put one more squared distance in its place."""
    return smaller(d, near), smaller(larger(d, near), far)


@inlined
def _visit2(h, x, y, near, far):
    dx, dy = _unit(shift_right(h, 9)) - x, _unit(h << 7) - y
    return _nearer(fma(dx, dx, dy * dy), near, far)


@inlined
def _visit3(h, x, y, z, near, far):
    dx, dy, dz = _unit(shift_right(h, 9)) - x, _unit(h << 2) - y, _unit(h << 13) - z
    return _nearer(fma(dx, dx, fma(dy, dy, dz * dz)), near, far)


@inlined
def _column(hx, x, rows, y, near, far):
    """Three cells in 2-D; `x` is the way from one cell before."""
    a = _whole(hx) * FIRST
    near, far = _visit2(_bits(rows[0], a), x, y + 1.0, near, far)
    near, far = _visit2(_bits(rows[1], a), x, y + 2.0, near, far)
    return _visit2(_bits(rows[2], a), x, y, near, far)


@inlined
def _row(hxy, x, y, planes, z, near, far):
    """Three cells in 3-D."""
    a = _whole(hxy) * FIRST
    near, far = _visit3(_bits(planes[0], a), x, y, z + 1.0, near, far)
    near, far = _visit3(_bits(planes[1], a), x, y, z + 2.0, near, far)
    return _visit3(_bits(planes[2], a), x, y, z, near, far)


@inlined
def _three(cell, word, period):
    """The hashes of a cell's own lattice plane, the one before and the one after."""
    return _axis(cell, 0, word, period), _axis(cell, -1, word, period), _axis(cell, 1, word, period)


@inlined
def _wholes(h):
    return _whole(h[0]), _whole(h[1]), _whole(h[2])


def _search(dimensions: int, second: bool):
    """The two smallest squared distances; the second only bounds the search where it is wanted."""

    @inlined
    def reached(gap, near, far):
        return any_true(gap < (far if second else near))

    @inlined
    def worth(gap, near, far):
        # the second nearest is seldom found before the last row: asking costs more than looking
        return second or reached(gap, near, far)

    @inlined
    def ring2(cells, x, y, words, periods, near, far):
        for i in range(-2, 3):
            gap = _gap(x, i)
            if reached(gap, near, far):
                a = _whole(_axis(cells[0], i, words[0], periods[0])) * FIRST
                for j in range(-2, 3):
                    if (i * i > 1 or j * j > 1) and reached(gap + _gap(y, j), near, far):
                        b = _whole(_axis(cells[1], j, words[1], periods[1]))
                        near, far = _visit2(_bits(b, a), x + (1 - i), y + (1 - j), near, far)
        return near, far

    @inlined
    def search2(cells, offsets, words, periods):
        x, y = offsets
        near = far = (x + y) * 0.0 + FAR  # NaN where a coordinate is
        hx = _three(cells[0], words[0], periods[0])
        rows = _wholes(_three(cells[1], words[1], periods[1]))
        near, far = _column(hx[0], x + 1.0, rows, y, near, far)
        if worth(_gap(x, -1), near, far):
            near, far = _column(hx[1], x + 2.0, rows, y, near, far)
        if worth(_gap(x, 1), near, far):
            near, far = _column(hx[2], x, rows, y, near, far)
        beyond = smaller(_side(x), _side(y)) + 1.0
        if reached(beyond * beyond, near, far):
            near, far = ring2(cells, x, y, words, periods, near, far)
        return near, far

    @inlined
    def plane(hx, x, gap, hy, y, planes, z, near, far):
        """Nine cells in 3-D."""
        if worth(gap, near, far):
            near, far = _row(pair(hx, hy[0]), x, y + 1.0, planes, z, near, far)
            if worth(gap + _gap(y, -1), near, far):
                near, far = _row(pair(hx, hy[1]), x, y + 2.0, planes, z, near, far)
            if worth(gap + _gap(y, 1), near, far):
                near, far = _row(pair(hx, hy[2]), x, y, planes, z, near, far)
        return near, far

    @inlined
    def ring3(cells, x, y, z, words, periods, near, far):
        for i in range(-2, 3):
            gap_x = _gap(x, i)
            if reached(gap_x, near, far):
                hx = _axis(cells[0], i, words[0], periods[0])
                for j in range(-2, 3):
                    gap = gap_x + _gap(y, j)
                    if reached(gap, near, far):
                        a = _whole(pair(hx, _axis(cells[1], j, words[1], periods[1]))) * FIRST
                        outside = i * i > 1 or j * j > 1
                        for k in range(-2, 3):
                            if (outside or k * k > 1) and reached(gap + _gap(z, k), near, far):
                                h = _bits(_whole(_axis(cells[2], k, words[2], periods[2])), a)
                                near, far = _visit3(h, x + (1 - i), y + (1 - j), z + (1 - k), near, far)
        return near, far

    @inlined
    def search3(cells, offsets, words, periods):
        x, y, z = offsets
        near = far = (x + y + z) * 0.0 + FAR  # NaN where a coordinate is
        hx = _three(cells[0], words[0], periods[0])
        hy = _three(cells[1], words[1], periods[1])
        planes = _wholes(_three(cells[2], words[2], periods[2]))
        near, far = plane(hx[0], x + 1.0, _gap(x, 0), hy, y, planes, z, near, far)
        near, far = plane(hx[1], x + 2.0, _gap(x, -1), hy, y, planes, z, near, far)
        near, far = plane(hx[2], x, _gap(x, 1), hy, y, planes, z, near, far)
        beyond = smaller(smaller(_side(x), _side(y)), _side(z)) + 1.0
        if reached(beyond * beyond, near, far):
            near, far = ring3(cells, x, y, z, words, periods, near, far)
        return near, far

    return search2 if dimensions == 2 else search3


def _register(dimensions: int):
    nearest, both = _search(dimensions, False), _search(dimensions, True)

    @kernel("cellular_f1", dimensions)
    def f1(cells, offsets, words, periods):
        near, _ = nearest(cells, offsets, words, periods)
        return (root(near),)

    @kernel("cellular_f2", dimensions)
    def f2(cells, offsets, words, periods):
        _, far = both(cells, offsets, words, periods)
        return (root(far),)

    @kernel("cellular_f2f1", dimensions)
    def f2f1(cells, offsets, words, periods):
        near, far = both(cells, offsets, words, periods)
        return (root(far) - root(near),)


for _dimensions in (2, 3):
    _register(_dimensions)
