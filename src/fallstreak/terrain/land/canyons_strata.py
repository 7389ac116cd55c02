"""Layers of rock, hard and soft in turn: float64 twin of ``canyons_strata.wesl``.

A layer weathers into a slope of what is soft, under a cliff of what is hard. Heights are counted from the plateau's
bedding, so that layers run along all walls at the same height and dip with the land.
"""

from __future__ import annotations

import numpy as np

from .canyons_network import draws

LAYER = 84.0  # m
BED = 12.0  # m


def layer_of(depth, thickness, seed: int):
    """The layer at a depth: its number, lower border, thickness (m), and four draws."""
    k = np.floor(depth / thickness)
    low, high = _border(k, thickness, seed), _border(k + 1.0, thickness, seed)
    # borders move by less than half a layer, so that one step finds the right one
    shift = np.where(depth < low, -1.0, np.where(depth >= high, 1.0, 0.0))
    k = k + shift
    low, high = _border(k, thickness, seed), _border(k + 1.0, thickness, seed)
    return k, low, high - low, draws(k, np.zeros_like(k) + 1.0, seed)


def _border(k, thickness, seed: int):
    r = draws(k, np.zeros_like(k), seed)[0]
    # the plateau is the top of a layer
    return (k + np.where(k == 0.0, 0.0, 0.56 * (r - 0.5))) * thickness


def terrace(depth, overhang, seed: int):
    """Where a point of the mean slope goes, in a layer of cliff above slope.

    Returns
    -------
    rise : m, added to the height
    back : m of height of mean slope by which it lies farther back; over the slope (rise over run) it is metres
    thickness : m
    under : 0…1, how far below the brow of an overhang
    """
    k, low, thick, (_, hard, _, _) = layer_of(depth, LAYER, seed)
    q = (depth - low) / thick
    cliff = np.where(k == -1.0, 0.72, 0.35 + 0.5 * hard)  # of the height; the uppermost holds the rim
    part = 0.62 - 0.2 * cliff  # of the way that is slope
    s = np.clip((q - part) / (1.0 - part), 0.0, 1.0)
    rise = np.where(q < part, q / part * (1.0 - cliff), 1.0 - cliff + cliff * s)
    foot = 1.0 + overhang
    back = np.where(q < part, q / part * foot, 1.0 + overhang * (1.0 - s) ** 2)
    return (rise - q) * thick, (back - q) * thick, thick, np.where(q < part, q / part, 1.0 - s)


def hardness(depth, seed: int):
    """Of single beds, −1 soft … 1 hard, with a jump at the top of a bed and a slope at its foot; mean about 0."""
    _, low, thick, (_, hard, _, _) = layer_of(depth, BED, seed)
    q = (depth - low) / thick
    ledge = np.clip(q / 0.35, 0.0, 1.0) * np.clip((1.0 - q) / 0.12, 0.0, 1.0)
    return (2.0 * hard - 1.0) * ledge
