"""How lanes look up the gradients of `directions.py`.

Lanes take a component from a table with a permute where the processor has one of 16 entries (AVX-512), with
a shuffle of bytes on AVX2, and else by shifting a constant that holds two bits per entry. The last two can
only give ±2 and 0, because these floats have nothing but their top byte; `unscale` sets that right at the
end.
"""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba.core.registry import cpu_target
from numba.extending import overload

from .directions import EDGES3, EDGES4, GRADIENTS2, LONG, SHORT
from .lanes import as_float, select
from .static import StaticType, Table
from .vectors import FLOAT, I32, INT, Lanes, call, constant, features, intrinsic

X2, Y2 = (Table(tuple(g[axis] for g in GRADIENTS2)) for axis in range(2))
X3, Y3, Z3 = (Table(tuple(float(g[axis]) for g in EDGES3)) for axis in range(3))
X4, Y4, Z4, W4 = (Table(tuple(float(g[axis]) for g in EDGES4)) for axis in range(4))


def way(width: int) -> str:
    """How lanes of this width look up on this processor: "permute", "shuffle" or "shift"."""
    have = features(cpu_target.target_context)
    if (width == 16 and "avx512f" in have) or (width == 8 and "avx512vl" in have):
        return "permute"
    return "shuffle" if width == 8 and "avx2" in have else "shift"


@intrinsic
def lookup(typingctx, table, index):
    """A table's entry by permute; the index counts modulo the number of entries (8, 16 or 32)."""
    if not isinstance(table, StaticType) or not isinstance(index, Lanes) or index.element != INT:
        return None
    width, values = index.width, table.value.values

    def codegen(context, builder, sig, args):
        vector = ir.VectorType(ir.FloatType(), width)
        whole = values * max(1, width // len(values))
        parts = [ir.Constant(vector, list(whole[i : i + width])) for i in range(0, len(whole), width)]
        if len(parts) == 1 and width == 16:
            return call(builder, "llvm.x86.avx512.permvar.sf.512", vector, [parts[0], args[1]])
        if len(parts) == 1:
            return call(builder, "llvm.x86.avx2.permps", vector, [parts[0], args[1]])
        name = f"llvm.x86.avx512.vpermi2var.ps.{32 * width}"
        pairs = [
            call(builder, name, vector, [a, args[1], b]) for a, b in zip(parts[::2], parts[1::2], strict=True)
        ]
        if len(pairs) == 1:
            return pairs[0]
        high = builder.icmp_signed("<", builder.shl(args[1], constant(index, 27)), constant(index, 0))
        return builder.select(high, pairs[1], pairs[0])

    return sig_float(index, table), codegen


def sig_float(index: Lanes, table):
    return index.of(FLOAT)(table, index)


@intrinsic
def double_unit(typingctx, table, index):
    """Twice an entry of a table of -1, 0 and 1; of 32 entries the second half must negate the first."""
    if not isinstance(table, StaticType) or not isinstance(index, Lanes) or index.element != INT:
        return None
    values = table.value.values

    def codegen(context, builder, sig, args):
        if way(index.width) == "shuffle":
            bits = _shuffled(builder, index, values[:16], args[1])
        else:
            codes = sum({0: 0, 1: 1, -1: 3}[int(v)] << (30 - 2 * i) for i, v in enumerate(values[:16]))
            twice = builder.and_(builder.shl(args[1], constant(index, 1)), constant(index, 30))
            bits = builder.and_(builder.shl(constant(index, codes), twice), constant(index, 0xC0000000))
        if len(values) == 32:
            sign = builder.and_(builder.shl(args[1], constant(index, 27)), constant(index, 0x80000000))
            bits = builder.xor(bits, sign)
        return builder.bitcast(
            bits, ir.FloatType() if index.width == 1 else ir.VectorType(ir.FloatType(), index.width)
        )

    return sig_float(index, table), codegen


def _shuffled(builder, index, values, lanes):
    """One vpshufb: the index in the top byte picks the float's top byte, the other bytes are told to be 0."""
    top = builder.and_(builder.shl(lanes, constant(index, 24)), constant(index, 0x0F000000))
    top = builder.or_(top, constant(index, 0x00808080))
    byte, count = ir.IntType(8), 4 * index.width
    entries = [{0: 0, 1: 0x40, -1: 0xC0 - 256}[int(v)] for v in values]
    vector = ir.VectorType(byte, count)
    table = ir.Constant(vector, [ir.Constant(byte, e) for e in entries * (count // 16)])
    shuffled = call(builder, "llvm.x86.avx2.pshuf.b", vector, [table, builder.bitcast(top, vector)])
    return builder.bitcast(shuffled, ir.VectorType(I32, index.width))


def gradient2(index) -> Any:
    """(x, y) of the gradient that the low 3 bits of the index name."""


@overload(gradient2, jit_options={"forceinline": True})
def _gradient2(index):
    if way(index.width) != "shift":
        return lambda index: (lookup(X2, index), lookup(Y2, index))
    sign = -0x80000000

    def arithmetic(index):
        swapped = (index << 29) < 0
        x = select(swapped, _short(index), _long(index))
        y = select(swapped, _long(index), _short(index))
        return as_float(x ^ ((index << 31) & sign)), as_float(y ^ ((index << 30) & sign))

    return arithmetic


def _float_bits(name: str, value: float):
    import struct

    pattern = struct.unpack("<i", struct.pack("<f", value))[0]

    def typing(typingctx, like):
        def codegen(context, builder, sig, args):
            return constant(like, pattern)

        return like(like), codegen

    typing.__name__ = typing.__qualname__ = name
    return intrinsic(typing)


_long, _short = _float_bits("_long", LONG), _float_bits("_short", SHORT)


def gradient3(index) -> Any:
    """(x, y, z) of the gradient that the low 4 bits of the index name, to be set right by `unscale`."""


@overload(gradient3, jit_options={"forceinline": True})
def _gradient3(index):
    if way(index.width) == "permute":
        return lambda index: (lookup(X3, index), lookup(Y3, index), lookup(Z3, index))
    return lambda index: (double_unit(X3, index), double_unit(Y3, index), double_unit(Z3, index))


def gradient4(index) -> Any:
    """(x, y, z, w) of the edge that the low 5 bits of the index name, to be set right by `unscale` and
    FOUR_SCALE."""


@overload(gradient4, jit_options={"forceinline": True})
def _gradient4(index):
    if way(index.width) == "permute":
        return lambda index: (lookup(X4, index), lookup(Y4, index), lookup(Z4, index), lookup(W4, index))
    return lambda index: (
        double_unit(X4, index),
        double_unit(Y4, index),
        double_unit(Z4, index),
        double_unit(W4, index),
    )


def unscale(value) -> Any:
    """What was summed from `gradient3` or `gradient4`, in its true size."""


@overload(unscale, jit_options={"forceinline": True})
def _unscale(value):
    if way(value.width) == "permute":
        return lambda value: value
    return lambda value: value * 0.5
