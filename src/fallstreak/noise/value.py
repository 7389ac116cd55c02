"""Value noise: a random number at every lattice point, between them Perlin's quintic fade.

Cheap, and it shows: extrema sit on the lattice, and a tenth of the energy is where the lower octaves draw.

The hashes are those of `lattice.py`, but they stand in the upper halves of the lanes and nothing below the
first axis': so do their products then, and are numbers to convert as they are.
"""

from __future__ import annotations

from llvmlite import ir

from .kernels import kernel
from .lanes import fma, to_float
from .lattice import HIGH_AND_ODD, MULTIPLY, fade, inlined, neighbour
from .vectors import I32, INT, Lanes, constant, intrinsic

SCALE = 2.0**-31  # of a signed 16-bit number in the upper half
HIGH = -0x10000  # the upper half
SET = HIGH_AND_ODD << 16


@inlined
def _axis(cell, word):
    """`lattice.axis_hash` in the upper half; what stands below is of no use."""
    t = cell * MULTIPLY + word
    return (t ^ (t << 16)) | SET


@inlined
def _axes(cell, word, period):
    return _axis(cell, word), _axis(neighbour(cell, 1, period), word)


@intrinsic
def _product(typingctx, a, b):
    """The product of the upper halves, modulo 2^16, in the upper half; 0 below, as it must be below `a`."""
    if not isinstance(a, Lanes) or a != b or a.element != INT:
        return None

    def codegen(context, builder, sig, args):
        if a.width == 1:
            return builder.mul(builder.lshr(args[0], I32(16)), builder.and_(args[1], constant(a, HIGH)))
        halves = ir.VectorType(ir.IntType(16), 2 * a.width)
        return builder.bitcast(builder.mul(*(builder.bitcast(v, halves) for v in args)), args[0].type)

    return a(a, b), codegen


@inlined
def _edge(a0, a1, b, u):
    near = to_float(_product(a0, b))
    return fma(u, to_float(_product(a1, b)) - near, near)


@kernel("value", 2)
def value2(cells, offsets, words, periods):
    hx0, hx1 = _axes(cells[0], words[0], periods[0])
    hy0, hy1 = _axes(cells[1], words[1], periods[1])
    hx0, hx1 = hx0 & HIGH, hx1 & HIGH
    u = fade(offsets[0])
    low = _edge(hx0, hx1, hy0, u)
    return (SCALE * fma(fade(offsets[1]), _edge(hx0, hx1, hy1, u) - low, low),)


@kernel("value", 3)
def value3(cells, offsets, words, periods):
    hx0, hx1 = _axes(cells[0], words[0], periods[0])
    hy0, hy1 = _axes(cells[1], words[1], periods[1])
    hz0, hz1 = _axes(cells[2], words[2], periods[2])
    hx0, hx1 = hx0 & HIGH, hx1 & HIGH
    e00, e10, e01, e11 = _product(hx0, hy0), _product(hx1, hy0), _product(hx0, hy1), _product(hx1, hy1)
    u, v = fade(offsets[0]), fade(offsets[1])
    low = _edge(e00, e10, hz0, u)
    floor = fma(v, _edge(e01, e11, hz0, u) - low, low)
    low = _edge(e00, e10, hz1, u)
    ceiling = fma(v, _edge(e01, e11, hz1, u) - low, low)
    return (SCALE * fma(fade(offsets[2]), ceiling - floor, floor),)
