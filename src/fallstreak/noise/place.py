"""From coordinates to lattice cells and the way into them.

The cell of a float32 coordinate is found by adding ``1.5 * 2^23``: the sum has no room for a fraction, so
that rounding to a whole number and turning it into an integer (the lowest bits of the sum) are one
addition. The product of coordinate and frequency is never rounded: the frequency is the sum of two floats,
and both go through fused multiplications. Beyond four million cells that does not work; such points,
periods, and float64 points, are placed in float64, where cells keep their low 32 bits up to 2^51.

The lattice of simplex noise is sheared. Cells come from sheared coordinates; the way from a cell to a point
is computed without them, and the shear back is applied to whole cells and their rest apart, so that nothing
is lost there either.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numba.core.registry import cpu_target
from numba.extending import overload

from .lanes import as_int, floor, fma, low_bits, narrow, select
from .lattice import inlined
from .memory import load_doubles, load_floats, rounded, splat, splat_double
from .sources import TILE
from .vectors import I32, Lanes, call, constant, features, intrinsic

MAGIC = 12582912.0  # 1.5 * 2^23
EXCESS = 0x4B400000  # its bits
MAGIC_DOUBLE = 6755399441055744.0  # 1.5 * 2^52
REACH = 4194304.0  # cells from the origin that float32 is good for: 2^22
REACH_SHEARED = 65536.0  # beyond, the border of a cell is missed by more than a smooth noise forgives

#: Kinds whose lattice is sheared.
SHEARED = frozenset({"simplex"})


def shear(dimensions: int) -> float:
    """The factor F of the sum of the coordinates that is added to each of them."""
    return (math.sqrt(dimensions + 1) - 1) / dimensions


def unshear(dimensions: int) -> float:
    """The factor G of the sum of the sheared coordinates that is subtracted from each of them."""
    return (1 - 1 / math.sqrt(dimensions + 1)) / dimensions


def locate(static, points, i, scale, lengths) -> Any:
    """Cells (integer lanes) and offsets (float lanes, 0..1) of the samples i... of a tile, each a tuple of
    axes.

    `points` is the tile, one axis after another; `scale` comes from `scale_of`, `lengths` from `lengths_of`.
    """


@overload(locate, jit_options={"forceinline": True})
def _locate(static, points, i, scale, lengths):
    choice = static.value
    if choice.kind in SHEARED:
        variants = _DOUBLE_SHEARED if choice.double else _FLOAT_SHEARED
    else:
        variants = _CUBIC
    return variants[choice.dimensions - 2]


def scale_of(static, frequency) -> Any:
    """The frequency in all lanes: as two floats whose sum it is, or as a double."""


@overload(scale_of, jit_options={"forceinline": True})
def _scale_of(static, frequency):
    if static.value.double:
        return lambda static, frequency: splat_double(static, frequency)

    def two_floats(static, frequency):
        high = rounded(frequency)
        return splat(static, high), splat(static, frequency - np.float64(high))

    return two_floats


@inlined
def short_scale_of(static, frequency):
    """The scale of a frequency that is a float32: there is no second float."""
    return splat(static, rounded(frequency)), None


def lengths_of(static, periods) -> Any:
    """The periods of an octave as lanes of doubles, or None for each axis."""


@overload(lengths_of, jit_options={"forceinline": True})
def _lengths_of(static, periods):
    if not static.value.periodic:
        return lambda static, periods: (None, None, None, None)
    return lambda static, periods: (
        splat_double(static, periods[0]),
        splat_double(static, periods[1]),
        splat_double(static, periods[2]),
        splat_double(static, periods[3]),
    )


# -- rounding -----------------------------------------------------------------------------------------------


@intrinsic
def _add_down(typingctx, x):
    """x + MAGIC, rounded towards minus infinity by the rounding mode that AVX-512 has in single
    instructions."""
    if not isinstance(x, Lanes):
        return None

    def codegen(context, builder, sig, args):
        magic = constant(x, MAGIC)
        return call(builder, "llvm.x86.avx512.add.ps.512", magic.type, [args[0], magic, I32(9)])

    return x(x), codegen


@intrinsic
def _multiply_add_down(typingctx, x, scale):
    """x * scale + MAGIC, rounded likewise."""
    if x != scale or not isinstance(x, Lanes):
        return None

    def codegen(context, builder, sig, args):
        magic = constant(x, MAGIC)
        return call(builder, "llvm.x86.avx512.vfmadd.ps.512", magic.type, [*args, magic, I32(9)])

    return x(x, scale), codegen


def _settle(x, scale) -> Any:
    """MAGIC + the cell of x * scale; `scale` may be None."""


@overload(_settle, jit_options={"forceinline": True})
def _overload_settle(x, scale):
    whole = not isinstance(scale, Lanes)
    if x.width == 16 and "avx512f" in features(cpu_target.target_context):
        if whole:
            return lambda x, scale: _add_down(x)
        return lambda x, scale: _multiply_add_down(x, scale)
    # to the nearest, from half a cell lower: at a whole number the offset may be 1 in the cell below
    # instead of 0
    if whole:
        return lambda x, scale: (x - 0.5) + MAGIC
    return lambda x, scale: fma(x, scale, -0.5) + MAGIC


# -- cubic lattices -----------------------------------------------------------------------------------------


def _axis(static, points, i, scale, period) -> Any:
    """Cell and offset along one axis."""


@overload(_axis, jit_options={"forceinline": True})
def _overload_axis(static, points, i, scale, period):
    if not static.value.double:

        def near(static, points, i, scale, period):
            x = load_floats(static, points, i)
            settled = _settle(x, scale[0])
            return as_int(settled) - EXCESS, fma(x, scale[1], fma(x, scale[0], MAGIC - settled))

        return near

    def far(static, points, i, scale, period):
        x = load_doubles(static, points, i) * scale
        cell = floor(x)
        return low_bits(wrap(cell, period) + MAGIC_DOUBLE), narrow(x - cell)

    return far


def wrap(cell, period) -> Any:
    """A cell (in doubles) modulo the period, unless that is None."""


@overload(wrap, jit_options={"forceinline": True})
def _wrap(cell, period):
    if not isinstance(period, Lanes):
        return lambda cell, period: cell

    def wrapped(cell, period):
        rest = fma(floor(cell / period), -period, cell)
        # the quotient may be off by one where the cell is next to a multiple of the period
        rest = select(rest < 0.0, rest + period, rest)
        return select(rest >= period, rest - period, rest)

    return wrapped


def _cubic2(static, points, i, scale, lengths):
    cx, x = _axis(static, points, i, scale, lengths[0])
    cy, y = _axis(static, points, i + TILE, scale, lengths[1])
    return (cx, cy), (x, y)


def _cubic3(static, points, i, scale, lengths):
    cx, x = _axis(static, points, i, scale, lengths[0])
    cy, y = _axis(static, points, i + TILE, scale, lengths[1])
    cz, z = _axis(static, points, i + 2 * TILE, scale, lengths[2])
    return (cx, cy, cz), (x, y, z)


def _cubic4(static, points, i, scale, lengths):
    cx, x = _axis(static, points, i, scale, lengths[0])
    cy, y = _axis(static, points, i + TILE, scale, lengths[1])
    cz, z = _axis(static, points, i + 2 * TILE, scale, lengths[2])
    cw, w = _axis(static, points, i + 3 * TILE, scale, lengths[3])
    return (cx, cy, cz, cw), (x, y, z, w)


_CUBIC = (_cubic2, _cubic3, _cubic4)


# -- sheared lattices: cells, and offsets already sheared back
# ------------------------------------------------

_D2, _D3, _D4 = (shear(d) for d in (2, 3, 4))
_G2, _G3, _G4 = (unshear(d) for d in (2, 3, 4))
_H2, _H3, _H4 = (g - float(np.float32(g)) for g in (_G2, _G3, _G4))


def _from_cell(x, scale, cell, whole, rest) -> Any:
    """The way from a cell to a point along an axis: x * scale - cell + whole + rest; only `rest` is no
    integer."""


@overload(_from_cell, jit_options={"forceinline": True})
def _overload_from_cell(x, scale, cell, whole, rest):
    if isinstance(scale[1], Lanes):
        return lambda x, scale, cell, whole, rest: fma(x, scale[0], whole - cell) + fma(x, scale[1], rest)
    return lambda x, scale, cell, whole, rest: fma(x, scale[0], whole - cell) + rest


@inlined
def _unsheared(cells, factor, lost):
    """The sum of the cells times G, as a whole number and a remainder: so nothing is lost when both are
    large."""
    whole = fma(cells, factor, MAGIC) - MAGIC
    return whole, fma(cells, lost, fma(cells, factor, -whole))


def _float_sheared2(static, points, i, scale, lengths):
    x, y = load_floats(static, points, i), load_floats(static, points, i + TILE)
    shift = (x + y) * (scale[0] * _D2)
    a, b = _settle(fma(x, scale[0], shift), None), _settle(fma(y, scale[0], shift), None)
    cx, cy = a - MAGIC, b - MAGIC
    whole, rest = _unsheared(cx + cy, _G2, _H2)
    ways = _from_cell(x, scale, cx, whole, rest), _from_cell(y, scale, cy, whole, rest)
    return (as_int(a) - EXCESS, as_int(b) - EXCESS), ways


def _float_sheared3(static, points, i, scale, lengths):
    x, y = load_floats(static, points, i), load_floats(static, points, i + TILE)
    z = load_floats(static, points, i + 2 * TILE)
    shift = (x + y + z) * (scale[0] * _D3)
    a, b = _settle(fma(x, scale[0], shift), None), _settle(fma(y, scale[0], shift), None)
    c = _settle(fma(z, scale[0], shift), None)
    cx, cy, cz = a - MAGIC, b - MAGIC, c - MAGIC
    whole, rest = _unsheared(cx + cy + cz, _G3, _H3)
    ways = (
        _from_cell(x, scale, cx, whole, rest),
        _from_cell(y, scale, cy, whole, rest),
        _from_cell(z, scale, cz, whole, rest),
    )
    return (as_int(a) - EXCESS, as_int(b) - EXCESS, as_int(c) - EXCESS), ways


def _float_sheared4(static, points, i, scale, lengths):
    x, y = load_floats(static, points, i), load_floats(static, points, i + TILE)
    z, w = load_floats(static, points, i + 2 * TILE), load_floats(static, points, i + 3 * TILE)
    shift = ((x + y) + (z + w)) * (scale[0] * _D4)
    a, b = _settle(fma(x, scale[0], shift), None), _settle(fma(y, scale[0], shift), None)
    c, d = _settle(fma(z, scale[0], shift), None), _settle(fma(w, scale[0], shift), None)
    cx, cy, cz, cw = a - MAGIC, b - MAGIC, c - MAGIC, d - MAGIC
    whole, rest = _unsheared((cx + cy) + (cz + cw), _G4, _H4)
    ways = (
        _from_cell(x, scale, cx, whole, rest),
        _from_cell(y, scale, cy, whole, rest),
        _from_cell(z, scale, cz, whole, rest),
        _from_cell(w, scale, cw, whole, rest),
    )
    return (as_int(a) - EXCESS, as_int(b) - EXCESS, as_int(c) - EXCESS, as_int(d) - EXCESS), ways


_FLOAT_SHEARED = (_float_sheared2, _float_sheared3, _float_sheared4)


@inlined
def _bits(cell):
    return low_bits(cell + MAGIC_DOUBLE)


def _double_sheared2(static, points, i, scale, lengths):
    x, y = load_doubles(static, points, i) * scale, load_doubles(static, points, i + TILE) * scale
    shift = (x + y) * _D2
    cx, cy = floor(x + shift), floor(y + shift)
    back = (cx + cy) * _G2
    return (_bits(cx), _bits(cy)), (narrow(x - cx + back), narrow(y - cy + back))


def _double_sheared3(static, points, i, scale, lengths):
    x, y = load_doubles(static, points, i) * scale, load_doubles(static, points, i + TILE) * scale
    z = load_doubles(static, points, i + 2 * TILE) * scale
    shift = (x + y + z) * _D3
    cx, cy, cz = floor(x + shift), floor(y + shift), floor(z + shift)
    back = (cx + cy + cz) * _G3
    ways = narrow(x - cx + back), narrow(y - cy + back), narrow(z - cz + back)
    return (_bits(cx), _bits(cy), _bits(cz)), ways


def _double_sheared4(static, points, i, scale, lengths):
    x, y = load_doubles(static, points, i) * scale, load_doubles(static, points, i + TILE) * scale
    z, w = (
        load_doubles(static, points, i + 2 * TILE) * scale,
        load_doubles(static, points, i + 3 * TILE) * scale,
    )
    shift = ((x + y) + (z + w)) * _D4
    cx, cy, cz, cw = floor(x + shift), floor(y + shift), floor(z + shift), floor(w + shift)
    back = ((cx + cy) + (cz + cw)) * _G4
    ways = narrow(x - cx + back), narrow(y - cy + back), narrow(z - cz + back), narrow(w - cw + back)
    return (_bits(cx), _bits(cy), _bits(cz), _bits(cw)), ways


_DOUBLE_SHEARED = (_double_sheared2, _double_sheared3, _double_sheared4)
