"""Where the points of a tile come from: arrays, a regular grid, the faces of a cube.

Each is a compiled function ``fill(points, source, first, count)`` that writes the coordinates of `count`
points (at most a tile), counted from `first`, one axis after another; beyond them it writes zeros. `source`
is the address of what it needs to know. `loops.py` calls it by its address, so that points are made tile by
tile in the first-level cache and never stand in memory.

This file uses nothing compiled from the others: then Numba's own check of the file's date keeps the cache
right.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from llvmlite import ir
from numba.core import sigutils, types
from numba.core.ccallback import CFunc
from numba.extending import intrinsic as _intrinsic

from .machine_code import keyed

TILE = 256

intrinsic: Any = _intrinsic


def _llvm(typ):
    return {types.float32: ir.FloatType(), types.float64: ir.DoubleType(), types.int64: ir.IntType(64)}[typ]


def _reader(typ, name):
    def read(typingctx, address):
        def codegen(context, builder, sig, args):
            pointer = builder.inttoptr(args[0], _llvm(typ).as_pointer())
            return builder.load(pointer, align=1, typ=_llvm(typ))

        return typ(types.int64), codegen

    read.__name__ = read.__qualname__ = name
    return intrinsic(read)


_float_at, _double_at = _reader(types.float32, "_float_at"), _reader(types.float64, "_double_at")
_int_at = _reader(types.int64, "_int_at")


@intrinsic
def _put(typingctx, pointer, index, value):
    """Write a float or double to pointer[index]."""

    def codegen(context, builder, sig, args):
        typed = builder.bitcast(args[0], _llvm(value).as_pointer())
        builder.store(args[2], builder.gep(typed, [args[1]], inbounds=True))
        return context.get_dummy_value()

    return types.void(types.voidptr, types.intp, value), codegen


# -- arrays: source = the number of axes, then address and stride of each
# --------------------------------------


def _floats(points, source, first, count):
    for axis in range(_int_at(source)):
        address, stride = _int_at(source + 8 + 16 * axis), _int_at(source + 16 + 16 * axis)
        start = address + first * stride
        if stride == 4:  # said in so many words, the loop becomes one of whole registers
            for i in range(count):
                _put(points, axis * TILE + i, _float_at(start + 4 * i))
        else:
            for i in range(count):
                _put(points, axis * TILE + i, _float_at(start + stride * i))
        for i in range(count, TILE):
            _put(points, axis * TILE + i, np.float32(0.0))


def _floats_as_doubles(points, source, first, count):
    for axis in range(_int_at(source)):
        address, stride = _int_at(source + 8 + 16 * axis), _int_at(source + 16 + 16 * axis)
        start = address + first * stride
        for i in range(count):
            _put(points, axis * TILE + i, np.float64(_float_at(start + stride * i)))
        for i in range(count, TILE):
            _put(points, axis * TILE + i, 0.0)


def _doubles(points, source, first, count):
    for axis in range(_int_at(source)):
        address, stride = _int_at(source + 8 + 16 * axis), _int_at(source + 16 + 16 * axis)
        start = address + first * stride
        for i in range(count):
            _put(points, axis * TILE + i, _double_at(start + stride * i))
        for i in range(count, TILE):
            _put(points, axis * TILE + i, 0.0)


# -- a grid: source = the number of axes, then for each, x first, its size and the address of its
# coordinates ----


def _grid_of_floats(points, source, first, count):
    inner = 1  # how many points have the same coordinate in a row
    for axis in range(_int_at(source)):
        size, table = _int_at(source + 8 + 16 * axis), _int_at(source + 16 + 16 * axis)
        place, at, i = axis * TILE, first // inner % size, 0
        if axis == 0:
            while i < count:
                run = min(size - at, count - i)
                for k in range(run):
                    _put(points, place + i + k, _float_at(table + 4 * (at + k)))
                i, at = i + run, 0
        else:
            run = min(inner - first % inner, count)
            while i < count:
                value = _float_at(table + 4 * at)
                for k in range(run):
                    _put(points, place + i + k, value)
                i, at = i + run, at + 1 if at + 1 < size else 0
                run = min(inner, count - i)
        for i in range(count, TILE):
            _put(points, place + i, np.float32(0.0))
        inner *= size


def _grid_of_doubles(points, source, first, count):
    inner = 1  # how many points have the same coordinate in a row
    for axis in range(_int_at(source)):
        size, table = _int_at(source + 8 + 16 * axis), _int_at(source + 16 + 16 * axis)
        place, at, i = axis * TILE, first // inner % size, 0
        if axis == 0:
            while i < count:
                run = min(size - at, count - i)
                for k in range(run):
                    _put(points, place + i + k, _double_at(table + 8 * (at + k)))
                i, at = i + run, 0
        else:
            run = min(inner - first % inner, count)
            while i < count:
                value = _double_at(table + 8 * at)
                for k in range(run):
                    _put(points, place + i + k, value)
                i, at = i + run, at + 1 if at + 1 < size else 0
                run = min(inner, count - i)
        for i in range(count, TILE):
            _put(points, place + i, 0.0)
        inner *= size


# -- the faces of a cube: source = texels along an edge, radius ---------------------------------------------

# how u (which runs right), v (down) and 1 make x, y and z of a face: the table of WebGPU's specification
_FACES = (
    ((0.0, 0.0, 1.0), (0.0, -1.0, 0.0), (-1.0, 0.0, 0.0)),
    ((0.0, 0.0, -1.0), (0.0, -1.0, 0.0), (1.0, 0.0, 0.0)),
    ((1.0, 0.0, 0.0), (0.0, 0.0, 1.0), (0.0, 1.0, 0.0)),
    ((1.0, 0.0, 0.0), (0.0, 0.0, -1.0), (0.0, -1.0, 0.0)),
    ((1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, 1.0)),
    ((-1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, -1.0)),
)


def _cube(points, source, first, count):
    size, radius = _int_at(source), _double_at(source + 8)
    step = 2.0 / size
    i = 0
    while i < count:
        face, row, column = (first + i) // (size * size), (first + i) // size % size, (first + i) % size
        (xu, xv, xw), (yu, yv, yw), (zu, zv, zw) = _FACES[face]
        v = (row + 0.5) * step - 1.0
        run = min(size - column, count - i)
        for k in range(run):
            u = (column + k + 0.5) * step - 1.0
            length = radius / math.sqrt(u * u + v * v + 1.0)
            _put(points, i + k, (xu * u + xv * v + xw) * length)
            _put(points, TILE + i + k, (yu * u + yv * v + yw) * length)
            _put(points, 2 * TILE + i + k, (zu * u + zv * v + zw) * length)
        i += run
    for i in range(count, TILE):
        _put(points, i, 0.0)
        _put(points, TILE + i, 0.0)
        _put(points, 2 * TILE + i, 0.0)


@functools.cache
def _address(function) -> int:
    """The address of a function, compiled when first wanted and cached on disk."""
    signature = sigutils.normalize_signature(types.void(types.voidptr, types.int64, types.int64, types.int64))
    return _compiled(function, signature)


_kept = []  # what is compiled lives as long as the addresses that are given away


def _compiled(function, signature) -> int:
    # as the decorator `cfunc` does, except for how machine code is kept
    callback = CFunc(function, signature, {}, {"error_model": "numpy"})
    callback.enable_caching()
    keyed(callback).compile()
    _kept.append(callback)
    return int(callback.address or 0)


class Source:
    """Points as the loops take them.

    Attributes
    ----------
    dimensions, count : int
    double : bool
        Whether the coordinates are float64; `doubled` makes them so.
    fill, data : int
        Addresses for the loops. They hold as long as this object lives.
    """

    def __init__(
        self, dimensions: int, count: int, double: bool, function, numbers: np.ndarray, keep: Any, wide=None
    ):
        self.dimensions, self.count, self.double = dimensions, count, double
        self._numbers, self._keep, self._wide = numbers, keep, wide
        self.fill, self.data = _address(function), numbers.ctypes.data

    def doubled(self) -> Source:
        """The same points in float64."""
        return self if self._wide is None else self._wide()


def arrays(axes: Sequence[np.ndarray], double: bool | None = None) -> Source:
    """Points as flat arrays of any stride, all float32 or all float64; float32 are widened if `double`."""
    wide = axes[0].dtype == np.float64
    function = _doubles if wide else _floats_as_doubles if double else _floats
    places = [(a.__array_interface__["data"][0], a.strides[0]) for a in axes]
    numbers = np.array([len(axes), *sum(places, ())], np.int64)
    double = wide or bool(double)
    return Source(
        len(axes),
        len(axes[0]),
        double,
        function,
        numbers,
        axes,
        None if double else lambda: arrays(axes, True),
    )


def grid(
    shape: Sequence[int], origin: Sequence[float], step: Sequence[float], double: bool = False
) -> Source:
    """Points of a regular grid; the last axis of `shape` is x, `origin` and `step` have x first.

    In float32 if all coordinates are float32 numbers, so that nothing is lost by it.
    """
    tables = [o + s * np.arange(n) for o, s, n in zip(origin, step, reversed(shape), strict=True)]
    narrow = [t.astype(np.float32) for t in tables]
    double = double or any((n != t).any() for n, t in zip(narrow, tables, strict=True))
    kept = tables if double else narrow
    numbers = np.array([len(shape), *sum(((len(t), t.ctypes.data) for t in kept), ())], np.int64)
    function = _grid_of_doubles if double else _grid_of_floats
    wide = None if double else lambda: grid(shape, origin, step, True)
    return Source(len(shape), math.prod(shape), double, function, numbers, kept, wide)


def cube(size: int, radius: float) -> Source:
    """Centres of the texels of the six faces of a cube, on the sphere."""
    numbers = np.array([size, np.float64(radius).view(np.int64)], np.int64)
    return Source(3, 6 * size * size, True, _cube, numbers, None)
