"""Baking the textures of the sprites from noise: heaps, soft lumps, veils, fibres, grains.

A texture is a relief seen from the front: bubbles at several sizes (cells, the nearer to the middle of one
the thicker), waves, or strands drawn out by the wind. Slopes and thickness are the relief's own; opacity is
what is left of a ball when the relief is taken from it, so that its rim is torn the way the relief runs.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path

import numpy as np

from ... import noise
from .textures import COUNT, SIDE, apart, together

STEEPEST = 10.6
"""Rise of thickness per width of the texture that slopes can hold."""
_FINE = 2  # baked so many times finer, then averaged
_SPREAD = 0.17  # standard deviation of thickness
_TORN = 1.0  # how deep the relief eats into the ball


@dataclass(frozen=True)
class Recipe:
    """One texture: what it is called, its relief, and how many times finer than its own width that is."""

    kind: str
    relief: Callable[[np.ndarray, np.ndarray, int, float], np.ndarray]
    frequency: float


def _heaps(u: np.ndarray, v: np.ndarray, seed: int, frequency: float) -> np.ndarray:
    """Bubbles on bubbles, pushed about a little."""
    push = [0.12 / frequency * noise.fbm((u, v), 3, seed=seed + k, frequency=2 * frequency) for k in (71, 72)]
    total = np.zeros_like(u)
    for octave in range(4):
        scale = frequency * 2.1**octave
        away = noise.sample((u + push[0], v + push[1]), "cellular_f1", seed=seed + octave, frequency=scale)
        total += 0.42**octave * (1.0 - np.minimum(away.astype(float), 1.2) ** 2)
    return total


def _lumps(u: np.ndarray, v: np.ndarray, seed: int, frequency: float) -> np.ndarray:
    """Soft waves with some bubbles in them."""
    waves = noise.fbm((u, v), 5, seed=seed, frequency=frequency, gain=0.48).astype(float)
    return waves + 0.25 * _heaps(u, v, seed + 9, 2.0 * frequency)


def _veil(u: np.ndarray, v: np.ndarray, seed: int, frequency: float) -> np.ndarray:
    """Hardly anything."""
    return noise.warp((u, v), 0.3, 5, seed=seed, frequency=frequency, gain=0.42).astype(float)


def _fibres(u: np.ndarray, v: np.ndarray, seed: int, frequency: float) -> np.ndarray:
    """Strands along u that wave and fray."""
    sway = 0.16 * noise.fbm((u, v), 2, seed=seed + 5, frequency=1.3).astype(float)
    strands = noise.fbm((0.16 * u, v + sway), 5, seed=seed, frequency=frequency, gain=0.6).astype(float)
    gaps = noise.fbm((u, v), 3, seed=seed + 6, frequency=2.5).astype(float)
    return strands + 0.5 * gaps


RECIPES = (
    *(Recipe("heaps", _heaps, f) for f in (2.4, 3.0, 3.8, 4.8)),
    *(Recipe("lumps", _lumps, f) for f in (3.0, 3.6, 4.4, 5.2)),
    *(Recipe("veil", _veil, f) for f in (2.2, 2.8)),
    *(Recipe("fibres", _fibres, f) for f in (7.0, 9.0, 11.0, 14.0)),
    *(Recipe("grains", _heaps, f) for f in (7.0, 9.5)),
)
"""By the numbers that cloud models name: 0-3 heaps, 4-7 lumps, 8-9 veils, 10-13 fibres, 14-15 grains."""


def bake() -> np.ndarray:
    """All textures, (16, SIDE, SIDE, 4) uint8, as `textures.sheet` has them."""
    return np.stack([_texture(index) for index in range(COUNT)])


def write(path: Path) -> int:
    """Bake the sheet into a PNG; the same Pillow and numpy write the same bytes. Returns how many."""
    from PIL import Image

    Image.fromarray(together(bake())).save(path, "PNG", optimize=True)
    return path.stat().st_size


def listed(path: Path) -> list[tuple[int, str, float, int]]:
    """Of each texture in a sheet's file: number, kind, mean opacity (0 to 1), bytes as a PNG of its own."""
    from PIL import Image

    with Image.open(path) as picture:
        textures = apart(np.asarray(picture.convert("RGBA")))
    rows = []
    for number, (recipe, texture) in enumerate(zip(RECIPES, textures, strict=True)):
        alone = BytesIO()
        Image.fromarray(texture).save(alone, "PNG", optimize=True)
        rows.append((number, recipe.kind, float(texture[..., 3].mean()) / 255.0, alone.tell()))
    return rows


def _texture(index: int) -> np.ndarray:
    recipe = RECIPES[index]
    across = (np.arange(SIDE * _FINE) + 0.5) / (SIDE * _FINE)
    u, v = np.meshgrid(across, across[::-1])
    relief = recipe.relief(u, v, 300 + 17 * index, recipe.frequency)
    x, y = 2.0 * u - 1.0, 2.0 * v - 1.0
    r2 = x * x + y * y
    # thickness keeps to the disc: its corners are never seen
    middle, spread = relief[r2 < 1.0].mean(), relief[r2 < 1.0].std()
    thick = 0.5 + _SPREAD * (relief - middle) / spread
    opacity = _smoothstep(0.0, 0.6, 1.12 - r2 - _TORN * (1.0 - np.clip(thick, 0.0, 1.0)))
    opacity *= _smoothstep(0.0, 0.08, 1.0 - np.sqrt(r2))  # nothing reaches the rim
    thick, opacity = _halved(thick), _halved(opacity)
    down, right = np.gradient(thick, 1.0 / SIDE)
    planes = [0.5 - 0.5 * right / STEEPEST, 0.5 + 0.5 * down / STEEPEST, thick, opacity]
    return np.round(255.0 * np.clip(np.stack(planes, -1), 0.0, 1.0)).astype(np.uint8)


def _halved(values: np.ndarray) -> np.ndarray:
    return values.reshape(SIDE, _FINE, SIDE, _FINE).mean((1, 3))


def _smoothstep(low: float, high: float, value: np.ndarray) -> np.ndarray:
    t = np.clip((value - low) / (high - low), 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t)
