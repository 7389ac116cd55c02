"""Grass and rock, until a country has a cover of its own."""

from __future__ import annotations

import numpy as np

from ..pattern import smoothstep
from .cover import Covers, Sites

PALETTE = ("grass", "forest_floor", "canopy", "soil", "sandstone", "scree")


def cover(site: Sites) -> Covers:
    """What covers places."""
    slope = np.asarray(site.slope, float)
    rock = smoothstep(0.4, 0.9, slope)
    wood = smoothstep(0.1, 0.3, slope) * (1.0 - rock)
    zero = np.zeros(slope.shape)
    tint = np.array([0.08, 0.09, 0.04]) + rock[..., None] * np.array([0.12, 0.09, 0.12])
    return Covers(np.stack([1.0 - rock - wood, zero, wood, zero, rock, zero], -1), tint, zero, zero)
