"""Sprites in boxes: where each is, how large and with which texture, by chance but always the same."""

from __future__ import annotations

import zlib

import numpy as np

from .tables import ModelFile


def sown(
    name: str, table: ModelFile, boxes: np.ndarray, dtype: np.dtype, swell: float
) -> tuple[np.ndarray, int]:
    """Sprites of all boxes, and how many were culled for being closer to one before them than allowed.

    The first sprite of a box is the box's whole ellipsoid, the others are smaller and lie under its surface,
    spread evenly (a spiral of Fibonacci numbers about the ball, shaken). A sprite whose ellipsoid lies inside
    another box's for the most part would never be seen and is not sown.
    """
    rng = np.random.default_rng(zlib.crc32(name.encode()))
    shared = table.sprites
    rows: list[tuple[np.ndarray, int, int, int, float]] = []
    culled = 0
    for index, box in enumerate(table.boxes):
        count = shared.per_box if box.sprites is None else box.sprites
        spacing = shared.spacing if box.spacing is None else box.spacing
        textures = box.textures or shared.textures
        directions = _around(max(count - 1, 0), rng)
        for place in range(count):
            size = 1.0 if place == 0 else float(rng.uniform(*shared.size))
            unit = np.zeros(3) if place == 0 else directions[place - 1] * (1.04 - 0.85 * size)
            centre = _out(boxes[index], unit, swell)
            texture, chance = int(rng.choice(textures)), int(rng.integers(256))
            hidden = place > 0 and (centre[2] < 0.0 or _buried(boxes, index, centre, swell))
            near = any(np.linalg.norm(centre - row[0]) < spacing for row in rows) if spacing > 0.0 else False
            if near or hidden:
                culled += 1
                continue
            rows.append((centre, index, texture, chance, size))
    sprites = np.zeros(len(rows), dtype)
    for row, values in zip(sprites, rows, strict=True):
        row["centre"], row["box"], row["texture"], row["chance"], row["size"] = values
    return sprites, culled


def _around(count: int, rng: np.random.Generator) -> np.ndarray:
    """Unit vectors, (count, 3), spread over the sphere."""
    k = np.arange(count) + 0.5
    z = 1.0 - 2.0 * k / max(count, 1) + rng.normal(0.0, 0.12, count)
    z = np.clip(z, -0.95, 0.98)
    turn = np.pi * (1.0 + 5.0**0.5) * k + rng.uniform(0.0, 2.0 * np.pi) + rng.normal(0.0, 0.3, count)
    flat = np.sqrt(1.0 - z * z)
    return np.stack([flat * np.cos(turn), flat * np.sin(turn), z], -1)


def _out(box: np.ndarray, unit: np.ndarray, swell: float) -> np.ndarray:
    """From a box's unit ball to the model's metres."""
    x, y, z = unit * box["half"] * swell
    c, s = box["cosine"], box["sine"]
    return np.array([c * x - s * y, s * x + c * y, z]) + box["centre"]


def _buried(boxes: np.ndarray, own: int, point: np.ndarray, swell: float) -> bool:
    """Whether a point lies deep in another box."""
    away = point - boxes["centre"]
    c, s = boxes["cosine"], boxes["sine"]
    local = np.stack([c * away[:, 0] + s * away[:, 1], c * away[:, 1] - s * away[:, 0], away[:, 2]], -1)
    q2 = ((local / (boxes["half"] * swell)) ** 2).sum(-1)
    q2[own] = 9.0
    return bool((q2 < 0.35).any())
