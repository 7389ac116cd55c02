"""Compiled loops where they pay: for large elevation models, as soon as they stand.

Importing Numba takes a quarter of a second, compiling on a new machine some seconds more. NumPy has built the
ground of a small model by then; of a large one the loops save more than that. Both find the same numbers, so
it does not matter which of them did what, nor when the one took over from the other.
"""

from __future__ import annotations

from threading import Thread
from types import ModuleType

_WAIT = 0.8  # s: machine code on disk is loaded by then
_state: dict[str, ModuleType] = {}


def quicken() -> None:
    """Load the compiled loops; where they have to be compiled first, NumPy works on in the meantime."""
    if "loops" not in _state:
        loading = Thread(target=_load, name="fallstreak-loops")
        loading.start()
        loading.join(_WAIT)


def loops() -> ModuleType | None:
    """The module `loops`, if it has been asked for and stands."""
    return _state.get("loops")


def _load() -> None:
    from . import loops

    loops.warm()
    _state["loops"] = loops
