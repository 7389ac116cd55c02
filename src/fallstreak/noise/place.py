"""From coordinates to lattice cells and the way into them: the first of the two loops over a tile.

A cell is kept as the bits of a float: ``1.5 * 2^23 + cell`` has the cell in its lowest bits, so that
rounding a coordinate to a whole number and turning it into an integer are one addition. `cell_of` takes the
excess off again, which LLVM moves into constants. Where that would not be exact (coordinates beyond four
million cells, float64 points, periods) cells are found in float64 and keep their low 32 bits, up to 2^51.
"""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba.core.registry import cpu_target
from numba.extending import overload

from .lanes import (
    I32,
    Lanes,
    as_int,
    call,
    constant,
    features,
    floor,
    fma,
    intrinsic,
    load_doubles,
    load_floats,
    low_bits,
    narrow,
    select,
    splat,
    splat_double,
    store,
    widen,
)
from .lattice import inlined

TILE = 256
MAGIC = 12582912.0  # 1.5 * 2^23
EXCESS = 0x4B400000  # its bits
MAGIC_DOUBLE = 6755399441055744.0  # 1.5 * 2^52
REACH = 4194304.0  # 2^22: cells beyond are found in float64


@intrinsic
def _rounded_down(typingctx, x, scale):
    """x * scale + MAGIC, rounded towards minus infinity, by AVX-512's rounding mode of a single
    instruction."""
    if x != scale or not isinstance(x, Lanes):
        return None

    def codegen(context, builder, sig, args):
        magic = constant(x, MAGIC)
        return call(builder, "llvm.x86.avx512.vfmadd.ps.512", magic.type, [*args, magic, I32(9)])

    return x(x, scale), codegen


def _settle(x, scale) -> Any:
    """MAGIC + the cell of x * scale."""


@overload(_settle, jit_options={"forceinline": True})
def _overload_settle(x, scale):
    if x.width == 16 and "avx512f" in features(cpu_target.target_context):
        return lambda x, scale: _rounded_down(x, scale)
    # rounding to the nearest, half a cell lower: at a whole number the offset may be 1 in the cell below
    # instead of 0
    return lambda x, scale: fma(x, scale, -0.5) + MAGIC


@inlined
def cell_of(bits):
    """The cell from what `place` stored."""
    return bits - EXCESS


def width_of(static) -> Any:
    """The width of the lanes, known to the compiler."""


@overload(width_of, jit_options={"forceinline": True})
def _width_of(static):
    width = static.value.width
    return lambda static: width


@inlined
def place_near(static, points, cells, offsets, frequency):
    """Cells and offsets of one axis of a tile of float32 coordinates within `REACH`."""
    high = _float32(frequency)
    low = _float32(frequency - high)
    scale, rest = splat(static, high), splat(static, low)
    if low == 0.0:
        for i in range(0, TILE, width_of(static)):
            x = load_floats(static, points, i)
            settled = _settle(x, scale)
            store(cells, i, as_int(settled))
            store(offsets, i, fma(x, scale, MAGIC - settled))
    else:
        for i in range(0, TILE, width_of(static)):
            x = load_floats(static, points, i)
            settled = _settle(x, scale)
            store(cells, i, as_int(settled))
            store(offsets, i, fma(x, rest, fma(x, scale, MAGIC - settled)))


@intrinsic
def _float32(typingctx, x):
    """A Python float rounded to float32, as a Python float of that type."""
    from numba.core import types

    def codegen(context, builder, sig, args):
        return builder.fptrunc(args[0], ir.FloatType()) if x == types.float64 else args[0]

    return types.float32(x), codegen


def load_wide(static, points, i) -> Any:
    """Coordinates of either precision as lanes of doubles."""


@overload(load_wide, jit_options={"forceinline": True})
def _load_wide(static, points, i):
    if static.value.double:
        return lambda static, points, i: load_doubles(static, points, i)
    return lambda static, points, i: widen(load_floats(static, points, i))


def wrap(static, cell, period) -> Any:
    """A cell (a double) modulo the period, if there is one."""


@overload(wrap, jit_options={"forceinline": True})
def _wrap(static, cell, period):
    if not static.value.periodic:
        return lambda static, cell, period: cell

    def wrapped(static, cell, period):
        length = splat_double(static, period)
        rest = fma(floor(cell * splat_double(static, 1.0 / period)), -length, cell)
        # the quotient may be off by one where the cell is next to a multiple of the period
        rest = select(rest < 0.0, rest + length, rest)
        return select(rest >= length, rest - length, rest)

    return wrapped


@inlined
def place_far(static, points, cells, offsets, frequency, period):
    """Cells and offsets of one axis of a tile, found in float64."""
    scale = splat_double(static, frequency)
    for i in range(0, TILE, width_of(static)):
        x = load_wide(static, points, i) * scale
        cell = floor(x)
        store(offsets, i, narrow(x - cell))
        store(cells, i, low_bits(wrap(static, cell, period) + MAGIC_DOUBLE) + EXCESS)
