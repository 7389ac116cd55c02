"""Arithmetic on lanes beyond the operators of `vectors.py`. It exists only inside compiled code."""

from __future__ import annotations

from llvmlite import ir
from numba.core import types
from numba.core.typing.templates import signature

from .vectors import (
    DOUBLE,
    FLOAT,
    I32,
    I64,
    INT,
    TRUTH,
    Lanes,
    call,
    constant,
    has_fma,
    intrinsic,
    lanes_of,
    llvm_type,
    suffix,
    to_lanes,
)

# -- floats --------------------------------------------------------------------------------------------------


@intrinsic
def fma(typingctx, a, b, c):
    """a * b + c, rounded once where the processor can; at least one must be lanes."""
    typ = lanes_of((a, b, c))
    if typ is None:
        return None

    def codegen(context, builder, sig, args):
        a, b, c = (to_lanes(builder, v, t, typ) for v, t in zip(args, sig.args, strict=True))
        if has_fma(context):
            return call(builder, f"llvm.fma.{suffix(a.type)}", a.type, [a, b, c])
        return builder.fadd(builder.fmul(a, b), c)

    return signature(typ, a, b, c), codegen


def _unary(name: str, doc: str):
    def typing(typingctx, x):
        if not isinstance(x, Lanes) or x.element not in (FLOAT, DOUBLE):
            return None

        def codegen(context, builder, sig, args):
            return call(builder, f"llvm.{name}.{suffix(args[0].type)}", args[0].type, [args[0]])

        return signature(x, x), codegen

    typing.__name__ = typing.__qualname__ = name
    typing.__doc__ = doc
    return intrinsic(typing)


floor = _unary("floor", "The next integer below, as a float.")
absolute = _unary("fabs", "The absolute value.")
root = _unary("sqrt", "The square root.")


def _extremum(name: str, doc: str, order: str):
    def typing(typingctx, a, b):
        typ = lanes_of((a, b))
        if typ is None:
            return None

        def codegen(context, builder, sig, args):
            a, b = (to_lanes(builder, v, t, typ) for v, t in zip(args, sig.args, strict=True))
            # written as compare and select: one minps, while llvm.minnum adds a test for NaN
            pick = (builder.icmp_signed if typ.element == INT else builder.fcmp_ordered)(order, a, b)
            return builder.select(pick, a, b)

        return signature(typ, a, b), codegen

    typing.__name__ = typing.__qualname__ = name
    typing.__doc__ = doc
    return intrinsic(typing)


smaller = _extremum("smaller", "The smaller of two, lane by lane.", "<")
larger = _extremum("larger", "The larger of two, lane by lane.", ">")


@intrinsic
def select(typingctx, mask, a, b):
    """a where the truth holds, else b; two Python numbers become float lanes."""
    if not isinstance(mask, Lanes) or mask.element != TRUTH:
        return None
    numbers = isinstance(a, types.Float) and isinstance(b, types.Float)
    typ = mask.of(FLOAT) if numbers else lanes_of((a, b))
    if typ is None:
        return None

    def codegen(context, builder, sig, args):
        a, b = (to_lanes(builder, v, t, typ) for v, t in zip(args[1:], sig.args[1:], strict=True))
        return builder.select(args[0], a, b)

    return signature(typ, mask, a, b), codegen


# -- integers
# -------------------------------------------------------------------------------------------------


@intrinsic
def shift_right(typingctx, a, n):
    """Logical shift: zeros come in from the left."""
    if not isinstance(a, Lanes) or a.element != INT:
        return None

    def codegen(context, builder, sig, args):
        return builder.lshr(args[0], to_lanes(builder, args[1], sig.args[1], a))

    return signature(a, a, n), codegen


def _halves(builder, value):
    """A vector of N integers as one of 2 N halves."""
    return builder.bitcast(value, ir.VectorType(ir.IntType(16), 2 * value.type.count))


@intrinsic
def multiply16(typingctx, a, b):
    """The product of the low 16 bits in the low 16 bits; what stands above is of no use."""
    if not isinstance(a, Lanes) or a != b or a.element != INT:
        return None

    def codegen(context, builder, sig, args):
        if a.width == 1:
            return builder.mul(*args)
        return builder.bitcast(builder.mul(*(_halves(builder, v) for v in args)), args[0].type)

    return signature(a, a, b), codegen


@intrinsic
def multiply16_high(typingctx, a, b):
    """The upper half of the 32-bit product of the low 16 bits, in the low 16 bits; above is of no use."""
    if not isinstance(a, Lanes) or a != b or a.element != INT:
        return None

    def codegen(context, builder, sig, args):
        if a.width == 1:
            x, y = (builder.and_(v, I32(0xFFFF)) for v in args)
            return builder.lshr(builder.mul(x, y), I32(16))
        wide = ir.VectorType(I32, 2 * a.width)
        x, y = (builder.zext(_halves(builder, v), wide) for v in args)
        high = builder.lshr(builder.mul(x, y), constant(Lanes(INT, 2 * a.width), 16))
        return builder.bitcast(builder.trunc(high, ir.VectorType(ir.IntType(16), 2 * a.width)), args[0].type)

    return signature(a, a, b), codegen


@intrinsic
def to_float(typingctx, a):
    """Signed integers as floats."""
    if not isinstance(a, Lanes) or a.element != INT:
        return None

    def codegen(context, builder, sig, args):
        return builder.sitofp(args[0], llvm_type(ir.FloatType(), a.width))

    return signature(a.of(FLOAT), a), codegen


@intrinsic
def to_int(typingctx, a):
    """Floats cut to integers."""
    if not isinstance(a, Lanes) or a.element != FLOAT:
        return None

    def codegen(context, builder, sig, args):
        # freeze: LLVM calls what is out of range poison, and poison may not reach a store
        return builder.fptosi(args[0], llvm_type(I32, a.width))

    return signature(a.of(INT), a), codegen


@intrinsic
def as_float(typingctx, a):
    """The bits of integers read as floats."""
    if not isinstance(a, Lanes) or a.element != INT:
        return None

    def codegen(context, builder, sig, args):
        return builder.bitcast(args[0], llvm_type(ir.FloatType(), a.width))

    return signature(a.of(FLOAT), a), codegen


@intrinsic
def as_int(typingctx, a):
    """The bits of floats read as integers."""
    if not isinstance(a, Lanes) or a.element != FLOAT:
        return None

    def codegen(context, builder, sig, args):
        return builder.bitcast(args[0], llvm_type(I32, a.width))

    return signature(a.of(INT), a), codegen


@intrinsic
def narrow(typingctx, a):
    """Doubles rounded to floats."""
    if not isinstance(a, Lanes) or a.element != DOUBLE:
        return None

    def codegen(context, builder, sig, args):
        return builder.fptrunc(args[0], llvm_type(ir.FloatType(), a.width))

    return signature(a.of(FLOAT), a), codegen


@intrinsic
def widen(typingctx, a):
    """Floats as doubles."""
    if not isinstance(a, Lanes) or a.element != FLOAT:
        return None

    def codegen(context, builder, sig, args):
        return builder.fpext(args[0], llvm_type(ir.DoubleType(), a.width))

    return signature(a.of(DOUBLE), a), codegen


@intrinsic
def low_bits(typingctx, a):
    """The low 32 bits of doubles."""
    if not isinstance(a, Lanes) or a.element != DOUBLE:
        return None

    def codegen(context, builder, sig, args):
        return builder.trunc(builder.bitcast(args[0], llvm_type(I64, a.width)), llvm_type(I32, a.width))

    return signature(a.of(INT), a), codegen
