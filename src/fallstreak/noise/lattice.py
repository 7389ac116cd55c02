"""The hash of `hashing.py` on lanes, shared by all kinds on a cubic lattice, and the fade between its points.

Signed 16-bit numbers stand in the low half of 32-bit lanes; what stands above is of no use and is never
cleared, because `multiply16`, `multiply16_high` and the permutes do not look at it.
"""

from __future__ import annotations

from typing import Any

from numba.core import types
from numba.extending import overload, register_jitable

from .hashing import MULTIPLIER
from .lanes import fma, multiply16, multiply16_high, select, shift_right

MULTIPLY = MULTIPLIER - (1 << 32)  # as a signed number, which keeps Numba from widening it

HIGH_AND_ODD = 0x8001  # no plane's hash is a small number, see hashing.py

inlined = register_jitable(forceinline=True)


@inlined
def axis_hash(cell, word):
    """The hash of one lattice plane."""
    t = cell * MULTIPLY + word
    return (t ^ shift_right(t, 16)) | HIGH_AND_ODD


@inlined
def fold(t):
    return (t ^ shift_right(t, 16)) | HIGH_AND_ODD


def axis_pair(cell, word, period) -> Any:
    """The hashes of a cell's own lattice plane and of the next; `period` is lanes of cells, or None."""


@overload(axis_pair, jit_options={"forceinline": True})
def _axis_pair(cell, word, period):
    if isinstance(period, types.NoneType):

        def plain(cell, word, period):
            t = cell * MULTIPLY + word
            return fold(t), fold(t + MULTIPLY)

        return plain

    def wrapped(cell, word, period):
        t = cell * MULTIPLY + word
        return fold(t), fold(select(cell + 1 == period, word, t + MULTIPLY))

    return wrapped


def neighbour(cell, step, period) -> Any:
    """The cell so many further (at most a period), wrapped into 0..period - 1 unless that is None."""


@overload(neighbour, jit_options={"forceinline": True})
def _neighbour(cell, step, period):
    if isinstance(period, types.NoneType):
        return lambda cell, step, period: cell + step

    def wrapped(cell, step, period):
        moved = cell + step
        moved = select(moved < 0, moved + period, moved)
        return select(moved >= period, moved - period, moved)

    return wrapped


@inlined
def pair(a, b):
    """Two 16-bit hashes as one."""
    return multiply16(a, b)


@inlined
def index(a, b):
    """The index that a corner with the factors a and b draws, in the low bits; what stands above is of no
    use."""
    return multiply16_high(a, b)


@inlined
def fade(t):
    """Perlin's quintic, about its middle: as cheap as in t, and without the cancellation that costs a digit
    there."""
    s = t - 0.5
    square = s * s
    return fma(s, fma(square, fma(square, 6.0, -5.0), 1.875), 0.5)


@inlined
def fade_slope(t):
    """The derivative of `fade`."""
    s = t * (t - 1.0)
    return 30.0 * s * s


@inlined
def mix(t, a, b):
    """From a (t = 0) to b (t = 1)."""
    return fma(t, b - a, a)
