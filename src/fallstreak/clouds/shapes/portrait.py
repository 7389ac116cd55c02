"""Pictures of cloud models, without a GPU: what their boxes make, before noise eats at it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .model import SWELL, CloudModel

SIDE = 240
"""Pixels along a side of a view."""
_CELLS = 96
_SURFACE = 0.25  # of the field
_LIGHT = np.array([-0.5, -0.6, 0.625]) / np.linalg.norm([-0.5, -0.6, 0.625])


def portrait(models: Sequence[CloudModel]) -> np.ndarray:
    """Each model in a row: from the south, from the west and from above, (rows, columns) uint8."""
    return np.concatenate([_views(model) for model in models])


def field(model: CloudModel, x: np.ndarray, y: np.ndarray, z: np.ndarray) -> np.ndarray:
    """The field of a model's boxes at places of its own metres, without noise; the surface lies at .25."""
    total = np.zeros(np.broadcast_shapes(x.shape, y.shape, z.shape), np.float32)
    for box in model.boxes:
        dx, dy, dz = (a - c for a, c in zip((x, y, z), box["centre"], strict=True))
        c, s = box["cosine"], box["sine"]
        half = box["half"] * SWELL
        q = ((c * dx + s * dy) / half[0]) ** 2 + ((c * dy - s * dx) / half[1]) ** 2 + (dz / half[2]) ** 2
        total += box["density"] * np.where(q < 2.0, (1.0 - 0.5 * q) ** 2, 0.0)
    return np.where(z < 0.0, 0.0, total)


def _views(model: CloudModel) -> np.ndarray:
    wide = 1.1 * model.radius
    high = max(1.1 * model.height, wide)
    across = np.linspace(-wide, wide, _CELLS, dtype=np.float32)
    up = np.linspace(-0.1 * high, high, _CELLS, dtype=np.float32)
    values = field(model, across[:, None, None], across[None, :, None], up[None, None, :])
    slopes = np.stack(
        [np.gradient(values, at, axis=axis) for axis, at in enumerate((across, across, up))], -1
    )
    outward = -slopes / np.maximum(np.linalg.norm(slopes, axis=-1, keepdims=True), 1e-9)
    bright = 0.25 + 0.75 * np.clip(outward @ _LIGHT, 0.0, 1.0)
    solid = values > _SURFACE
    south = _front(bright, solid, 1)
    west = _front(bright, solid, 0)[::-1]  # north is on the left of who looks east
    above = _front(bright[:, :, ::-1], solid[:, :, ::-1], 2)
    tall = round(SIDE * high * 1.1 / (2.0 * wide))
    rows = max(tall, SIDE)
    sheet = np.zeros((rows, 3 * SIDE), np.uint8)
    for place, (view, height) in enumerate(((south, tall), (west, tall), (above, SIDE))):
        i = np.arange(height) * _CELLS // height
        j = np.arange(SIDE) * _CELLS // SIDE
        picture = np.round(255.0 * view.T[::-1]).astype(np.uint8)
        sheet[rows - height :, place * SIDE : (place + 1) * SIDE] = picture[i[:, None], j]
    return sheet


def _front(bright: np.ndarray, solid: np.ndarray, axis: int) -> np.ndarray:
    """What is met first along an axis; 0 where nothing is."""
    first = np.expand_dims(solid.argmax(axis), axis)
    return np.take_along_axis(bright, first, axis).squeeze(axis) * solid.any(axis)
