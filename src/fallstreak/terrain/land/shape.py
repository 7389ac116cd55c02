"""What a kind of land says about places, on the CPU: float64 twin of ``shape.wesl``."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from ...gpu import Struct

NO_WATER = -1e5

LAND = Struct(
    "Land",
    [
        ("base_height", "f32", "m, mean height of the ground"),
        ("relief", "f32", "m from valleys to summits, or from rim to river"),
        ("feature_size", "f32", "m from one mountain, gorge or dune field to the next"),
        ("roughness", "f32", "0 rolling .. 1 jagged"),
        ("water_level", "f32", "m above sea level of sea and lakes; -1e5 where there are none"),
    ],
)
"""The numbers of ``world.terrain`` that every kind of land takes."""


def land_values(terrain: Any) -> dict[str, float]:
    """The fields of `LAND` for a ``world.terrain``."""
    return {
        "base_height": terrain.base_height * terrain.vertical_exaggeration,
        "relief": terrain.relief * terrain.vertical_exaggeration,
        "feature_size": terrain.feature_size,
        "roughness": terrain.roughness,
        "water_level": NO_WATER if terrain.water_level is None else terrain.water_level,
    }


@dataclass(frozen=True)
class LandShape:
    """The land at places; float64 arrays of one shape.

    Attributes
    ----------
    height : m above sea level
    water : m above sea level, the surface of the water; -1e5 where there is none
    shift_east, shift_north : m, from the place on the map to where it is drawn
    lost : rise over run, root mean square, of the detail that the step leaves out
    open : 0..1, share of the sky that the large forms leave free
    """

    height: np.ndarray
    water: np.ndarray
    shift_east: np.ndarray
    shift_north: np.ndarray
    lost: np.ndarray
    open: np.ndarray


class LandModel(Protocol):
    """A kind of land.

    Attributes
    ----------
    outside : m, height of the globe beyond the map
    shift_bound : m, the largest shift of a sample from its place on the map
    """

    outside: float
    shift_bound: float

    def bounds(self) -> tuple[float, float]:
        """Lowest and highest height anywhere, m."""
        ...

    def shape(self, east: np.ndarray, north: np.ndarray, step: np.ndarray | float) -> LandShape:
        """The land at places (m) as a mesh with `step` metres between vertices can carry it."""
        ...
