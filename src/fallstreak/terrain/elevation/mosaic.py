"""Several elevation models as one: the finer one counts, edges are blended, holes show what lies below.

Files whose samples lie on one lattice and that do not overlap beyond their rims (SRTM and Terrarium tiles,
cut-up GeoTIFFs) are put side by side as they are. What then remains is resampled onto the lattice of the
finest, from the coarsest up: at a place the finer heights are reached by adding their *difference* from what
lies below, weighted from 0 at the finer file's edge to 1 inside. In a hole of the finer file the difference
is continued from around it (delta surface fill: Grohman, Kroenung, Strebeck 2006), so there is no step at a
hole either.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ...world.errors import WorldError
from .. import spline
from .checks import Axis
from .grid import ElevationGrid
from .raster import Piece, Raster, Span, Window
from .voids import fill_voids

_SAME = 0.02  # samples: as far as lattices may be apart and count as one
_RIM = 2  # samples that neighbours may share
_BLEND = 0.06  # of the smaller side: how far in from its edge a file reaches its full weight
_OUTSIDE = -0.5 - _SAME  # half a sample over the outermost centres still belongs to a file, as pixels do
_MARGIN = 12  # samples: the reach of a spline's filter (its pole is −0.27)
_WIDEST = 2**24  # samples across the joined grid


def joined(grids: Sequence[ElevationGrid]) -> ElevationGrid:
    """One grid of several, on the lattice of the finest; WorldError where they cannot be compared."""
    systems = {grid.crs for grid in grids}
    if "metres" in systems and len(systems) > 1:
        one, other = (next(g for g in grids if (g.crs == "metres") is metres) for metres in (True, False))
        raise WorldError(
            f'{one.raster.name} has crs = "metres" and {other.raster.name} lies by latitude and longitude; '
            "files that are joined must all be of one of the two kinds"
        )
    sheets = _side_by_side([_turned(grid, grids[0]) for grid in grids])
    if len(sheets) == 1:
        return sheets[0]
    return _Overlay(sheets).grid()


def _turned(grid: ElevationGrid, beside: ElevationGrid) -> ElevationGrid:
    """The grid with its longitudes on the turn of another: 185 instead of -175, across the antimeridian."""
    if grid.crs not in ("geographic", "mercator") or beside.crs not in ("geographic", "mercator"):
        return grid
    apart = grid.x[0] + 0.5 * grid.x[1] * grid.shape[1] - beside.x[0] - 0.5 * beside.x[1] * beside.shape[1]
    return replace(grid, x=(grid.x[0] - 360.0 * round(apart / 360.0), grid.x[1]))


# ---- side by side ----


def _side_by_side(grids: list[ElevationGrid]) -> list[ElevationGrid]:
    """Grids of one lattice that only share rims become one; the others stay as they are, in their order."""
    groups: list[list[ElevationGrid]] = []
    lattices: dict[tuple, list[list[ElevationGrid]]] = {}
    for grid in grids:
        key = (grid.crs, *(round(1e7 * s) for s in (grid.x[1], grid.y[1])), *_coding(grid.raster))
        alike = lattices.setdefault(key, [])
        group = next((g for g in alike if _fits(g[0], grid)), None)
        if group is None:
            group = []
            alike.append(group)
            groups.append(group)
        group.append(grid)
    sheets: list[ElevationGrid] = []
    for group in groups:
        if len(group) == 1 or _overlapping(group):
            sheets += group
        else:
            sheets.append(_tiled(group))
    return sheets


def _coding(raster: Raster) -> tuple:
    return (raster.nodata, raster.scale, raster.offset)


def _offset(base: ElevationGrid, grid: ElevationGrid) -> tuple[float, float]:
    """Row and column of a grid's first sample on the lattice of another."""
    return (grid.y[0] - base.y[0]) / base.y[1], (grid.x[0] - base.x[0]) / base.x[1]


def _fits(base: ElevationGrid, grid: ElevationGrid) -> bool:
    return all(abs(at - round(at)) < _SAME for at in _offset(base, grid))


def _overlapping(group: list[ElevationGrid]) -> bool:
    boxes = np.array([[round(a) for a in _offset(group[0], g)] + list(g.shape) for g in group])
    low, high = boxes[:, :2], boxes[:, :2] + boxes[:, 2:]
    for i in range(len(boxes) - 1):
        shared = np.minimum(high[i], high[i + 1 :]) - np.maximum(low[i], low[i + 1 :])
        if (shared.min(1) > _RIM).any():
            return True
    return False


def _tiled(group: list[ElevationGrid]) -> ElevationGrid:
    at = np.array([[round(a) for a in _offset(group[0], g)] for g in group])
    first = at.min(0)
    at -= first
    shape = tuple(int(n) for n in (at + [g.shape for g in group]).max(0))
    base = group[0]
    x = (base.x[0] + base.x[1] * float(first[1]), base.x[1])
    y = (base.y[0] + base.y[1] * float(first[0]), base.y[1])
    name = base.name if len(group) == 1 else f"{base.name} and {len(group) - 1} more"
    return ElevationGrid(_Tiles([g.raster for g in group], at, shape), x, y, base.crs, name)


class _Tiles(Raster):
    """Rasters at whole rows and columns of one lattice; where rims overlap, their mean counts."""

    def __init__(self, rasters: list[Raster], at: np.ndarray, shape: tuple[int, ...]):
        self.rasters, self.at, self.shape = rasters, at, (shape[0], shape[1])
        self.name = rasters[0].name
        self.nodata, self.scale, self.offset = _coding(rasters[0])

    def pieces(self, rows: Span, columns: Span) -> Iterator[Piece]:
        for raster, (row, column) in zip(self.rasters, self.at.tolist(), strict=True):
            inner = [
                (max(span[0] - start, 0), min(span[1] - start, n))
                for span, start, n in ((rows, row, raster.shape[0]), (columns, column, raster.shape[1]))
            ]
            if all(stop > start for start, stop in inner):
                for piece in raster.pieces(*inner):
                    yield Piece(piece.row + row, piece.column + column, piece.load, piece.name)


# ---- one over the other ----


@dataclass(frozen=True)
class _Layer:
    """A sheet's contribution: heights filled in its holes, where they are known, and its weight."""

    heights: np.ndarray
    known: np.ndarray
    weight: np.ndarray


class _Overlay(Raster):
    """Sheets of different lattices, the coarsest lowest."""

    def __init__(self, sheets: list[ElevationGrid]):
        fineness = [_degrees_apart(sheet) for sheet in sheets]
        # of equally fine ones the first named lies on top
        order = sorted(range(len(sheets)), key=lambda i: (-fineness[i], -i))
        self.sheets = [sheets[i] for i in order]
        finest = self.sheets[-1]
        self.name = finest.raster.name
        alike = all(sheet.crs == finest.crs for sheet in sheets)
        self.crs = finest.crs if alike else "geographic"
        self.x, self.y, self.shape = self._lattice(finest, alike)

    def grid(self) -> ElevationGrid:
        name = f"{self.sheets[-1].name} and {len(self.sheets) - 1} more"
        return ElevationGrid(self, self.x, self.y, self.crs, name)

    def _lattice(self, finest: ElevationGrid, alike: bool) -> tuple[Axis, Axis, tuple[int, int]]:
        """Of the finest sheet, over all of them; in degrees where their systems differ."""
        boxes = [_border(sheet, None if alike else finest) for sheet in self.sheets]
        low, high = np.min([b[0] for b in boxes], 0), np.max([b[1] for b in boxes], 0)
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
        shape = (int(count[1]), int(count[0]))
        return (float(start[0]), float(dx)), (float(start[1]), float(dy)), shape

    def read(self, rows: Span, columns: Span, reduction: int = 0) -> Window:
        block = 1 << reduction
        row, column = ((np.arange(*span) + 0.5) * block - 0.5 for span in (rows, columns))
        x, y = self.x[0] + self.x[1] * column, self.y[0] + self.y[1] * row
        shape = (len(y), len(x))
        heights, weight = np.full(shape, np.nan), np.zeros(shape)
        unknown: dict[str, int] = {}
        for sheet in self.sheets:
            layer = self._layer(sheet, x, y, block, unknown)
            if layer is None:
                continue
            below = np.isfinite(heights)
            with np.errstate(invalid="ignore"):
                difference = layer.heights - heights
            both = below & layer.known
            if both.any():
                difference = fill_voids(np.where(both, difference, 0.0), ~both)
            else:
                difference = np.zeros(shape)
            # What lies below loses its say towards its own edge, so that two files which overlap by a strip
            # pass into each other across it.
            share = layer.weight / np.maximum(layer.weight + (1.0 - layer.weight) * weight, 1e-9)
            inside = layer.weight > 0.0
            blended = np.where(below & inside, heights + share * difference, heights)
            heights = np.where(~below & layer.known, layer.heights, blended)
            weight = layer.weight + (1.0 - layer.weight) * weight
        return Window(heights.astype(np.float32), unknown)

    def _layer(self, sheet: ElevationGrid, x, y, block: int, unknown: dict[str, int]) -> _Layer | None:
        column, row = self._in_sheet(sheet, x, y)
        high, wide = sheet.shape
        margin = np.minimum(np.minimum(column, wide - 1 - column), np.minimum(row, high - 1 - row))
        if not (margin >= _OUTSIDE).any():
            return None
        ratio = block * _degrees_apart(self) / _degrees_apart(sheet)
        # the longest steps decide: never coarser than what is asked for
        reduction = int(np.clip(np.floor(np.log2(max(ratio, 1.0)) + 0.3), 0, np.log2(min(sheet.shape)) - 2))
        size = 1 << reduction
        spans = []
        for at, n in ((row, high), (column, wide)):
            at = (at[margin >= _OUTSIDE] + 0.5) / size - 0.5
            spans.append(
                (
                    max(int(np.floor(at.min())) - _MARGIN, 0),
                    min(int(np.ceil(at.max())) + _MARGIN + 1, n >> reduction),
                )
            )
        window = sheet.raster.read(spans[0], spans[1], reduction)
        for name, count in window.unknown.items():
            unknown[name] = unknown.get(name, 0) + count
        hole = np.isnan(window.heights)
        if hole.all():
            return None
        filled = fill_voids(window.heights, hole) if hole.any() else window.heights
        c, r = (column + 0.5) / size - 0.5 - spans[1][0], (row + 0.5) / size - 0.5 - spans[0][0]
        heights = spline.evaluate(spline.coefficients(filled), c, r)
        known = margin >= _OUTSIDE
        if hole.any():
            i = np.clip(np.rint(r), 0, hole.shape[0] - 1).astype(int)
            j = np.clip(np.rint(c), 0, hole.shape[1] - 1).astype(int)
            known = known & ~hole[i, j]
        t = np.clip((margin + 0.5) / max(_BLEND * min(sheet.shape), 2.0), 0.0, 1.0)
        weight = np.where(margin >= _OUTSIDE, np.maximum(t * t * (3.0 - 2.0 * t), 1e-6), 0.0)
        return _Layer(heights, known, weight)

    def _in_sheet(self, sheet: ElevationGrid, x, y):
        """Fractional column and row of a sheet for positions of the joined lattice, both (rows, columns)."""
        x, y = np.meshgrid(x, y)
        if sheet.crs != self.crs:
            x, y = sheet.projected(y, x)  # the joined lattice is in degrees
        return (x - sheet.x[0]) / sheet.x[1], (y - sheet.y[0]) / sheet.y[1]


def _degrees_apart(grid: ElevationGrid | _Overlay) -> float:
    """Distance of neighbouring samples along the meridian, in degrees, at the middle of the grid."""
    step = abs(grid.y[1])
    if grid.crs == "metres" or isinstance(grid.crs, tuple):
        return step / 111_195.0
    if grid.crs == "mercator":
        middle = grid.y[0] + 0.5 * grid.y[1] * grid.shape[0]
        return step / np.cosh(np.radians(middle))
    return step


def _border(sheet: ElevationGrid, beside: ElevationGrid | None) -> tuple[np.ndarray, np.ndarray]:
    """Least and largest x and y of its edges, half a sample outside of the outermost centres.

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
