"""The field's noise with its gradient: what eats at sprites and puffs also bends their normals."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .field import volume

STEEPEST = 16.0
"""Gradient, per repeat, that is kept at most."""


def grain(looks: Sequence[tuple[float, float, float, float]]) -> np.ndarray:
    """The noise of layers, one above the other, each with a texel of its other end below and above it.

    Parameters
    ----------
    looks : sequence of 4 floats
        Of each layer, shares of the channels of `field.volume`.

    Returns
    -------
    (66 n, 64, 64, 4) uint8
        Axes z, y, x; gradient along x, y, z (128: level), value.
    """
    parts = []
    for look in looks:
        value = volume.volume() @ np.asarray(look) / 255.0
        slopes = [
            0.5 * volume.SIZE * (np.roll(value, -1, axis) - np.roll(value, 1, axis)) for axis in (2, 1, 0)
        ]
        coded = np.stack([*(0.5 + 0.5 * s / STEEPEST for s in slopes), value], -1)
        made = np.round(255.0 * np.clip(coded, 0.0, 1.0)).astype(np.uint8)
        parts += [made[-1:], made, made[:1]]
    return np.concatenate(parts)
