"""Heights that know where on the planet they lie, read as coarsely and as narrowly as they are needed."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from ...world.errors import WorldError
from ..projection import (
    geographic_from_map,
    geographic_from_mercator,
    geographic_from_utm,
    map_from_geographic,
    mercator_from_geographic,
    utm_from_geographic,
)
from .raster import Raster, Span
from .voids import bilinear, fill_voids

OVERVIEW = 2048  # samples: a copy of the whole, no larger, stays in memory


@dataclass(frozen=True)
class Overview:
    """The whole of a grid, coarse enough to be kept.

    Attributes
    ----------
    heights : (rows, columns) float32, m, means of blocks of 2^reduction samples square; no unknowns
    reduction : int
    known : (rows, columns) bool; None where the file knew all of them
    unknown : for each file's name, how many of its samples hold no height
    """

    heights: np.ndarray
    reduction: int
    known: np.ndarray | None
    unknown: dict[str, int]


@dataclass(frozen=True)
class ElevationGrid:
    """Heights on a regular grid.

    Attributes
    ----------
    raster : Raster
    x, y : position of the first sample's centre and the step to the next: (start, step); y's step is negative
        when the first row is the northern one
    crs : "geographic" (degrees), "metres" (east and north of the anchor), "mercator" (longitude in degrees
        and as many along a meridian, as in web maps) or ("utm", zone, south)
    name : for messages
    """

    raster: Raster
    x: tuple[float, float]
    y: tuple[float, float]
    crs: Any
    name: str

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        return self.raster.shape

    @cached_property
    def overview(self) -> Overview:
        """The whole grid at no more than 2048² samples; the first use reads all of the file once."""
        reduction = max(int(np.ceil(np.log2(max(self.shape) / OVERVIEW))), 0)
        rows, columns = (max(n >> reduction, 1) for n in self.shape)
        window = self.raster.read((0, rows), (0, columns), reduction)
        hole = np.isnan(window.heights)
        if hole.all():
            raise WorldError(f"{self.raster.name} holds no height between -12 and 30 km")
        if not hole.any():
            return Overview(window.heights, reduction, None, window.unknown)
        return Overview(fill_voids(window.heights, hole), reduction, ~hole, window.unknown)

    @property
    def heights(self) -> np.ndarray:
        """All samples, (rows, columns) float32, m, without unknowns: for files that fit into memory."""
        return self.window((0, self.shape[0]), (0, self.shape[1]), 0)

    def window(self, rows: Span, columns: Span, reduction: int) -> np.ndarray:
        """Means of blocks of 2^reduction samples square, unknown ones filled.

        Parameters
        ----------
        rows, columns : Span
            In blocks; inside the grid.

        Returns
        -------
        (rows, columns) float32, m
        """
        overview = self.overview
        if reduction == overview.reduction:
            return overview.heights[slice(*rows), slice(*columns)]
        heights = self.raster.read(rows, columns, reduction).heights
        hole = np.isnan(heights)
        if not hole.any():
            return heights
        if overview.reduction == 0:
            return fill_voids(heights, hole)
        # A hole may reach beyond the window. What is known of it at large is in the overview; what differs
        # from that around the hole continues into it (Grohman, Kroenung, Strebeck 2006, "Filling SRTM voids:
        # the delta surface fill method").
        scale = 2.0 ** (reduction - overview.reduction)
        r, c = ((np.arange(*span) + 0.5) * scale - 0.5 for span in (rows, columns))
        base = bilinear(overview.heights, c[None, :], r[:, None])
        return (base + fill_voids(heights - base, hole)).astype(np.float32)

    def pixels(self, east, north, place, radius: float):
        """Map coordinates (m) → fractional column and row; sample centres are whole numbers."""
        if self.crs == "metres":
            x, y = east, north
        else:
            x, y = self.projected(*geographic_from_map(east, north, place, radius))
        return (x - self.x[0]) / self.x[1], (y - self.y[0]) / self.y[1]

    def projected(self, latitude, longitude):
        """Degrees → x and y of the grid's own system."""
        if isinstance(self.crs, tuple):
            return utm_from_geographic(latitude, longitude, *self.crs[1:])
        # one meridian may be written 275 or -85: take the turn nearest to the file's middle
        middle = self.x[0] + 0.5 * self.x[1] * self.shape[1]
        x = longitude - 360.0 * np.round((longitude - middle) / 360.0)
        return x, mercator_from_geographic(latitude) if self.crs == "mercator" else latitude

    def geographic(self, x, y):
        """x and y of the grid's own system → latitude, longitude in degrees."""
        if isinstance(self.crs, tuple):
            return geographic_from_utm(x, y, *self.crs[1:])
        return (geographic_from_mercator(y) if self.crs == "mercator" else y), x

    def map_position(self, column, row, place, radius: float):
        """Fractional column and row → (east, north) on the map, m."""
        x, y = self.x[0] + self.x[1] * np.asarray(column), self.y[0] + self.y[1] * np.asarray(row)
        return (x, y) if self.crs == "metres" else map_from_geographic(*self.geographic(x, y), place, radius)

    def spacing(self, place, radius: float) -> float:
        """Distance between samples at the grid's middle, m (geometric mean of both directions)."""
        rows, columns = self.shape
        c, r = 0.5 * (columns - 1), 0.5 * (rows - 1)
        e, n = self.map_position(np.array([c, c + 1, c]), np.array([r, r, r + 1]), place, radius)
        with np.errstate(over="ignore", invalid="ignore"):  # of files that make no sense
            return float(np.sqrt(abs((e[1] - e[0]) * (n[2] - n[0]) - (n[1] - n[0]) * (e[2] - e[0]))))
