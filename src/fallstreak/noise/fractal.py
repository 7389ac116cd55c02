"""How octaves add up: one step per octave on lanes, chosen by `Static.fractal`.

A fractal is a function ``step(value, amplitude, total, weight) -> (total, weight)``, registered by name with
`fractal`: `value` is the octave's noise, `amplitude` its share (gain^i over the sum of all), `total` starts
at 0 and `weight`, which only some need, at 1.
"""

from __future__ import annotations

from typing import Any

from numba.extending import overload, register_jitable

from .lanes import absolute, fma, larger, smaller

_REGISTER = {}

#: Fractals that need `weight` from octave to octave.
WEIGHTED = frozenset({"ridged", "hybrid"})


def fractal(name: str):
    """Register a function as this fractal."""

    def register(function):
        _REGISTER[name] = register_jitable(forceinline=True)(function)
        return _REGISTER[name]

    return register


@fractal("fbm")
def fbm(value, amplitude, total, weight):
    return fma(value, amplitude, total), weight


@fractal("billow")
def billow(value, amplitude, total, weight):
    return fma(fma(absolute(value), 2.0, -1.0), amplitude, total), weight


@fractal("turbulence")
def turbulence(value, amplitude, total, weight):
    return fma(absolute(value), amplitude, total), weight


@fractal("ridged")
def ridged(value, amplitude, total, weight):
    """Musgrave's ridged multifractal with offset 1 and gain 2: what is low stays smooth."""
    crest = 1.0 - absolute(value)
    signal = crest * crest * weight
    return fma(signal, amplitude, total), smaller(signal + signal, 1.0)


@fractal("hybrid")
def hybrid(value, amplitude, total, weight):
    """Musgrave's hybrid multifractal with offset 0.7; the weight forgets the amplitudes, which only scale."""
    signal = (value + 0.7) * weight
    return fma(signal, amplitude, total), larger(smaller(signal, 1.0), 0.0)


def accumulate(static, value, amplitude, total, weight) -> Any:
    """One step of the fractal that `static` chooses."""


@overload(accumulate, jit_options={"forceinline": True})
def _accumulate(static, value, amplitude, total, weight):
    step = _REGISTER[static.value.fractal]
    return lambda static, value, amplitude, total, weight: step(value, amplitude, total, weight)
