"""Which compiled function makes which kind of noise.

The modules of `MODULES` register their functions with `kernel` when they are imported, which happens when
the first loop is compiled, not with the package.
"""

from __future__ import annotations

import importlib
from collections.abc import Callable
from typing import Any

from numba.extending import overload, register_jitable

#: The module of each kind (in this package), and of each family of kinds.
MODULES = {
    "perlin": "perlin",
    "simplex": "simplex",
    "value": "value",
    "cellular_f1": "cellular",
    "cellular_f2": "cellular",
    "cellular_f2f1": "cellular",
    "improved": "improved",
    "table": "table",
    "curl": "flow",
    "simplex_periodic": "simplex_periodic",
}

_REGISTER: dict[tuple[str, int, bool], Callable] = {}


def kernel(kind: str, dimensions: int, derivatives: bool = False):
    """Register a function as this kind of noise; see `perlin.py` for what it takes and gives."""

    def register(function):
        inlined = register_jitable(forceinline=True)(function)
        _REGISTER[kind, dimensions, derivatives] = inlined
        return inlined

    return register


def find(kind: str, dimensions: int, derivatives: bool) -> Callable:
    """The registered function."""
    importlib.import_module(f".{MODULES[kind]}", __package__)
    return _REGISTER[kind, dimensions, derivatives]


def evaluate(static, cells, offsets, words, periods) -> Any:
    """The noise that `static` chooses."""


@overload(evaluate, jit_options={"forceinline": True})
def _evaluate(static, cells, offsets, words, periods):
    choice = static.value
    noise = find(choice.kind, choice.dimensions, choice.derivatives)
    return lambda static, cells, offsets, words, periods: noise(cells, offsets, words, periods)
