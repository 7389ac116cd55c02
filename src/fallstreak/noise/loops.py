"""The loops: tiles of 256 points, all octaves of a tile while it lies in the first-level cache.

Arrays come in as addresses, so that one compiled function serves all layouts; the points of a tile are
written by a compiled function of `sources.py`, of which only the address is known here: the loops need not
be compiled again for grids, faces of a cube, or points of another precision.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit
from numba.extending import overload

from .fractal import accumulate
from .kernels import evaluate
from .lanes import as_int, larger
from .lattice import inlined
from .machine_code import keyed
from .memory import (
    call_address,
    get_float,
    largest_float,
    load_floats,
    load_ints,
    pointer_at,
    put_float,
    rounded,
    scratch,
    shifted,
    splat,
    store,
    width_of,
)
from .place import EXCESS, REACH, REACH_SHEARED, SHEARED, lengths_of, locate, scale_of, short_scale_of
from .sources import TILE
from .vectors import whole_registers

FLOATS = 4 * TILE  # bytes of a tile of floats
# sizes of the buffers for up to four axes, as plain names, which Numba takes for literal numbers
_POINTS, _CELLS, _TOTALS = 8 * FLOATS, 4 * FLOATS, 5 * FLOATS


def compiled(function) -> Any:
    """Compile when called, once for all processes."""
    return keyed(njit(cache=True, nogil=True, error_model="numpy")(function))


@compiled
def run(static, fill, source, outputs, frequencies, amplitudes, words, periods, start, stop):
    """Noise of the points from `start` to `stop`.

    Parameters
    ----------
    static : Static
    fill, source : int
        Address of a function of `sources.py`, and of what it reads.
    outputs : int64 array (n, 2)
        Address and stride in bytes of the value and, if `static` wants them, of each derivative.
    frequencies, amplitudes : float64 array (octaves,)
    words : int64 array (octaves, 4)
    periods : float64 array (octaves, 4)

    Returns
    -------
    bool
        False if some points lie too far for float32; the results are then of no use.
    """
    points = scratch(_POINTS)
    cells, offsets = scratch(_CELLS), scratch(_CELLS)
    totals = scratch(_TOTALS)
    weights = scratch(FLOATS)
    highest = (
        0.0  # found by a loop: `frequencies.max()` would make who loads this import half of Numba, and SciPy
    )
    for octave in range(len(frequencies)):
        highest = max(highest, frequencies[octave])
    for first in range(start, stop, TILE):
        count = min(TILE, stop - first)
        call_address(fill, points, source, first, count)
        if not near(static, points, highest):
            return False
        for output in range(len(outputs)):
            clear(static, shifted(totals, output * FLOATS), 0.0)
        clear(static, weights, 1.0)
        for octave in range(len(frequencies)):
            one_octave(
                static,
                points,
                cells,
                offsets,
                totals,
                weights,
                frequencies[octave],
                amplitudes[octave],
                words[octave],
                periods[octave],
            )
        for output in range(len(outputs)):
            write(
                static, shifted(totals, output * FLOATS), outputs[output, 0], outputs[output, 1], first, count
            )
    return True


def near(static, points, frequency) -> Any:
    """Whether all cells of a tile are within what `locate` can do."""


@overload(near, jit_options={"forceinline": True})
def _near(static, points, frequency):
    if static.value.double:
        return lambda static, points, frequency: True
    dimensions = static.value.dimensions
    reach = REACH_SHEARED if static.value.kind in SHEARED else REACH

    def reached(static, points, frequency):
        top = splat(static, 0)
        for axis in range(dimensions):
            for i in range(axis * TILE, (axis + 1) * TILE, width_of(static)):
                # without their signs, floats are ordered as integers, and NaN comes after infinity
                top = larger(top, as_int(load_floats(static, points, i)) & 0x7FFFFFFF)
        return largest_float(top) * frequency < reach

    return reached


@inlined
def clear(static, target, value):
    for i in range(0, TILE, width_of(static)):
        store(target, i, splat(static, value))


def one_octave(static, points, cells, offsets, totals, weights, frequency, amplitude, words, periods) -> Any:
    """Evaluate one octave at every point of a tile and add it to the totals."""


@overload(one_octave, jit_options={"forceinline": True})
def _one_octave(static, points, cells, offsets, totals, weights, frequency, amplitude, words, periods):
    return _with_derivatives if static.value.derivatives else _values


def _values(static, points, cells, offsets, totals, weights, frequency, amplitude, words, periods):
    whole_registers()
    scale, keys = scale_of(static, frequency), words_of(static, words)
    lengths, wraps = lengths_of(static, periods), wraps_of(static, periods)
    share = splat(static, amplitude)
    locate_all(static, points, cells, offsets, frequency, lengths)
    for i in range(0, TILE, width_of(static)):
        found, ways = located(static, points, cells, offsets, i, scale, lengths)
        (value,) = evaluate(static, found, ways, keys, wraps)
        total, weight = accumulate(
            static, value, share, load_floats(static, totals, i), load_floats(static, weights, i)
        )
        store(totals, i, total)
        store(weights, i, weight)


def _with_derivatives(static, points, cells, offsets, totals, weights, frequency, amplitude, words, periods):
    whole_registers()
    scale, keys = scale_of(static, frequency), words_of(static, words)
    lengths, wraps = lengths_of(static, periods), wraps_of(static, periods)
    share, slope = splat(static, amplitude), splat(static, amplitude * frequency)
    locate_all(static, points, cells, offsets, frequency, lengths)
    for i in range(0, TILE, width_of(static)):
        found, ways = located(static, points, cells, offsets, i, scale, lengths)
        values = evaluate(static, found, ways, keys, wraps)
        store(totals, i, load_floats(static, totals, i) + values[0] * share)
        for axis in range(1, len(values)):
            place = i + axis * TILE
            store(totals, place, load_floats(static, totals, place) + values[axis] * slope)


# -- cells: found where they are needed, or, where that makes too long a chain of instructions that wait for
# each other (simplex noise), by a loop of their own, which writes them beside the points
# -------------------------


def locate_all(static, points, cells, offsets, frequency, lengths) -> Any:
    """The loop before."""


@overload(locate_all, jit_options={"forceinline": True})
def _locate_all(static, points, cells, offsets, frequency, lengths):
    if static.value.kind not in SHEARED:
        return lambda static, points, cells, offsets, frequency, lengths: None

    def loop(static, points, cells, offsets, frequency, lengths):
        scale = scale_of(static, frequency)
        for i in range(0, TILE, width_of(static)):
            put_all(cells, offsets, i, locate(static, points, i, scale, lengths))

    def either(static, points, cells, offsets, frequency, lengths):
        if frequency == np.float64(rounded(frequency)):
            scale = short_scale_of(static, frequency)
            for i in range(0, TILE, width_of(static)):
                put_all(cells, offsets, i, locate(static, points, i, scale, lengths))
        else:
            scale = scale_of(static, frequency)
            for i in range(0, TILE, width_of(static)):
                put_all(cells, offsets, i, locate(static, points, i, scale, lengths))

    return loop if static.value.double else either


def located(static, points, cells, offsets, i, scale, lengths) -> Any:
    """Cells and offsets of some samples."""


@overload(located, jit_options={"forceinline": True})
def _located(static, points, cells, offsets, i, scale, lengths):
    if static.value.kind not in SHEARED:
        return lambda static, points, cells, offsets, i, scale, lengths: locate(
            static, points, i, scale, lengths
        )
    return lambda static, points, cells, offsets, i, scale, lengths: (
        cells_of(static, cells, i),
        offsets_of(static, offsets, i),
    )


@inlined
def put_all(cells, offsets, i, located):
    found, ways = located
    for axis in range(len(found)):
        # with the excess that the loop after takes off for nothing, since it multiplies and adds constants
        # anyway
        store(cells, i + axis * TILE, found[axis] + EXCESS)
        store(offsets, i + axis * TILE, ways[axis])


def cells_of(static, cells, i) -> Any:
    """The cells of all axes as lanes."""


@overload(cells_of, jit_options={"forceinline": True})
def _cells_of(static, cells, i):
    def two(static, cells, i):
        return load_ints(static, cells, i) - EXCESS, load_ints(static, cells, i + TILE) - EXCESS

    def three(static, cells, i):
        return (
            load_ints(static, cells, i) - EXCESS,
            load_ints(static, cells, i + TILE) - EXCESS,
            load_ints(static, cells, i + 2 * TILE) - EXCESS,
        )

    def four(static, cells, i):
        return (
            load_ints(static, cells, i) - EXCESS,
            load_ints(static, cells, i + TILE) - EXCESS,
            load_ints(static, cells, i + 2 * TILE) - EXCESS,
            load_ints(static, cells, i + 3 * TILE) - EXCESS,
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
    if static.value.kind == "curl" and static.value.dimensions == 3:  # of three noises
        return lambda static, words: four(static, words, 0) + four(static, words, 4) + four(static, words, 8)
    return lambda static, words: four(static, words, 0)


@inlined
def four(static, words, first):
    return (
        splat(static, words[first]),
        splat(static, words[first + 1]),
        splat(static, words[first + 2]),
        splat(static, words[first + 3]),
    )


def wraps_of(static, periods) -> Any:
    """The periods of an octave as integers, each in all lanes, or None for each."""


@overload(wraps_of, jit_options={"forceinline": True})
def _wraps_of(static, periods):
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
