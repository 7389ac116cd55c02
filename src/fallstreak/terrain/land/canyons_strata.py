"""Layers of rock, hard and soft in turn: float64 twin of ``canyons_strata.wesl``.

A layer weathers into a slope of what is soft, under a cliff of what is hard. Layers are counted in heights
along the bedding: above sea level less what the layers lean and fold (`folds`), plus how much thicker they
are here (`thickening`). So they run along all walls alike, and need no number of the scene.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..octaves import octave_weight
from ..pattern import smoothstep
from .canyons_graded import Graded
from .canyons_network import draws, waves

LAYER = 84.0  # m
BAND = 31.0  # m
BED = 12.0  # m
FALL = 0.0005  # of all the land, rise eastward


def folds(east: Graded, north: Graded, seed: int) -> Graded:
    """How much higher the layers lie here than at the anchor, m."""
    return FALL * east + 60.0 * waves(east, north, 13, seed + 20)


def thickening(east: Graded, north: Graded, step, seed: int):
    """How much higher a point lies in its layer than it does by its height, m."""
    wide, near = waves(east, north, 11, seed + 41).value, waves(east, north, 8, seed + 30).value
    return 14.0 * wide + 5.0 * octave_weight(8, step) * near


def rim_of(height: float) -> int:
    """The layer above the plateau: its lower border is the nearest to a height."""
    return int(np.floor(height / LAYER + 0.5))


class Layer(NamedTuple):
    """Lower border and thickness (m), number, four draws 0…1."""

    low: np.ndarray
    thick: np.ndarray
    number: np.ndarray
    own: tuple[np.ndarray, ...]


def border(k, thickness: float, seed: int):
    """Height along the bedding of a layer's lower border."""
    return (k + 0.5 * (draws(k, np.zeros_like(k), seed)[0] - 0.5)) * thickness


def layer_of(height, thickness: float, seed: int) -> Layer:
    """The layer at a height along the bedding."""
    k = np.floor(height / thickness)
    low, high = border(k, thickness, seed), border(k + 1.0, thickness, seed)
    # borders move by less than half a layer, so that one step finds the right one
    k = k + np.where(height < low, -1.0, np.where(height >= high, 1.0, 0.0))
    low, high = border(k, thickness, seed), border(k + 1.0, thickness, seed)
    return Layer(low, high - low, k, draws(k, np.zeros_like(k) + 1.0, seed))


def cliff_of(layer: Layer):
    """Share of a layer's height that is cliff; some are all slope."""
    return np.where(layer.own[0] < 0.15, 0.30, 0.60 + 0.32 * layer.own[1])


class Terrace(NamedTuple):
    """Where a point of the mean slope goes.

    Attributes
    ----------
    rise : m, added to the height
    back : m of height of mean slope by which it lies farther back; over the slope it is metres
    thick : m, of the layer
    under : 0…1, how far below the brow of an overhang
    firm : 1 in the cliff, 0 where layers meet
    number : of the layer
    """

    rise: np.ndarray
    back: np.ndarray
    thick: np.ndarray
    under: np.ndarray
    firm: np.ndarray
    number: np.ndarray


def terrace(height, overhang, rim: int, seed: int) -> Terrace:
    """Into a layer of cliff above slope; `rim` is the layer above the plateau."""
    layer = layer_of(height, LAYER, seed)
    q = (height - layer.low) / layer.thick
    cliff = np.where(layer.number == rim - 1.0, 0.85, cliff_of(layer))
    part = 0.66 - 0.3 * cliff  # of the way that is slope
    s, up = np.clip((q - part) / (1.0 - part), 0.0, 1.0), np.clip(q / part, 0.0, 1.0)
    soft = q < part
    rise = np.where(soft, up * (1.0 - cliff), 1.0 - cliff + cliff * s)
    back = np.where(soft, up * (1.0 + overhang), 1.0 + overhang * (1.0 - s) ** 2)
    firm = up * up * np.clip(8.0 - 8.0 * s, 0.0, 1.0)
    under = np.where(soft, up, 1.0 - s)
    return Terrace((rise - q) * layer.thick, (back - q) * layer.thick, layer.thick, under, firm, layer.number)


def hardness(height, thickness: float, seed: int):
    """Of single beds, −1 soft … 1 hard: sharper at a bed's top than at its foot; mean about 0."""
    bed = layer_of(height, thickness, seed)
    q = (height - bed.low) / bed.thick
    return (2.0 * bed.own[1] - 1.0) * smoothstep(0.0, 0.5, q) * smoothstep(0.0, 0.3, 1.0 - q)
