"""Cellular noise (Worley 1996): distances to the nearest and the second nearest of points scattered one to a cell.

A point may lie anywhere in its cell, so that nothing of the lattice shows. The nearest can then be two cells away, and
the usual block of three cells along each axis misses it now and then, which shows as a cut. Here all cells are looked
at that could hold a nearer point, and no others: going outwards, a plane, a row or a cell is passed over when it lies
further than what all lanes have found so far.

Distances are Euclidean, in cells, not rescaled: `cellular_f1` the nearest, `cellular_f2` the second nearest,
`cellular_f2f1` their difference, which is 0 on the walls between the cells of the points.
"""

from __future__ import annotations

from llvmlite import ir
from numba.core import types
from numba.extending import intrinsic

from .hashing import SCRAMBLE
from .kernels import kernel
from .lanes import TRUTH, Lanes, as_float, fma, larger, root, shift_right, smaller
from .lattice import axis_hash, inlined, neighbour, pair

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
def _plane(cell, step, word, period):
    """The 16-bit hash of the lattice plane so many cells away, with nothing above it."""
    near = neighbour(cell, (step > 0) - (step < 0), period)
    if step > 1 or step < -1:  # one by one, because a period may be a single cell
        near = neighbour(near, (step > 0) - (step < 0), period)
    return whole(axis_hash(near, word))


@inlined
def whole(h):
    """A 16-bit hash as a number of 32 bits."""
    return (h << 16) >> 16


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
def _ordered(k):
    """0, -1, 1, -2, 2 for 0 to 4."""
    return (k + 1) // 2 * (1 - k % 2 * 2)


@inlined
def _nearer(d, near, far):
    """Put one more squared distance in its place."""
    return smaller(d, near), smaller(larger(d, near), far)


def _search(dimensions: int, second: bool):
    """The two smallest squared distances; the second only bounds the search where it is wanted."""

    @inlined
    def reached(gap, near, far):
        return any_true(gap < (far if second else near))

    @inlined
    def visit2(h, x, y, near, far):
        dx, dy = _unit(shift_right(h, 9)) - x, _unit(h << 7) - y
        return _nearer(fma(dx, dx, dy * dy), near, far)

    @inlined
    def search2(cells, offsets, words, periods):
        x, y = offsets
        near = far = (x + y) * 0.0 + FAR  # NaN where a coordinate is
        for i in range(5):
            step = _ordered(i)
            gap = _gap(x, step)
            if reached(gap, near, far):
                a = _plane(cells[0], step, words[0], periods[0]) * FIRST
                dx = x + (1 - step)
                for j in range(5):
                    step = _ordered(j)
                    if reached(gap + _gap(y, step), near, far):
                        b = _plane(cells[1], step, words[1], periods[1])
                        near, far = visit2(_bits(b, a), dx, y + (1 - step), near, far)
        return near, far

    @inlined
    def visit3(h, x, y, z, near, far):
        dx, dy, dz = _unit(shift_right(h, 9)) - x, _unit(h << 2) - y, _unit(h << 13) - z
        return _nearer(fma(dx, dx, fma(dy, dy, dz * dz)), near, far)

    @inlined
    def search3(cells, offsets, words, periods):
        x, y, z = offsets
        near = far = (x + y + z) * 0.0 + FAR  # NaN where a coordinate is
        # the planes of z are met in every row: hash them once
        here = _plane(cells[2], 0, words[2], periods[2])
        below = _plane(cells[2], -1, words[2], periods[2])
        above = _plane(cells[2], 1, words[2], periods[2])
        gap_below, gap_above = _gap(z, -1), _gap(z, 1)
        gap_beyond = smaller(_gap(z, -2), _gap(z, 2))
        for i in range(5):
            step = _ordered(i)
            plane = _gap(x, step)
            if reached(plane, near, far):
                hx = axis_hash_at(cells[0], step, words[0], periods[0])
                dx = x + (1 - step)
                for j in range(5):
                    step = _ordered(j)
                    row = plane + _gap(y, step)
                    if reached(row, near, far):
                        hy = axis_hash_at(cells[1], step, words[1], periods[1])
                        a = whole(pair(hx, hy)) * FIRST
                        dy = y + (1 - step)
                        near, far = visit3(_bits(here, a), dx, dy, z + 1.0, near, far)
                        if reached(row + gap_below, near, far):
                            near, far = visit3(_bits(below, a), dx, dy, z + 2.0, near, far)
                        if reached(row + gap_above, near, far):
                            near, far = visit3(_bits(above, a), dx, dy, z, near, far)
                        if reached(row + gap_beyond, near, far):
                            b = _plane(cells[2], -2, words[2], periods[2])
                            near, far = visit3(_bits(b, a), dx, dy, z + 3.0, near, far)
                            b = _plane(cells[2], 2, words[2], periods[2])
                            near, far = visit3(_bits(b, a), dx, dy, z - 1.0, near, far)
        return near, far

    return search2 if dimensions == 2 else search3


@inlined
def axis_hash_at(cell, step, word, period):
    near = neighbour(cell, (step > 0) - (step < 0), period)
    if step > 1 or step < -1:
        near = neighbour(near, (step > 0) - (step < 0), period)
    return axis_hash(near, word)


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
