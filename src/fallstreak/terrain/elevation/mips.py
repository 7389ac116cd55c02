"""A grid at all its resolutions: coarse ones in memory, of finer ones the window in use."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..spline import coefficients, evaluate, halved
from .grid import ElevationGrid
from .raster import Span

_MARGIN = 16  # samples around a window: the spline's filter forgets by 0.27 per sample


@dataclass(frozen=True)
class _Patch:
    """Spline coefficients of part of a level, and where in the level its first one lies."""

    coefficients: np.ndarray
    row: int
    column: int

    def covers(self, rows: Span, columns: Span) -> bool:
        high, wide = self.coefficients.shape
        return (
            self.row <= rows[0]
            and self.column <= columns[0]
            and rows[1] <= self.row + high
            and columns[1] <= self.column + wide
        )


class Mips:
    """Heights of a grid by level; each level has half the samples of the one before in both directions.

    Levels of at most 2048² samples are kept. Of a finer one there is one window at a time: `prepare` reads
    it, and `evaluate` looks into it from any number of threads (what is not in it is read anew).

    Parameters
    ----------
    grid : ElevationGrid
    exaggeration : heights are multiplied by it
    """

    def __init__(self, grid: ElevationGrid, exaggeration: float = 1.0):
        self.grid, self.exaggeration = grid, exaggeration
        self.first = grid.overview.reduction
        """The finest level that is kept."""
        self.kept = [grid.overview.heights.astype(np.float64) * exaggeration]
        while min(self.kept[-1].shape) >= 16:
            self.kept.append(halved(self.kept[-1]))
        self._splines = [_Patch(coefficients(level), 0, 0) for level in self.kept]
        self._window: tuple[int, _Patch] | None = None

    @property
    def count(self) -> int:
        return self.first + len(self.kept)

    def prepare(self, level: int, column: np.ndarray, row: np.ndarray) -> None:
        """Read what `evaluate` will ask for between these samples (of level 0, fractional)."""
        if level < self.first and column.size:
            self._window = (level, self._read(level, *self._spans(level, column, row)))

    def evaluate(self, level: int, column: np.ndarray, row: np.ndarray) -> np.ndarray:
        """Heights of a level at fractional samples of level 0, m."""
        if not column.size:
            return np.zeros(column.shape)
        patch = self._splines[level - self.first] if level >= self.first else self._patch(level, column, row)
        scale = 0.5**level
        c, r = (column + 0.5) * scale - 0.5, (row + 0.5) * scale - 0.5
        return evaluate(patch.coefficients, c - patch.column, r - patch.row)

    def _patch(self, level: int, column: np.ndarray, row: np.ndarray) -> _Patch:
        spans = self._spans(level, column, row)
        window = self._window
        if window is not None and window[0] == level and window[1].covers(*spans):
            return window[1]
        return self._read(level, *spans)

    def _spans(self, level: int, column: np.ndarray, row: np.ndarray) -> tuple[Span, Span]:
        """Rows and columns of a level that splines at these samples depend on."""
        scale = 0.5**level
        spans = []
        for at, n in ((row, self.grid.shape[0] >> level), (column, self.grid.shape[1] >> level)):
            low, high = (float(x + 0.5) * scale - 0.5 for x in (at.min(), at.max()))
            first = int(np.clip(np.floor(low) - _MARGIN, 0, n - 1))
            spans.append((first, int(np.clip(np.ceil(high) + _MARGIN + 1, first + 1, n))))
        return spans[0], spans[1]

    def _read(self, level: int, rows: Span, columns: Span) -> _Patch:
        heights = self.grid.window(rows, columns, level).astype(np.float64) * self.exaggeration
        return _Patch(coefficients(heights), rows[0], columns[0])
