"""Vectors of N floats, doubles, integers or truths as Numba types, with operators: samples side by side.

One source of each kind of noise runs at any width: 16 lanes are an AVX-512 register, 8 one of AVX2, 4 one of
NEON or SSE. At width 1 a lane is a plain LLVM ``float`` or ``i32`` and LLVM vectorises the loop by itself;
unlike Numba's own numbers these never widen to 64 bits. Integers wrap; their comparison and ``>>`` are
signed, `lanes.shift_right` is not. Python numbers mix with lanes and become constants.
"""

from __future__ import annotations

import operator
import os
import platform
from typing import Any

from llvmlite import ir
from numba.core import cgutils, types
from numba.core.datamodel import models
from numba.core.imputils import lower_builtin
from numba.core.typing.templates import AbstractTemplate, infer_global, signature
from numba.extending import intrinsic as _intrinsic
from numba.extending import register_model

# decorators whose effect type checkers do not see
intrinsic: Any = _intrinsic
operation: Any = infer_global

FLOAT, DOUBLE, INT, TRUTH = "float", "double", "int", "truth"
ELEMENTS = {FLOAT: ir.FloatType(), DOUBLE: ir.DoubleType(), INT: ir.IntType(32), TRUTH: ir.IntType(1)}
I32, I64 = ir.IntType(32), ir.IntType(64)


class Lanes(types.Type):
    """`width` elements of one sort."""

    def __init__(self, element: str, width: int):
        self.element = element
        self.width = width
        super().__init__(name=f"Lanes({element} x {width})")

    def of(self, element: str) -> Lanes:
        return Lanes(element, self.width)


def llvm_type(element: ir.Type, width: int) -> ir.Type:
    return element if width == 1 else ir.VectorType(element, width)


@register_model(Lanes)
class _Model(models.PrimitiveModel):
    def __init__(self, manager, fe_type):
        super().__init__(manager, fe_type, llvm_type(ELEMENTS[fe_type.element], fe_type.width))


# -- constants and conversions between Python numbers and lanes ---------------------------------------------


def constant(typ: Lanes, value) -> ir.Constant:
    """The same number in every lane."""
    element = ELEMENTS[typ.element]
    if typ.element == INT:
        value = ((int(value) & 0xFFFFFFFF) ^ 0x80000000) - 0x80000000
    if typ.width == 1:
        return ir.Constant(element, value)
    return ir.Constant(ir.VectorType(element, typ.width), [ir.Constant(element, value)] * typ.width)


def spread(builder, scalar, width):
    """An LLVM scalar in every lane."""
    if width == 1:
        return scalar
    vector = ir.VectorType(scalar.type, width)
    one = builder.insert_element(ir.Constant(vector, ir.Undefined), scalar, I32(0))
    return builder.shuffle_vector(
        one, ir.Constant(vector, ir.Undefined), ir.Constant(ir.VectorType(I32, width), None)
    )


def to_lanes(builder, value, source, target: Lanes):
    """A lane value or a Python number of type `source` as lanes of type `target`."""
    if isinstance(source, Lanes):
        return value
    element = ELEMENTS[target.element]
    if isinstance(source, types.Float):
        if element != value.type:
            value = (
                builder.fptrunc(value, element)
                if element == ir.FloatType()
                else builder.fpext(value, element)
            )
    elif target.element == INT:
        bits = value.type.width
        value = builder.trunc(value, I32) if bits > 32 else builder.sext(value, I32) if bits < 32 else value
    else:
        value = builder.sitofp(value, element)
    return spread(builder, value, target.width)


def lanes_of(args) -> Lanes | None:
    """The type that all operands take, or None where no lanes are among them."""
    found = [a for a in args if isinstance(a, Lanes)]
    if not found or any(a != found[0] for a in found):
        return None
    if any(not isinstance(a, (Lanes, types.Integer, types.Float)) for a in args):
        return None
    return found[0]


# -- operators ----------------------------------------------------------------------------------------------


def _define(op, floats: str | None, ints: str | None, truth: bool = False):
    """Type and lower a binary operator by the names of LLVM's instructions for floats and integers."""

    @operation(op)
    class Template(AbstractTemplate):
        def generic(self, args, kws):
            typ = lanes_of(args) if len(args) == 2 else None
            if typ is None or (ints if typ.element in (INT, TRUTH) else floats) is None:
                return None
            return signature(typ.of(TRUTH) if truth else typ, *args)

    def lower(context, builder, sig, args):
        typ = lanes_of(sig.args)
        assert typ is not None
        a, b = (to_lanes(builder, v, t, typ) for v, t in zip(args, sig.args, strict=True))
        name: Any = ints if typ.element in (INT, TRUTH) else floats
        if not truth:
            return getattr(builder, name)(a, b)
        compare = builder.icmp_signed if typ.element == INT else builder.fcmp_ordered
        return compare(name, a, b)

    for pair in ((Lanes, Lanes), (Lanes, types.Number), (types.Number, Lanes)):
        lower_builtin(op, *pair)(lower)


_define(operator.add, "fadd", "add")
_define(operator.sub, "fsub", "sub")
_define(operator.mul, "fmul", "mul")
_define(operator.truediv, "fdiv", None)
_define(operator.and_, None, "and_")
_define(operator.or_, None, "or_")
_define(operator.xor, None, "xor")
_define(operator.lshift, None, "shl")
_define(operator.rshift, None, "ashr")
for _op, _name in ((operator.lt, "<"), (operator.le, "<="), (operator.gt, ">"), (operator.ge, ">=")):
    _define(_op, _name, _name, truth=True)
_define(operator.eq, "==", "==", truth=True)


@operation(operator.neg)
class _Negative(AbstractTemplate):
    def generic(self, args, kws):
        return signature(args[0], args[0]) if isinstance(args[0], Lanes) else None


@lower_builtin(operator.neg, Lanes)
def _negative(context, builder, sig, args):
    if sig.args[0].element == INT:
        return builder.neg(args[0])
    return builder.fneg(args[0])


@operation(operator.invert)
class _Not(AbstractTemplate):
    def generic(self, args, kws):
        lanes = isinstance(args[0], Lanes) and args[0].element in (INT, TRUTH)
        return signature(args[0], args[0]) if lanes else None


@lower_builtin(operator.invert, Lanes)
def _not(context, builder, sig, args):
    return builder.not_(args[0])


# -- what the processor can do -------------------------------------------------------------------------------


def features(context) -> frozenset[str]:
    """Names of the target's instruction sets, as LLVM writes them: "avx512f", "avx2", "fma"."""
    flags = context.codegen()._tm_features
    return frozenset(flag[1:] for flag in flags.split(",") if flag.startswith("+"))


def has_fma(context) -> bool:
    """Whether a product and a sum can be one instruction, rounded once."""
    return bool(features(context) & {"fma", "avx512f"}) or platform.machine().lower() in ("aarch64", "arm64")


def host_width() -> int:
    """How many lanes suit this computer: 16, 8 or 4; `config` and its environment variables count."""
    forced = os.environ.get("FALLSTREAK_NOISE_WIDTH")
    if forced:
        if forced not in ("1", "4", "8", "16"):
            raise ValueError(f"FALLSTREAK_NOISE_WIDTH={forced!r} is not allowed: it must be 1, 4, 8 or 16")
        return int(forced)
    from numba.core.registry import cpu_target

    have = features(cpu_target.target_context)
    if {"avx512f", "avx512bw", "avx512dq"} <= have:
        return 16
    return 8 if {"avx2", "fma"} <= have else 4


def call(builder, name: str, result: ir.Type, args):
    """Call an LLVM intrinsic by its full name."""
    kind = ir.FunctionType(result, [a.type for a in args])
    return builder.call(cgutils.get_or_insert_function(builder.module, kind, name), args)


def suffix(typ: ir.Type) -> str:
    """How intrinsics overloaded on a type name it: "v16f32", "f32", "i32"."""
    if isinstance(typ, ir.VectorType):
        return f"v{typ.count}{suffix(typ.element)}"
    return {"float": "f32", "double": "f64"}.get(str(typ), str(typ))


@intrinsic
def whole_registers(typingctx):
    """Let LLVM vectorise the calling function's loops in registers of 512 bits; unasked it takes half of
    them."""

    def codegen(context, builder, sig, args):
        # llvmlite knows only attributes without a value; LLVM takes any
        set.add(builder.function.attributes, '"prefer-vector-width"="512"')
        return context.get_dummy_value()

    return signature(types.void), codegen
