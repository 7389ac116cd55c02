"""What covers places, on the CPU: float64 twin of ``cover.wesl``."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Sites:
    """Places and what is known of the ground there; arrays that broadcast to one shape.

    Attributes
    ----------
    east, north : m on the map
    step : m between samples
    seed : int
    height : m above sea level
    normal : (…, 3), in the axes of the place
    slope : rise over run as one would measure it close by
    hollow : −1 crest … 1 hollow, over some 120 m
    relief : height above the mean of 700 m about, in 100 m
    water : m of water above the ground, negative where dry
    open : 0…1, share of the sky in view
    land : 1 on the land, 0 where it ends at the map's edge
    """

    east: np.ndarray
    north: np.ndarray
    step: np.ndarray | float
    seed: int
    height: np.ndarray
    normal: np.ndarray
    slope: np.ndarray
    hollow: np.ndarray
    relief: np.ndarray
    water: np.ndarray
    open: np.ndarray
    land: np.ndarray


@dataclass(frozen=True)
class Covers:
    """What covers places.

    Attributes
    ----------
    weights : (…, 6), shares of the palette's materials, sum 1
    tint : (…, 3), mean albedo, linear Rec. 709
    wetness : 0 dry … 1 soaked
    growth : 0…1, how densely tall plants stand
    """

    weights: np.ndarray
    tint: np.ndarray
    wetness: np.ndarray
    growth: np.ndarray
