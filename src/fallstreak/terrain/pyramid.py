"""Nested levels of heights around the anchor, what is derived from them, and bounds for every quadtree node.

Every level has 768² texels; level 0 is the finest, each next one covers twice the extent, the last one the
whole map of ±extent metres. Texel (column i, row j) of level k lies at map position ((i + ½) s_k − W_k / 2,
(j + ½) s_k − W_k / 2): rows run north. Heights are stored as cubic B-spline coefficients.
"""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from .spline import blur, coefficients

SIZE = 768
MAX_LEVELS = 6  # 6 · 768² · (4 + 8) bytes = 42 MB on the GPU
BOUND_LEVELS = (
    9  # quadtree levels 0..8 have bounds of their own (256² cells); finer nodes use their ancestor's
)
_FADE = (0.86, 0.97)  # of the extent: where the land sinks to the height of the globe
_RELIEF_SCALE = 700.0  # m: hills are what stands above the mean over this radius


class Land(Protocol):
    """What a source of heights gives: heights on a grid, its own spacing, and the height far away."""

    native: float
    outside: float

    def sample(self, east: np.ndarray, north: np.ndarray) -> np.ndarray: ...


@dataclass(frozen=True)
class Pyramid:
    """The levels, finest first.

    Attributes
    ----------
    extent : half the width of the last level, m
    spacing : of level 0, m
    coefficients : (levels, 768, 768) float32, B-spline coefficients of height, m
    surface : (levels, 768, 768, 4) float16: slope east, slope north, height above the surroundings / 100 m,
        hollowness −1..1 (positive in hollows, negative on crests)
    bounds : list of (2^q, 2^q, 2) float32, lowest and highest height in each node of quadtree level q, m
    outside : height of the globe beyond the extent, m
    """

    extent: float
    spacing: float
    coefficients: np.ndarray
    surface: np.ndarray
    bounds: list[np.ndarray]
    outside: float

    @property
    def levels(self) -> int:
        return len(self.coefficients)

    @property
    def nbytes(self) -> int:
        return self.coefficients.nbytes + self.surface.nbytes + sum(b.nbytes for b in self.bounds)


def axis(level_spacing: float, first: int = 0, last: int = SIZE) -> np.ndarray:
    """Map coordinates of the texel centres ``first`` to ``last`` − 1 of a level, m."""
    return (np.arange(first, last) + 0.5 - SIZE / 2) * level_spacing


def build(land: Land, extent: float, levels: int | None = None) -> Pyramid:
    """Sample a land into nested levels.

    Parameters
    ----------
    land : Land
    extent : m, how far from the anchor the ground is drawn as terrain
    levels : their number; by default enough for level 0 to be finer than the source, at most 6
    """
    coarsest = 2.0 * extent / SIZE
    if levels is None:
        levels = int(np.clip(np.ceil(np.log2(max(coarsest / (0.7 * land.native), 1.0))) + 1, 1, MAX_LEVELS))
    heights: list[np.ndarray] = []
    for level in range(levels):
        spacing = coarsest / 2 ** (levels - 1 - level)
        heights.append(_sample_level(land, spacing, heights[-1] if heights else None))
    for level, h in enumerate(heights):
        centres = axis(coarsest / 2 ** (levels - 1 - level))
        far = np.hypot(centres[None, :], centres[:, None]) / extent
        t = np.clip((far - _FADE[0]) / (_FADE[1] - _FADE[0]), 0.0, 1.0)
        h += (land.outside - h) * t * t * (3.0 - 2.0 * t)
    spacing0 = coarsest / 2 ** (levels - 1)
    splines = np.stack([coefficients(h) for h in heights])
    surface = np.stack(
        [_surface(h, c, spacing0 * 2**k) for k, (h, c) in enumerate(zip(heights, splines, strict=True))]
    )
    return Pyramid(extent, spacing0, splines.astype(np.float32), surface, _bounds(splines), land.outside)


def _sample_level(land: Land, spacing: float, finer: np.ndarray | None) -> np.ndarray:
    out = np.empty((SIZE, SIZE))
    if finer is None:
        parts = [(0, SIZE, 0, SIZE)]
    else:
        # The middle is the mean of the finer level; only the ring around it is new.
        a, b = SIZE // 4, 3 * SIZE // 4
        out[a:b, a:b] = finer.reshape(SIZE // 2, 2, SIZE // 2, 2).mean((1, 3))
        parts = [(0, a, 0, SIZE), (b, SIZE, 0, SIZE), (a, b, 0, a), (a, b, b, SIZE)]

    def fill(strip: tuple[int, int, int, int]) -> None:
        low, high, left, right = strip
        out[low:high, left:right] = land.sample(axis(spacing, left, right), axis(spacing, low, high))

    # Narrow strips stay in the processor's cache, and numpy lets threads work side by side.
    strips = [(i, i + 192, left, right) for low, high, left, right in parts for i in range(low, high, 192)]
    with ThreadPoolExecutor(min(os.cpu_count() or 1, 8)) as pool:
        list(pool.map(fill, strips))
    return out


def _surface(heights: np.ndarray, spline: np.ndarray, spacing: float) -> np.ndarray:
    padded = np.pad(spline, 1, mode="edge")
    # the spline's own derivative at the texel centres
    across = (padded[:, 2:] - padded[:, :-2]) / (2.0 * spacing)
    up = (padded[2:, :] - padded[:-2, :]) / (2.0 * spacing)
    slope_east = (across[:-2] + 4.0 * across[1:-1] + across[2:]) / 6.0
    slope_north = (up[:, :-2] + 4.0 * up[:, 1:-1] + up[:, 2:]) / 6.0
    relief = heights - blur(heights, _RELIEF_SCALE / spacing)
    near = blur(heights, max(120.0 / spacing, 0.7)) - heights
    hollow = np.clip(near / max(0.05 * spacing, 5.0), -1.0, 1.0)
    return np.stack([slope_east, slope_north, relief / 100.0, hollow], -1).astype(np.float16)


def _bounds(splines: np.ndarray) -> list[np.ndarray]:
    """Lowest and highest height of every node over all levels that cover it, with room for filters.

    A B-spline lies between the least and the largest of the coefficients it is made of, so these bounds are
    strict.
    """
    cells = 2 ** (BOUND_LEVELS - 1)
    low, high = np.full((cells, cells), np.inf), np.full((cells, cells), -np.inf)
    for age, h in enumerate(reversed(splines)):
        covered = min(cells >> age, cells)
        if covered == 0:
            break
        block = SIZE // covered
        lowest = h.reshape(covered, block, covered, block).min((1, 3))
        highest = h.reshape(covered, block, covered, block).max((1, 3))
        a = (cells - covered) // 2
        inner = (slice(a, a + covered),) * 2
        low[inner], high[inner] = np.minimum(low[inner], lowest), np.maximum(high[inner], highest)
    raw = [np.stack([low, high], -1)]
    while len(raw) < BOUND_LEVELS:
        raw.insert(0, _halved(raw[0]))
    # A node of level q is drawn from filtered heights that reach a few vertex steps over its edge:
    # dilate by a quarter of the node.
    out = []
    for q in range(BOUND_LEVELS):
        finer = min(q + 2, BOUND_LEVELS - 1)
        cell = _dilated(raw[finer])
        for _ in range(finer - q):
            cell = _halved(cell)
        out.append(cell.astype(np.float32))
    return out


def _halved(bounds: np.ndarray) -> np.ndarray:
    quarters = bounds.reshape(len(bounds) // 2, 2, len(bounds) // 2, 2, 2)
    return np.stack([quarters[..., 0].min((1, 3)), quarters[..., 1].max((1, 3))], -1)


def _dilated(bounds: np.ndarray) -> np.ndarray:
    padded = np.pad(bounds, ((1, 1), (1, 1), (0, 0)), mode="edge")
    n = len(bounds)
    shifts = [padded[i : i + n, j : j + n] for i in range(3) for j in range(3)]
    return np.stack([np.min([s[..., 0] for s in shifts], 0), np.max([s[..., 1] for s in shifts], 0)], -1)
