"""Lanes and memory: buffers on the stack, loads, stores, numbers in all lanes, arrays of the caller."""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba.core import types
from numba.core.typing.templates import signature
from numba.extending import overload

from .static import StaticType
from .vectors import (
    DOUBLE,
    ELEMENTS,
    FLOAT,
    I32,
    I64,
    INT,
    Lanes,
    call,
    intrinsic,
    llvm_type,
    suffix,
    to_lanes,
)


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
            place = _place(builder, args[1], args[2], ELEMENTS[element])
            vector = llvm_type(ELEMENTS[element], typ.width)
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
        place = _place(builder, args[0], args[1], ELEMENTS[value.element])
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
        return to_lanes(builder, args[1], value, typ)

    return signature(typ, static, value), codegen


@intrinsic
def splat_double(typingctx, static, value):
    """A number in every lane of doubles."""
    if not isinstance(static, StaticType) or not isinstance(value, types.Float):
        return None
    typ = Lanes(DOUBLE, static.value.width)

    def codegen(context, builder, sig, args):
        return to_lanes(builder, args[1], value, typ)

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
