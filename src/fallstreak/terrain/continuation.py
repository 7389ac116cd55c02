"""Land beyond the edge of an elevation model, made from the model itself.

Tiling and blending by example (Heitz & Neyret 2018, "High-performance by-example noise using a histogram-
preserving blending operator"): the plane is cut into triangles; every lattice point carries a piece of the
model, turned by a random angle; in a triangle three pieces are mixed in a domain where heights are normally
distributed, with weights scaled so that the variance stays, and mapped back. The histogram of heights, the
relief and the roughness continue; there is no edge, no mirror, no period. Differences from the paper: weights
are sharpened, because superposed valleys are no valleys; a lattice point picks among several pieces the one
that suits the region, so that ranges continue from the edge and fade into ranges of their own; the model
itself joins as one more piece with weight 1 inside.
"""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import numpy as np

from ..noise.patterns import value as noise_at
from ..noise.scatter import hash_lattice
from .elevation import ElevationGrid, bilinear
from .elevation.coverage import room_around_holes
from .elevation.mips import Mips
from .elevation.raster import THREADS
from .spline import blur, coefficients, evaluate

_SHARPNESS = 3.0  # exponent of the triangle weights: 1 mixes everywhere, ∞ cuts
_CANDIDATES = 12  # pieces that a lattice point chooses from
_REGION = 45e3  # m, size of the invented ranges and lowlands
_TURN = np.radians(35.0)  # pieces turn by at most this: ranges keep the grain of the land
_MEMORY = 30e3  # m, how far the model's edge still rules what lies beyond
_ENOUGH = 400_000  # samples, to know their distribution
_MANY = 500_000  # samples that threads share
_REGIONS = 512  # samples across the picture of regions, at most
_JOIN = 0.08  # of the model's width: how far in from its edge it is itself alone


class FileLand:
    """Heights everywhere around a file: the file inside, its like outside and in holes too wide to be filled.

    Of a large file the fine levels are read by windows (`Mips`); inventing draws on a copy of at most 2048²
    samples.

    Parameters
    ----------
    grid : ElevationGrid
    place : (latitude, longitude) of the anchor, degrees
    radius : planet radius, m
    surroundings : "continue", "flat" or "sea"
    seed : int
    exaggeration : heights are multiplied by it
    """

    def __init__(
        self,
        grid: ElevationGrid,
        place,
        radius: float,
        surroundings: str,
        seed: int,
        exaggeration: float = 1.0,
    ):
        self.grid, self.place, self.radius, self.seed = grid, place, radius, seed
        self.surroundings = surroundings
        self.mips = Mips(grid, exaggeration)
        heights = self.mips.kept[0]
        rows, columns = grid.shape
        self.native = grid.spacing(place, radius)
        e, n = grid.map_position(
            np.array([0.0, columns - 1, 0.0]), np.array([0.0, 0.0, rows - 1]), place, radius
        )
        # metres per column and row, and the turn of the grid against east-north, at the first corner
        self.pitch = (
            np.hypot(e[1] - e[0], n[1] - n[0]) / (columns - 1),
            np.hypot(e[2] - e[0], n[2] - n[0]) / (rows - 1),
        )
        self.size = min(self.pitch[0] * columns, self.pitch[1] * rows)
        self.join = _JOIN * self.size
        known = grid.overview.known
        self._holes = None
        if known is not None:
            pitch = max(self.pitch) * 2**self.mips.first
            self._holes = room_around_holes(known, self.join / pitch)
        self.mean = float(heights.mean())
        edge = np.concatenate([heights[0], heights[-1], heights[:, 0], heights[:, -1]])
        self.outside = {"continue": self.mean, "flat": float(edge.mean()), "sea": 0.0}[surroundings]
        if surroundings == "continue":
            self._prepare(heights)

    def sample(self, east: np.ndarray, north: np.ndarray) -> np.ndarray:
        """Heights (m) on the grid of two ascending, evenly spaced axes, (len(north), len(east)) float64."""
        level = self._level(float(east[1] - east[0]))
        e, n = np.meshgrid(east, north)
        column, row = self.grid.pixels(e, n, self.place, self.radius)
        inside = self._inside_weight(column, row)
        if inside.min() == 1.0:  # the file alone, as everywhere near the anchor of a large one
            return self.mips.evaluate(level, column, row)
        out = np.empty(e.shape)
        known, open_land = inside > 0.0, inside < 1.0
        file = self.mips.evaluate(level, column[known], row[known])
        if self.surroundings != "continue":
            out[...] = self.outside
            out[known] += inside[known] * (file - self.outside)
            return out
        out[known] = file
        if not open_land.any():
            return out
        g, square = self._invent(e[open_land], n[open_land], level)
        w = inside[open_land]
        own = np.zeros_like(w)
        own[w > 0.0] = self._normal(out[open_land & known])
        mixed = (w * own + (1.0 - w) * g) / np.sqrt(w * w + (1.0 - w) ** 2 * square)
        out[open_land] = np.interp(mixed, self._scores, self._quantiles)
        return out

    def prepare(self, spacing: float, reach: float) -> None:
        """Read what `sample` will ask for at this spacing within ±`reach` of the anchor, m."""
        across = np.linspace(-reach, reach, 65)
        column, row = self.grid.pixels(*np.meshgrid(across, across), self.place, self.radius)
        # straight lines of the map are bent in the file, but hardly between neighbours among 65
        spare = np.abs(np.diff(column, axis=1)).max(), np.abs(np.diff(row, axis=0)).max()
        rows, columns = self.grid.shape
        inside = (
            (column > -spare[0]) & (column < columns + spare[0]) & (row > -spare[1]) & (row < rows + spare[1])
        )
        if inside.any():
            column, row = np.clip(column[inside], 0, columns - 1), np.clip(row[inside], 0, rows - 1)
            wide, high = 0.02 * np.ptp(column), 0.02 * np.ptp(row)
            self.mips.prepare(
                self._level(spacing),
                np.clip([column.min() - wide, column.max() + wide], 0, columns - 1),
                np.clip([row.min() - high, row.max() + high], 0, rows - 1),
            )

    def _level(self, spacing: float) -> int:
        """The level of the file for samples so far apart."""
        level = np.floor(np.log2(max(spacing / self.native, 1e-9)) + 0.3)
        return int(np.clip(level, 0, self.mips.count - 1))

    def _inside_weight(self, column, row):
        rows, columns = self.grid.shape
        margin = np.minimum(
            np.minimum(column, columns - 1 - column) * self.pitch[0],
            np.minimum(row, rows - 1 - row) * self.pitch[1],
        )
        if self._holes is not None:
            room, step = self._holes
            size = 2**self.mips.first * step
            away = bilinear(room, (column + 0.5) / size - 0.5, (row + 0.5) / size - 0.5)
            margin = np.minimum(margin, away * 2**self.mips.first * min(self.pitch))
        t = np.clip(margin / self.join, 0.0, 1.0)
        return t * t * (3.0 - 2.0 * t)

    # ---- the invented part ----

    def _prepare(self, heights: np.ndarray) -> None:
        probability = (np.arange(1024) + 0.5) / 1024
        known = self.grid.overview.known
        some = heights if known is None else heights[known]
        self._quantiles = np.quantile(np.sort(some.ravel()[:: 1 + some.size // _ENOUGH]), probability)
        # strictly increasing, so that a plain (all one height) can be mapped there and back
        self._quantiles += np.arange(1024) * 1e-6
        x = np.linspace(-6.0, 6.0, 24001)
        cumulative = np.cumsum(np.exp(-0.5 * x * x))
        self._scores = np.interp(probability, cumulative / cumulative[-1], x)
        normal = self._normal(heights)
        self._normal_levels = [coefficients(normal), *(self._normal(level) for level in self.mips.kept[1:])]
        self.edge = 0.24 * self.size  # of the triangles
        # what a region is like at large: a coarse level will do
        step = -(-max(normal.shape) // _REGIONS)
        self._region_level = self.mips.first, step
        radius = 0.5 * self.edge / (self.native * 2**self.mips.first * step)
        self._region = blur(normal[::step, ::step], radius)
        self._region_spread = max(float(self._region.std()), 1e-3)
        # pieces of what was filled in are none
        known = self.grid.overview.known
        self._unsuited = 0.0 * self._region if known is None else 20.0 * blur(~known[::step, ::step], radius)
        self._pieces: dict[tuple[int, int], tuple[float, float, float, float]] = {}

    def _normal(self, heights):
        if heights.size < _MANY:
            return np.interp(heights, self._quantiles, self._scores)
        with ThreadPoolExecutor(THREADS) as pool:
            parts = np.array_split(heights, 2 * THREADS)
            return np.concatenate(
                list(pool.map(lambda x: np.interp(x, self._quantiles, self._scores), parts))
            )

    def _invent(self, east, north, level):
        """Sum of the three pieces in the normal domain, and the sum of the squared weights."""
        # the lattice of triangles in skewed coordinates
        v = north / (self.edge * np.sqrt(0.75))
        u = east / self.edge - 0.5 * v
        iu, iv = np.floor(u), np.floor(v)
        fu, fv = u - iu, v - iv
        upper = fu + fv > 1.0
        corners = (
            (iu + upper, iv + upper, np.where(upper, fu + fv - 1.0, 1.0 - fu - fv)),
            (iu + 1.0, iv, np.where(upper, 1.0 - fv, fu)),
            (iu, iv + 1.0, np.where(upper, 1.0 - fu, fv)),
        )
        raw = [w**_SHARPNESS for _, _, w in corners]
        total = sum(raw)
        value, square = np.zeros(east.shape), np.zeros(east.shape)
        level = max(level, self.mips.first)
        scale = 0.5**level
        low = int(min(c[0].min() for c in corners)), int(min(c[1].min() for c in corners))
        high = int(max(c[0].max() for c in corners)), int(max(c[1].max() for c in corners))
        table = self._piece_table(low, high)
        for (ku, kv, _), w in zip(corners, raw, strict=True):
            w = w / total
            piece = table[(kv - low[1]).astype(int), (ku - low[0]).astype(int)]
            de = east - (ku + 0.5 * kv) * self.edge
            dn = north - kv * self.edge * np.sqrt(0.75)
            column = piece[..., 0] + (piece[..., 2] * de - piece[..., 3] * dn) / self.pitch[0]
            row = piece[..., 1] + (piece[..., 3] * de + piece[..., 2] * dn) / self.pitch[1]
            value += w * self._piece(level, (column + 0.5) * scale - 0.5, (row + 0.5) * scale - 0.5)
            square += w * w
        return value, square

    def _piece(self, level, column, row):
        # Far out, where texels are coarser than the model's samples, straight lines between them will do.
        kept = level - self.mips.first
        if kept:
            return bilinear(self._normal_levels[kept], column, row)
        return evaluate(self._normal_levels[0], column, row)

    def _piece_table(self, low, high) -> np.ndarray:
        """For every lattice point: its piece's centre (column, row) and the cosine and sine of its turn."""
        ku, kv = np.meshgrid(np.arange(low[0], high[0] + 1), np.arange(low[1], high[1] + 1))
        rows, columns = self.grid.shape
        east = (ku + 0.5 * kv) * self.edge
        north = kv * self.edge * np.sqrt(0.75)
        # what the region should be like: the model's nearest edge, fading into noise
        column, row = self.grid.pixels(east, north, self.place, self.radius)
        c, r = np.clip(column, 0, columns - 1), np.clip(row, 0, rows - 1)
        outside = np.hypot((column - c) * self.pitch[0], (row - r) * self.pitch[1])
        memory = np.exp(-outside / _MEMORY)
        noise = 4.0 * noise_at(east / _REGION, north / _REGION, self.seed + 17) * self._region_spread
        wanted = memory * self._at(self._region, c, r) + np.sqrt(1.0 - memory**2) * noise
        margin_c = min(self.edge / self.pitch[0], 0.5 * columns - 1.0)
        margin_r = min(self.edge / self.pitch[1], 0.5 * rows - 1.0)
        best = np.full(ku.shape, np.inf)
        table = np.zeros((*ku.shape, 4))
        for candidate in range(_CANDIDATES):
            h = hash_lattice(ku, kv, self.seed * 31 + candidate)
            c = margin_c + (h & np.uint32(0xFFFF)) / 65536.0 * (columns - 1 - 2.0 * margin_c)
            r = margin_r + (h >> np.uint32(16)) / 65536.0 * (rows - 1 - 2.0 * margin_r)
            misfit = np.abs(self._at(self._region, c, r) - wanted) + self._at(self._unsuited, c, r)
            angle = (hash_lattice(ku, kv, self.seed * 31 + 1000 + candidate) / 2.0**32 - 0.5) * 2.0 * _TURN
            better = misfit < best
            best = np.where(better, misfit, best)
            table[better] = np.stack([c, r, np.cos(angle), np.sin(angle)], -1)[better]
        return table

    def _at(self, kept: np.ndarray, column, row):
        """Values of the regions' picture by samples of the file."""
        first, step = self._region_level
        i, j = ((x.astype(int) >> first) // step for x in (row, column))
        return kept[np.minimum(i, kept.shape[0] - 1), np.minimum(j, kept.shape[1] - 1)]
