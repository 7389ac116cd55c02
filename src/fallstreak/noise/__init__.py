"""Noise on the CPU and its WESL twin: the same integers, the same values to rounding.

`sample`, `fbm` and the other functions here compute it on the CPU, by loops that Numba compiles when they
are first called and keeps on disk; importing compiles nothing, and does not even import Numba. `bake` and
the WESL modules of this folder do it on the GPU. `kinds` lists what there is, `quality` measures how good a
noise is. docs/noise.md has the sources, the speed and the limits.

`patterns` is Perlin noise in the scale that land and sky are made in, `scatter` has random numbers for what
is scattered one to a cell.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from . import kinds

if TYPE_CHECKING:
    from .api import (
        billow,
        cube,
        cube_directions,
        curl,
        fbm,
        gradient,
        grid,
        hybrid,
        ridged,
        sample,
        turbulence,
        warp,
    )

__all__ = [
    "billow",
    "cube",
    "cube_directions",
    "curl",
    "fbm",
    "gradient",
    "grid",
    "hybrid",
    "kinds",
    "ridged",
    "sample",
    "turbulence",
    "warp",
]


def __getattr__(name: str) -> Any:
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(".api", __name__), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
