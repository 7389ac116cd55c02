"""Several elevation models as one.

Files whose samples lie on one lattice and that do not overlap beyond their rims (SRTM and Terrarium tiles,
cut-up GeoTIFFs) are put side by side as they are; what then remains is laid one over the other (`overlay`).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from ...world.errors import WorldError
from .grid import ElevationGrid
from .overlay import overlaid
from .raster import Piece, Raster, Span

_SAME = 0.02  # samples: as far as lattices may be apart and count as one
_RIM = 2  # samples that neighbours may share


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
    return overlaid(sheets)


def _turned(grid: ElevationGrid, beside: ElevationGrid) -> ElevationGrid:
    """The grid with its longitudes on the turn of another: 185 instead of -175, across the antimeridian."""
    if grid.crs not in ("geographic", "mercator") or beside.crs not in ("geographic", "mercator"):
        return grid
    apart = grid.x[0] + 0.5 * grid.x[1] * grid.shape[1] - beside.x[0] - 0.5 * beside.x[1] * beside.shape[1]
    return replace(grid, x=(grid.x[0] - 360.0 * round(apart / 360.0), grid.x[1]))


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
