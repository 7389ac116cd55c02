"""The loops: tiles of 256 points, all octaves of a tile while it lies in the first-level cache.

For each tile the points are copied to the stack; for each octave `place` writes cells and offsets beside
them, and a second loop evaluates the noise and adds it up. Two loops instead of one cost nothing (the
stores go through ports that arithmetic does not use) and let float32 and float64 points, grids and periods
share one compiled loop.

Arrays come in as addresses and strides, so that one compiled function serves all layouts.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit
from numba.extending import overload

from .fractal import accumulate
from .kernels import evaluate
from .lanes import (
    as_int,
    get_float,
    larger,
    largest_float,
    load_floats,
    load_ints,
    pointer_at,
    put,
    put_float,
    read_double,
    read_float,
    scratch,
    shifted,
    splat,
    store,
)
from .lattice import inlined
from .place import REACH, TILE, cell_of, place_far, place_near, width_of

FLOATS = 4 * TILE  # bytes of a tile of floats
DOUBLES = 8 * TILE
# sizes of the buffers for up to four axes, as plain names, which Numba takes for literal numbers
_POINTS, _CELLS, _TOTALS = 4 * DOUBLES, 4 * FLOATS, 5 * FLOATS


compiled: Any = njit(cache=True, nogil=True, error_model="numpy")


@compiled
def run(static, inputs, outputs, frequencies, amplitudes, words, periods, start, stop):
    """Noise of the points from `start` to `stop`.

    Parameters
    ----------
    static : Static
    inputs, outputs : int64 array (n, 2)
        Address and stride in bytes of each axis; of the value and, if `static` wants them, the derivatives.
    frequencies, amplitudes : float64 array (octaves,)
    words : int64 array (octaves, 4)
    periods : float64 array (octaves, 4)
    """
    points = scratch(_POINTS)
    cells = scratch(_CELLS)
    offsets = scratch(_CELLS)
    totals = scratch(_TOTALS)
    weights = scratch(FLOATS)
    dimensions = len(inputs)
    for first in range(start, stop, TILE):
        count = min(TILE, stop - first)
        for axis in range(dimensions):
            target = shifted(points, axis * DOUBLES)
            fill(static, target, inputs[axis, 0], inputs[axis, 1], first, count)
        reach = reach_of(static, points, dimensions)
        for output in range(len(outputs)):
            clear(static, shifted(totals, output * FLOATS), 0.0)
        clear(static, weights, 1.0)
        for octave in range(len(frequencies)):
            frequency = frequencies[octave]
            near = reach * frequency < REACH  # false for NaN
            for axis in range(dimensions):
                source = shifted(points, axis * DOUBLES)
                to_cells, to_offsets = shifted(cells, axis * FLOATS), shifted(offsets, axis * FLOATS)
                if near:
                    place_near(static, source, to_cells, to_offsets, frequency)
                else:
                    place_far(static, source, to_cells, to_offsets, frequency, periods[octave, axis])
            octave_of_tile(
                static,
                cells,
                offsets,
                totals,
                weights,
                frequency,
                amplitudes[octave],
                words[octave],
                periods[octave],
            )
        for output in range(len(outputs)):
            write(
                static, shifted(totals, output * FLOATS), outputs[output, 0], outputs[output, 1], first, count
            )


def fill(static, target, address, stride, first, count) -> Any:
    """Copy one axis of the tile's coordinates to the stack; beyond the last point it is 0."""


@overload(fill, jit_options={"forceinline": True})
def _fill(static, target, address, stride, first, count):
    if static.value.double:
        read, zero = read_double, 0.0
    else:
        read, zero = read_float, np.float32(0.0)

    def copy(static, target, address, stride, first, count):
        for i in range(count):
            put(target, i, read(address, (first + i) * stride))
        for i in range(count, TILE):
            put(target, i, zero)

    return copy


def reach_of(static, points, dimensions) -> Any:
    """The largest absolute coordinate of a tile, or NaN where cells are to be found in float64 in any
    case."""


@overload(reach_of, jit_options={"forceinline": True})
def _reach_of(static, points, dimensions):
    if static.value.double or static.value.periodic:
        return lambda static, points, dimensions: np.nan

    def largest(static, points, dimensions):
        top = splat(static, 0)
        for axis in range(dimensions):
            source = shifted(points, axis * DOUBLES)
            for i in range(0, TILE, width_of(static)):
                # without their signs, floats are ordered as integers, and NaN comes after infinity
                top = larger(top, as_int(load_floats(static, source, i)) & 0x7FFFFFFF)
        return np.float64(largest_float(top))

    return largest


@inlined
def clear(static, target, value):
    for i in range(0, TILE, width_of(static)):
        store(target, i, splat(static, value))


def octave_of_tile(static, cells, offsets, totals, weights, frequency, amplitude, words, periods) -> Any:
    """Evaluate one octave at every point of a tile and add it to the totals."""


@overload(octave_of_tile, jit_options={"forceinline": True})
def _octave_of_tile(static, cells, offsets, totals, weights, frequency, amplitude, words, periods):
    if static.value.derivatives:
        return _with_derivatives

    def values(static, cells, offsets, totals, weights, frequency, amplitude, words, periods):
        keys, lengths = words_of(static, words), periods_of(static, periods)
        share = splat(static, amplitude)
        for i in range(0, TILE, width_of(static)):
            (value,) = evaluate(
                static, cells_of(static, cells, i), offsets_of(static, offsets, i), keys, lengths
            )
            total, weight = accumulate(
                static, value, share, load_floats(static, totals, i), load_floats(static, weights, i)
            )
            store(totals, i, total)
            store(weights, i, weight)

    return values


def _with_derivatives(static, cells, offsets, totals, weights, frequency, amplitude, words, periods):
    keys, lengths = words_of(static, words), periods_of(static, periods)
    share, slope = splat(static, amplitude), splat(static, amplitude * frequency)
    for i in range(0, TILE, width_of(static)):
        found = evaluate(static, cells_of(static, cells, i), offsets_of(static, offsets, i), keys, lengths)
        store(totals, i, load_floats(static, totals, i) + found[0] * share)
        for axis in range(1, len(found)):
            place = i + axis * TILE
            store(totals, place, load_floats(static, totals, place) + found[axis] * slope)


def cells_of(static, cells, i) -> Any:
    """The cells of all axes as lanes."""


@overload(cells_of, jit_options={"forceinline": True})
def _cells_of(static, cells, i):
    def two(static, cells, i):
        return cell_of(load_ints(static, cells, i)), cell_of(load_ints(static, cells, i + TILE))

    def three(static, cells, i):
        return (
            cell_of(load_ints(static, cells, i)),
            cell_of(load_ints(static, cells, i + TILE)),
            cell_of(load_ints(static, cells, i + 2 * TILE)),
        )

    def four(static, cells, i):
        return (
            cell_of(load_ints(static, cells, i)),
            cell_of(load_ints(static, cells, i + TILE)),
            cell_of(load_ints(static, cells, i + 2 * TILE)),
            cell_of(load_ints(static, cells, i + 3 * TILE)),
        )

    return (two, three, four)[static.value.dimensions - 2]


def offsets_of(static, offsets, i) -> Any:
    """The offsets of all axes as lanes."""


@overload(offsets_of, jit_options={"forceinline": True})
def _offsets_of(static, offsets, i):
    def two(static, offsets, i):
        return load_floats(static, offsets, i), load_floats(static, offsets, i + TILE)

    def three(static, offsets, i):
        return (
            load_floats(static, offsets, i),
            load_floats(static, offsets, i + TILE),
            load_floats(static, offsets, i + 2 * TILE),
        )

    def four(static, offsets, i):
        return (
            load_floats(static, offsets, i),
            load_floats(static, offsets, i + TILE),
            load_floats(static, offsets, i + 2 * TILE),
            load_floats(static, offsets, i + 3 * TILE),
        )

    return (two, three, four)[static.value.dimensions - 2]


def words_of(static, words) -> Any:
    """The words of an octave, each in all lanes (four, whatever the dimensions: some kinds draw from the
    rest)."""


@overload(words_of, jit_options={"forceinline": True})
def _words_of(static, words):
    return lambda static, words: (
        splat(static, words[0]),
        splat(static, words[1]),
        splat(static, words[2]),
        splat(static, words[3]),
    )


def periods_of(static, periods) -> Any:
    """The periods of an octave, each in all lanes, or None for each."""


@overload(periods_of, jit_options={"forceinline": True})
def _periods_of(static, periods):
    if not static.value.periodic:
        return lambda static, periods: (None, None, None, None)
    return lambda static, periods: (
        splat(static, np.int64(periods[0])),
        splat(static, np.int64(periods[1])),
        splat(static, np.int64(periods[2])),
        splat(static, np.int64(periods[3])),
    )


@inlined
def write(static, source, address, stride, first, count):
    """Copy a tile's result out."""
    if stride == 4 and count == TILE:
        target = pointer_at(address + 4 * first)
        for i in range(0, TILE, width_of(static)):
            store(target, i, load_floats(static, source, i))
    else:
        for i in range(count):
            put_float(address, (first + i) * stride, get_float(source, i))
