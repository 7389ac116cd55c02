"""How octaves add up: one step per octave on lanes, chosen by `Static.fractal`.

A fractal is a function ``step(value, amplitude, total, weight) -> (total, weight)``, registered by name with
`fractal`: `value` is the octave's noise, `amplitude` its share (gain^i over the sum of all), `total` starts
at 0 and `weight`, which only some need, at 1.
"""

from __future__ import annotations

from numba.extending import overload, register_jitable

from .lanes import fma

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


def accumulate(static, value, amplitude, total, weight):
    """One step of the fractal that `static` chooses."""


@overload(accumulate, jit_options={"forceinline": True})
def _accumulate(static, value, amplitude, total, weight):
    step = _REGISTER[static.value.fractal]
    return lambda static, value, amplitude, total, weight: step(value, amplitude, total, weight)
