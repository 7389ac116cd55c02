"""Elevation models of different lattices, one over the other: the finer one counts, without a step anywhere.

All are resampled onto the lattice of the finest, from the coarsest up. At a place the finer heights are
reached by adding their *difference* from what lies below, weighted from 0 at the finer model's edge to 1
inside. In a hole of the finer model the difference is continued from around it (delta surface fill: Grohman,
Kroenung, Strebeck 2006), so there is no step at a hole either.
"""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np

from ...world.errors import WorldError
from .. import spline
from .checks import Axis
from .grid import ElevationGrid
from .raster import THREADS, Raster, Span, Window
from .voids import fill_voids

_SAME = 0.02  # samples: what rounding may do to an edge
_BLEND = 0.06  # of the smaller side: how far in from its edge a model reaches its full weight
_OUTSIDE = -0.5 - _SAME  # half a sample over the outermost centres still belongs to a model, as pixels do
_MARGIN = 12  # samples: the reach of a spline's filter (its pole is −0.27)
_WIDEST = 2**24  # samples across
_BAND = 64  # rows that are resampled at a time

Box = tuple[np.ndarray, np.ndarray]
"""Least and largest (x, y)."""


def overlaid(sheets: Sequence[ElevationGrid]) -> ElevationGrid:
    """One grid of several; WorldError where it would be monstrous.

    Parameters
    ----------
    sheets : sequence of ElevationGrid
        Of equally fine ones the first lies on top.
    """
    overlay = _Overlay(list(sheets))
    name = f"{overlay.sheets[-1].name} and {len(sheets) - 1} more"
    return ElevationGrid(overlay, overlay.x, overlay.y, overlay.crs, name)


@dataclass(frozen=True)
class _Layer:
    """What one sheet gives to a window: where, heights (holes filled), where they are known, its weight."""

    at: tuple[slice, slice]
    heights: np.ndarray
    known: np.ndarray
    weight: np.ndarray


class _Overlay(Raster):
    """Sheets of different lattices, the coarsest lowest."""

    def __init__(self, sheets: list[ElevationGrid]):
        fineness = [_degrees_apart(sheet) for sheet in sheets]
        order = sorted(range(len(sheets)), key=lambda i: (-fineness[i], -i))
        self.sheets = [sheets[i] for i in order]
        finest = self.sheets[-1]
        self.name = finest.raster.name
        alike = all(sheet.crs == finest.crs for sheet in sheets)
        self.crs = finest.crs if alike else "geographic"
        self.boxes = [_box(sheet, None if alike else finest) for sheet in self.sheets]
        self.x, self.y, self.shape = self._lattice(finest, alike)

    def _lattice(self, finest: ElevationGrid, alike: bool) -> tuple[Axis, Axis, tuple[int, int]]:
        """Of the finest sheet, over all of them; in degrees where their systems differ."""
        low, high = np.min([b[0] for b in self.boxes], 0), np.max([b[1] for b in self.boxes], 0)
        if alike:
            dx, dy = finest.x[1], finest.y[1]
            anchor = np.array([finest.x[0], finest.y[0]])
        else:
            middle = 0.5 * (low[1] + high[1])
            dy = -_degrees_apart(finest)
            dx = -dy / max(np.cos(np.radians(middle)), 0.05)
            anchor = np.array([low[0] + 0.5 * dx, high[1] + 0.5 * dy])
        step = np.array([dx, dy])
        ends = np.stack([(low - anchor) / step, (high - anchor) / step])
        first = np.ceil(ends.min(0) - _SAME).astype(int)
        count = np.floor(ends.max(0) + _SAME).astype(int) - first + 1
        if count.max() > _WIDEST:
            raise WorldError(
                f"{self.name} and the other files together would be {count[0]:,} × {count[1]:,} samples; "
                f"at most {_WIDEST:,} across are joined"
            )
        start = anchor + first * step
        return (float(start[0]), float(dx)), (float(start[1]), float(dy)), (int(count[1]), int(count[0]))

    def read(self, rows: Span, columns: Span, reduction: int = 0) -> Window:
        """See `Raster.read`; samples of the sheets' own levels stand for means of blocks."""
        block = 1 << reduction
        row, column = ((np.arange(*span) + 0.5) * block - 0.5 for span in (rows, columns))
        x, y = self.x[0] + self.x[1] * column, self.y[0] + self.y[1] * row
        heights = np.full((len(y), len(x)), np.nan, np.float32)
        weights = np.zeros(heights.shape, np.float32)
        unknown: dict[str, int] = {}
        for sheet, box in zip(self.sheets, self.boxes, strict=True):
            layer = self._layer(sheet, box, x, y, block, unknown)
            if layer is not None:
                _lay(layer, heights[layer.at], weights[layer.at])
        return Window(heights, unknown)

    def _layer(
        self,
        sheet: ElevationGrid,
        box: Box,
        x: np.ndarray,
        y: np.ndarray,
        block: int,
        unknown: dict[str, int],
    ) -> _Layer | None:
        at = _inside(y, box[0][1], box[1][1], self.y[1]), _inside(x, box[0][0], box[1][0], self.x[1])
        x, y = x[at[1]], y[at[0]]
        if not (len(x) and len(y)):
            return None
        ratio = block * _degrees_apart(self) / _degrees_apart(sheet)
        coarsest = int(np.log2(min(sheet.shape))) - 2
        reduction = int(np.clip(np.floor(np.log2(max(ratio, 1.0)) + 0.3), 0, coarsest))
        size = 1 << reduction
        spans = self._spans(sheet, x, y, size)
        window = sheet.raster.read(spans[0], spans[1], reduction)
        for name, count in window.unknown.items():
            unknown[name] = unknown.get(name, 0) + count
        hole = np.isnan(window.heights)
        if hole.all():
            return None
        any_hole = bool(hole.any())
        splines = spline.coefficients(fill_voids(window.heights, hole) if any_hole else window.heights)
        shape = (len(y), len(x))
        layer = _Layer(at, np.empty(shape, np.float32), np.empty(shape, bool), np.empty(shape, np.float32))
        high, wide = sheet.shape

        def resample(start: int) -> None:
            band = slice(start, start + _BAND)
            column, row = self._in_sheet(sheet, x, y[band])
            margin = np.minimum(np.minimum(column, wide - 1 - column), np.minimum(row, high - 1 - row))
            c, r = (column + 0.5) / size - 0.5 - spans[1][0], (row + 0.5) / size - 0.5 - spans[0][0]
            layer.heights[band] = spline.evaluate(splines, c, r)
            known = margin >= _OUTSIDE
            t = np.clip((margin + 0.5) / max(_BLEND * min(sheet.shape), 2.0), 0.0, 1.0)
            layer.weight[band] = np.where(known, np.maximum(t * t * (3.0 - 2.0 * t), 1e-6), 0.0)
            if any_hole:
                i, j = (
                    np.clip(np.rint(v), 0, n - 1).astype(int) for v, n in zip((r, c), hole.shape, strict=True)
                )
                known &= ~hole[i, j]
            layer.known[band] = known

        with ThreadPoolExecutor(THREADS) as pool:
            list(pool.map(resample, range(0, len(y), _BAND)))
        return layer

    def _spans(self, sheet: ElevationGrid, x: np.ndarray, y: np.ndarray, size: int) -> tuple[Span, Span]:
        """Rows and columns of a sheet's level that a window of the lattice depends on."""
        some = [v[np.unique(np.linspace(0, len(v) - 1, 65).astype(int))] for v in (x, y)]
        column, row = self._in_sheet(sheet, *some)
        spans = []
        for at, n in ((row, sheet.shape[0]), (column, sheet.shape[1])):
            # lines of the lattice are bent in the sheet, though hardly between neighbours among 65
            spare = _MARGIN + 2 + 0.01 * np.ptp(at) / size
            low, high = (np.clip(v, 0, n - 1) / size for v in (at.min(), at.max()))
            first = int(np.clip(low - spare, 0, (n // size) - 1))
            spans.append((first, int(np.clip(high + spare + 1, first + 1, n // size))))
        return spans[0], spans[1]

    def _in_sheet(self, sheet: ElevationGrid, x: np.ndarray, y: np.ndarray):
        """Fractional column and row of a sheet for positions of the joined lattice, both (rows, columns)."""
        x, y = np.meshgrid(x, y)
        if sheet.crs != self.crs:
            x, y = sheet.projected(y, x)  # the joined lattice is in degrees
        return (x - sheet.x[0]) / sheet.x[1], (y - sheet.y[0]) / sheet.y[1]


def _lay(layer: _Layer, heights: np.ndarray, weights: np.ndarray) -> None:
    """Lay a sheet over what is there; `heights` and `weights` are changed."""
    below = np.isfinite(heights)
    both = below & layer.known
    if both.any():
        difference = fill_voids(np.where(both, layer.heights - heights, 0.0), ~both)
        # What lies below loses its say towards its own edge, so that two models which overlap by a strip pass
        # into each other across it.
        share = layer.weight / np.maximum(layer.weight + (1.0 - layer.weight) * weights, 1e-9)
        np.copyto(heights, heights + share * difference, where=below & (layer.weight > 0.0))
    np.copyto(heights, layer.heights, where=~below & layer.known)
    weights += layer.weight * (1.0 - weights)


def _inside(positions: np.ndarray, low: float, high: float, step: float) -> slice:
    """The run of ascending or descending positions within bounds."""
    spare = abs(step) * _SAME
    found = np.flatnonzero((positions >= low - spare) & (positions <= high + spare))
    return slice(int(found[0]), int(found[-1]) + 1) if len(found) else slice(0, 0)


def _degrees_apart(grid: ElevationGrid | _Overlay) -> float:
    """Distance of neighbouring samples along the meridian, in degrees, at the middle of the grid."""
    step = abs(grid.y[1])
    if grid.crs == "metres" or isinstance(grid.crs, tuple):
        return step / 111_195.0
    if grid.crs == "mercator":
        middle = grid.y[0] + 0.5 * grid.y[1] * grid.shape[0]
        return step / np.cosh(np.radians(middle))
    return step


def _box(sheet: ElevationGrid, beside: ElevationGrid | None) -> Box:
    """Least and largest x and y of a sheet's edges, half a sample outside of the outermost centres.

    In degrees, on the turn of the sheet `beside`, where that is given.
    """
    high, wide = sheet.shape
    t = np.linspace(0.0, 1.0, 33)
    zero, one = np.zeros(33), np.ones(33)
    column = np.concatenate([t, t, zero, one]) * wide - 0.5
    row = np.concatenate([zero, one, t, t]) * high - 0.5
    x, y = sheet.x[0] + sheet.x[1] * column, sheet.y[0] + sheet.y[1] * row
    if beside is not None:
        y, x = sheet.geographic(x, y)
        _, middle = beside.geographic(
            beside.x[0] + 0.5 * beside.x[1] * beside.shape[1],
            beside.y[0] + 0.5 * beside.y[1] * beside.shape[0],
        )
        x = x - 360.0 * np.round((x.mean() - middle) / 360.0)
    return np.array([x.min(), y.min()]), np.array([x.max(), y.max()])
