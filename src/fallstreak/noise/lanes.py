"""Samples side by side: vectors of N floats, doubles, integers or truths as Numba types, with operators.

One source of each kind of noise runs at any width: 16 lanes are an AVX-512 register, 8 one of AVX2, 4 one
of NEON or SSE. At width 1 a lane is a plain LLVM ``float`` or ``i32`` and LLVM vectorises the loop by
itself; unlike Numba's own numbers these never widen to 64 bits. Integers wrap; their comparison and ``>>``
are signed, `shift_right` is not.

Python numbers mix with lanes and become constants. All functions here exist only inside compiled code.
"""

from __future__ import annotations

import operator
from typing import Any

from llvmlite import ir
from numba.core import cgutils, types
from numba.core.datamodel import models
from numba.core.imputils import lower_builtin
from numba.core.typing.templates import AbstractTemplate, infer_global, signature
from numba.extending import intrinsic as _intrinsic
from numba.extending import overload, register_model

from .static import StaticType

# decorators whose effect type checkers do not see
intrinsic: Any = _intrinsic
operation: Any = infer_global

FLOAT, DOUBLE, INT, TRUTH = "float", "double", "int", "truth"
_ELEMENT = {FLOAT: ir.FloatType(), DOUBLE: ir.DoubleType(), INT: ir.IntType(32), TRUTH: ir.IntType(1)}
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
        super().__init__(manager, fe_type, llvm_type(_ELEMENT[fe_type.element], fe_type.width))


# -- constants and conversions between Python numbers and lanes ---------------------------------------------


def constant(typ: Lanes, value) -> ir.Constant:
    """The same number in every lane."""
    element = _ELEMENT[typ.element]
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


def _to_lanes(builder, value, source, target: Lanes):
    """A lane value or a Python number of type `source` as lanes of type `target`."""
    if isinstance(source, Lanes):
        return value
    element = _ELEMENT[target.element]
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


def _lanes_of(args) -> Lanes | None:
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
            typ = _lanes_of(args) if len(args) == 2 else None
            if typ is None or (ints if typ.element in (INT, TRUTH) else floats) is None:
                return None
            return signature(typ.of(TRUTH) if truth else typ, *args)

    def lower(context, builder, sig, args):
        typ = _lanes_of(sig.args)
        assert typ is not None
        a, b = (_to_lanes(builder, v, t, typ) for v, t in zip(args, sig.args, strict=True))
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


def host_width() -> int:
    """How many lanes suit this computer: 16, 8 or 4; `config` and its environment variables count."""
    import os

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


# -- floats --------------------------------------------------------------------------------------------------


@intrinsic
def fma(typingctx, a, b, c):
    """a * b + c, rounded once where the processor can; at least one must be lanes."""
    typ = _lanes_of((a, b, c))
    if typ is None:
        return None

    def codegen(context, builder, sig, args):
        a, b, c = (_to_lanes(builder, v, t, typ) for v, t in zip(args, sig.args, strict=True))
        if _has_fma(context):
            return call(builder, f"llvm.fma.{suffix(a.type)}", a.type, [a, b, c])
        return builder.fadd(builder.fmul(a, b), c)

    return signature(typ, a, b, c), codegen


def _has_fma(context) -> bool:
    have = features(context)
    return bool(have & {"fma", "avx512f", "neon"}) or "aarch64" in str(context.codegen()._data_layout)


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
        typ = _lanes_of((a, b))
        if typ is None:
            return None

        def codegen(context, builder, sig, args):
            a, b = (_to_lanes(builder, v, t, typ) for v, t in zip(args, sig.args, strict=True))
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
    typ = mask.of(FLOAT) if numbers else _lanes_of((a, b))
    if typ is None:
        return None

    def codegen(context, builder, sig, args):
        a, b = (_to_lanes(builder, v, t, typ) for v, t in zip(args[1:], sig.args[1:], strict=True))
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
        return builder.lshr(args[0], _to_lanes(builder, args[1], sig.args[1], a))

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


# -- memory
# ---------------------------------------------------------------------------------------------------


@intrinsic(prefer_literal=True)
def scratch(typingctx, nbytes):
    """So many bytes of the stack (a literal number), aligned to a cache line: the buffers of a tile."""
    if not isinstance(nbytes, types.IntegerLiteral):
        return None
    count = nbytes.literal_value

    def codegen(context, builder, sig, args):
        with builder.goto_entry_block():
            memory = builder.alloca(ir.ArrayType(ir.IntType(8), count))
            memory.align = 64
        return builder.bitcast(memory, ir.IntType(8).as_pointer())

    return signature(types.voidptr, nbytes), codegen


@intrinsic
def call_address(typingctx, address, pointer, source, first, count):
    """Call the compiled function ``(pointer, source, first, count)`` at an address."""

    def codegen(context, builder, sig, args):
        byte = ir.IntType(8).as_pointer()
        kind = ir.FunctionType(ir.VoidType(), [byte, I64, I64, I64])
        builder.call(builder.inttoptr(args[0], kind.as_pointer()), args[1:])
        return context.get_dummy_value()

    return signature(types.void, types.int64, types.voidptr, types.int64, types.int64, types.int64), codegen


def width_of(static) -> Any:
    """The width of the lanes, known to the compiler."""


@overload(width_of, jit_options={"forceinline": True})
def _width_of(static):
    width = static.value.width
    return lambda static: width


@intrinsic
def shifted(typingctx, pointer, nbytes):
    """A pointer so many bytes further."""

    def codegen(context, builder, sig, args):
        return builder.gep(args[0], [args[1]], inbounds=True)

    return signature(types.voidptr, types.voidptr, types.intp), codegen


def _place(builder, pointer, index, element):
    typed = builder.bitcast(pointer, element.as_pointer())
    return builder.gep(typed, [index], inbounds=True)


def _loader(element: str, name: str, doc: str):
    def typing(typingctx, static, pointer, index):
        if not isinstance(static, StaticType):
            return None
        typ = Lanes(element, static.value.width)

        def codegen(context, builder, sig, args):
            place = _place(builder, args[1], args[2], _ELEMENT[element])
            vector = llvm_type(_ELEMENT[element], typ.width)
            place = builder.bitcast(place, vector.as_pointer())
            return builder.load(place, align=4, typ=vector)

        return signature(typ, static, types.voidptr, types.intp), codegen

    typing.__name__ = typing.__qualname__ = name
    typing.__doc__ = doc
    return intrinsic(typing)


load_floats = _loader(FLOAT, "load_floats", "Lanes from the floats at pointer[index…].")
load_doubles = _loader(DOUBLE, "load_doubles", "Lanes from the doubles at pointer[index…].")
load_ints = _loader(INT, "load_ints", "Lanes from the 32-bit integers at pointer[index…].")


@intrinsic
def store(typingctx, pointer, index, value):
    """Write lanes to pointer[index…], counted in elements."""
    if not isinstance(value, Lanes):
        return None

    def codegen(context, builder, sig, args):
        place = _place(builder, args[0], args[1], _ELEMENT[value.element])
        place = builder.bitcast(place, args[2].type.as_pointer())
        builder.store(args[2], place, align=4)
        return context.get_dummy_value()

    return signature(types.void, types.voidptr, types.intp, value), codegen


@intrinsic
def splat(typingctx, static, value):
    """A number in every lane: a float from a Python float, an integer from an integer."""
    if not isinstance(static, StaticType) or not isinstance(value, (types.Float, types.Integer)):
        return None
    typ = Lanes(FLOAT if isinstance(value, types.Float) else INT, static.value.width)

    def codegen(context, builder, sig, args):
        return _to_lanes(builder, args[1], value, typ)

    return signature(typ, static, value), codegen


@intrinsic
def splat_double(typingctx, static, value):
    """A number in every lane of doubles."""
    if not isinstance(static, StaticType) or not isinstance(value, types.Float):
        return None
    typ = Lanes(DOUBLE, static.value.width)

    def codegen(context, builder, sig, args):
        return _to_lanes(builder, args[1], value, typ)

    return signature(typ, static, value), codegen


@intrinsic
def largest_float(typingctx, a):
    """The largest of integer lanes, its bits read as one float of Numba."""
    if not isinstance(a, Lanes) or a.element != INT:
        return None

    def codegen(context, builder, sig, args):
        top = args[0]
        if a.width > 1:
            top = call(builder, f"llvm.vector.reduce.smax.{suffix(top.type)}", I32, [top])
        return builder.bitcast(top, ir.FloatType())

    return signature(types.float32, a), codegen


@intrinsic
def rounded(typingctx, x):
    """A Python float rounded to float32, and of that type."""
    if x != types.float64:
        return None

    def codegen(context, builder, sig, args):
        return builder.fptrunc(args[0], ir.FloatType())

    return signature(types.float32, x), codegen


# -- raw arrays of the caller ------------------------------------------------------------------------------


def _raw(element: str, numba_type, name: str):
    llvm = _ELEMENT[element]

    def reader(typingctx, address, offset):
        def codegen(context, builder, sig, args):
            pointer = builder.inttoptr(builder.add(*args), llvm.as_pointer())
            return builder.load(pointer, align=1, typ=llvm)

        return signature(numba_type, types.int64, types.int64), codegen

    reader.__name__ = reader.__qualname__ = name
    reader.__doc__ = f"The {element} at an address plus an offset in bytes."
    return intrinsic(reader)


read_float = _raw(FLOAT, types.float32, "read_float")
read_double = _raw(DOUBLE, types.float64, "read_double")


@intrinsic
def pointer_at(typingctx, address):
    """An address, as a pointer."""

    def codegen(context, builder, sig, args):
        return builder.inttoptr(args[0], ir.IntType(8).as_pointer())

    return signature(types.voidptr, types.int64), codegen


@intrinsic
def put_float(typingctx, address, offset, value):
    """Write a float at an address plus an offset in bytes."""

    def codegen(context, builder, sig, args):
        pointer = builder.inttoptr(builder.add(args[0], args[1]), ir.FloatType().as_pointer())
        builder.store(args[2], pointer, align=1)
        return context.get_dummy_value()

    return signature(types.void, types.int64, types.int64, types.float32), codegen


@intrinsic
def get_float(typingctx, pointer, index):
    """The float at pointer[index]."""

    def codegen(context, builder, sig, args):
        return builder.load(_place(builder, args[0], args[1], ir.FloatType()), typ=ir.FloatType())

    return signature(types.float32, types.voidptr, types.intp), codegen


@intrinsic
def put(typingctx, pointer, index, value):
    """Write one float or double of Numba to pointer[index]."""
    if value not in (types.float32, types.float64):
        return None
    element = ir.FloatType() if value == types.float32 else ir.DoubleType()

    def codegen(context, builder, sig, args):
        builder.store(args[2], _place(builder, args[0], args[1], element))
        return context.get_dummy_value()

    return signature(types.void, types.voidptr, types.intp, value), codegen
