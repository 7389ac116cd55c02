"""Noise on the CPU and its WESL twin: the same integers, the same values to rounding.

`sample`, `fbm` and the other functions here compute it on the CPU, by loops that Numba compiles when they
are first called and keeps on disk; importing compiles nothing. `bake` and the WESL modules of this folder
do it on the GPU. `kinds` lists what there is, `quality` measures how good a noise is. docs/noise.md has the
sources, the speed and the limits.

`gradient.py` is an older 2-D noise with its own scale that the terrain is built from.
"""

from __future__ import annotations

# Modules that bear the name of a function are imported before it, else a later import would hide it.
from . import gradient as _terrain  # noqa: F401  # isort: skip
from . import kinds
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
