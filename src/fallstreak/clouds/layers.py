"""A world's cloud layers with everything filled in: what the scene says over what is usual of each genus."""

from __future__ import annotations

from dataclasses import dataclass
from math import floor
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from .shapes import CloudModel


@dataclass(frozen=True)
class Noise:
    """How noise eats at a layer's clouds."""

    tile: float
    """m, width of the noise's period."""
    strength: float
    """Of the field F that noise adds or takes, from end to end."""
    edge: float
    """Width in F from the surface to full density."""
    base: float
    """m over which flat bases set in."""
    stretch: float = 1.0
    """Times longer along the wind than across."""
    shear: float = 0.0
    """m downwind per m of height that fibres trail."""
    fine: float = 0.35
    """Share of the second look, 4.3 times as fine."""


@dataclass(frozen=True, eq=False)
class Layer:
    """One layer. Lengths in m, times in s; see the contract of the field in ``clouds/field``.

    Attributes
    ----------
    cell : m, width of the lattice's cells
    jitter : how far a cloud may stand from its cell's middle, in cells
    scales : least and greatest size of a cloud over its model's
    growth : most that coverage may enlarge them beyond
    base, thickness : m; of a cloud of scale 1
    base_spread : m, how much bases differ
    bounds : m, lowest base and highest top
    wind : (2,) m/s, whereto
    need : by what coverage must be multiplied, see ``field/coverage.py``
    models : of which the clouds are copies; `first_model` counts in the list of all layers
    map : index of the coverage map, or None
    """

    genus: str
    coverage: float
    base: float
    thickness: float
    extinction: float
    cell: float
    jitter: float
    scales: tuple[float, float]
    growth: float
    base_spread: float
    bounds: tuple[float, float]
    wind: np.ndarray
    lifetime: float
    clustering: float
    need: float
    seed: int
    noise: Noise
    models: tuple[CloudModel, ...]
    first_model: int
    map: int | None = None

    @property
    def model_count(self) -> int:
        """How many models it draws from."""
        return len(self.models)

    @property
    def wind_direction(self) -> tuple[float, float]:
        """Unit, whereto the wind blows; east where there is none."""
        speed = float(np.hypot(*self.wind))
        return (1.0, 0.0) if speed == 0.0 else (float(self.wind[0]) / speed, float(self.wind[1]) / speed)

    def lives(self, time: float) -> tuple[int, float]:
        """Generation of clouds and the part of its time that has passed, at a scene time (s)."""
        if self.lifetime == 0.0:
            return 0, 0.0
        lives = time / self.lifetime
        return floor(lives), lives - floor(lives)
