"""Nested levels of heights around the anchor, and how steep the land is that each of them leaves out.

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

from .elevation import bilinear
from .quick import loops
from .spline import blur, coefficients, halved

SIZE = 768
_THREADS = min(os.cpu_count() or 1, 8)
MAX_LEVELS = 6  # 6 · 768² · (4 + 4) bytes = 28 MB on the GPU


class Land(Protocol):
    """What a source of heights gives: heights on a grid, its own spacing, and the height far away."""

    native: float
    outside: float

    def prepare(self, spacing: float, reach: float) -> None: ...

    def sample(self, east: np.ndarray, north: np.ndarray) -> np.ndarray: ...


@dataclass(frozen=True)
class Pyramid:
    """The levels, finest first.

    Attributes
    ----------
    extent : half the width of the last level, m
    spacing : of level 0, m
    coefficients : (levels, 768, 768) float32, B-spline coefficients of height, m
    lost : (levels, 768, 768) float32, rise over run, root mean square, of what is finer than the texels
    outside : height of the globe beyond the extent, m
    """

    extent: float
    spacing: float
    coefficients: np.ndarray
    lost: np.ndarray
    outside: float

    @property
    def levels(self) -> int:
        return len(self.coefficients)

    @property
    def nbytes(self) -> int:
        return self.coefficients.nbytes + self.lost.nbytes

    @property
    def lowest(self) -> float:
        """A B-spline lies between the least and the largest of its coefficients."""
        return float(self.coefficients.min())

    @property
    def highest(self) -> float:
        return float(self.coefficients.max())

    def lost_at(self, level: int, column: np.ndarray, row: np.ndarray) -> np.ndarray:
        """`lost` of a level at fractional texels."""
        return bilinear(self.lost[level], column, row)


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
    with ThreadPoolExecutor(_THREADS) as pool:
        splines = list(pool.map(coefficients, heights))
    del heights
    spacing0 = coarsest / 2 ** (levels - 1)
    lost = _lost(splines, spacing0)
    return Pyramid(
        extent, spacing0, np.stack(splines, dtype=np.float32, casting="same_kind"), lost, land.outside
    )


def _sample_level(land: Land, spacing: float, finer: np.ndarray | None) -> np.ndarray:
    out = np.empty((SIZE, SIZE))
    land.prepare(spacing, 0.5 * SIZE * spacing)
    if finer is None:
        parts = [(0, SIZE, 0, SIZE)]
    else:
        # The middle is the mean of the finer level; only the ring around it is new.
        a, b = SIZE // 4, 3 * SIZE // 4
        out[a:b, a:b] = halved(finer)
        parts = [(0, a, 0, SIZE), (b, SIZE, 0, SIZE), (a, b, 0, a), (a, b, b, SIZE)]

    def fill(strip: tuple[int, int, int, int]) -> None:
        low, high, left, right = strip
        out[low:high, left:right] = land.sample(axis(spacing, left, right), axis(spacing, low, high))

    # Narrow strips stay in the processor's cache, and numpy lets threads work side by side.
    strips = [(i, i + 192, left, right) for low, high, left, right in parts for i in range(low, high, 192)]
    with ThreadPoolExecutor(_THREADS) as pool:
        list(pool.map(fill, strips))
    return out


def _lost(splines: list[np.ndarray], spacing0: float) -> np.ndarray:
    """What the slopes of finer levels have more than those of a level, where finer ones exist; elsewhere as
    much of the slopes about as there."""
    out = np.zeros((len(splines), SIZE, SIZE), np.float32)
    middle = (slice(SIZE // 4, 3 * SIZE // 4),) * 2

    def slopes(k: int) -> tuple[np.ndarray, np.ndarray]:
        square = _slope_square(splines[k], spacing0 * 2**k)
        return square, blur(square, 4.0) if k else square

    with ThreadPoolExecutor(_THREADS) as pool:
        finer = None
        for lost, (square, about) in zip(out, pool.map(slopes, range(len(splines))), strict=True):
            if finer is not None:
                left = halved(finer)
                left -= square[middle]
                np.maximum(left, 0.0, out=left)
                about *= left.mean() / max(about[middle].mean(), 1e-9)
                about[middle] = left
                square += about
                np.sqrt(about, out=lost)
            finer = square
    return out


def _slope_square(spline: np.ndarray, spacing: float) -> np.ndarray:
    # the spline's own derivative at the texel centres
    quick = loops()
    if quick is not None:
        out = np.empty_like(spline)
        quick.slope_square(spline, spacing, out)
        return out
    padded = np.pad(spline, 1, mode="edge")
    across = (padded[:, 2:] - padded[:, :-2]) / (2.0 * spacing)
    up = (padded[2:, :] - padded[:-2, :]) / (2.0 * spacing)
    slope_east = (across[:-2] + 4.0 * across[1:-1] + across[2:]) / 6.0
    slope_north = (up[:, :-2] + 4.0 * up[:, 1:-1] + up[:, 2:]) / 6.0
    return slope_east**2 + slope_north**2
