"""The resolutions of puffs: their sizes, how far each reaches, and where the camera is in its lattice.

Seven decades of sizes from 1 m to 1,000 km. A decade is a coarse step for the eye: the middle bucket of each
level is therefore filled with puffs a third (one over the square root of ten) as wide, which is as many as
in the other 26 buckets together. So there are thirteen sizes; everything below counts those.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, floor, sqrt

import numpy as np

from ...gpu import Struct

SIZES = tuple(10.0 ** (0.5 * i) for i in range(13))
"""m, side of a cell, which holds one puff; even ones are the seven resolutions."""

FADE = 0.3
"""The last part of a size's reach, over which the next takes over."""

FINER = 0.8
"""How much further sizes of 100 and 300 m reach, which show the shapes of clouds: at the cost of far ones."""

LEAST_DEPTH = 0.004
"""Optical depth of a puff that nobody sees: such sizes are left out, and the next reaches further in."""

SHEETS = (3e3, 10e3)
"""m, puffs that are large enough to hold sheets of clouds from wherever they are seen."""

SHEET_DEPTHS = (2.0, 24.0)
"""Optical depth of the patches in a sheet: of a single row of puffs."""

FLAT_ROWS = 2
"""Of up to so many rows of cells one above the other, blocks are 8 × 8 × 1 cells, else 4 × 4 × 4."""


FBM = (0.0, 1.0, 0.0, 0.0)
FIBRES = (0.0, 0.0, 0.0, 1.0)
"""Shares of the noise's channels, see `field.volume`."""

NEAR = 3.5
"""Puffs smaller than so many times the lumps of their clouds show these, larger ones patches of noise."""
NEAR_FLAT = 1.2
"""The same of the lumps' width, where clouds are one row of puffs."""


@dataclass(frozen=True)
class Slab:
    """Where a layer of clouds may have matter, and what is needed to keep its puffs in place.

    Attributes
    ----------
    low, high : float
        m above the sea.
    core : (float, float)
        m above the sea, between which nearly all of it is: where puffs lie that are as large as clouds.
    soft : float
        m, over which the bases set in.
    extinction : float
        1/m, of dense clouds.
    wind : (float, float)
        m/s, east and north.
    seed : int
    cover : float
        Part of the sky that its clouds cover.
    look : (float, float, float, float)
        Shares of the noise's channels in what frays its clouds.
    body : float
        m, half the size of its clouds' parts.
    across : float
        m, half the width of these: of sheets and fibres much more.
    along : (float, float)
        Along its clouds' fibres; the shorter, the longer these are.
    """

    low: float
    high: float
    extinction: float
    wind: tuple[float, float]
    seed: int
    core: tuple[float, float] | None = None
    soft: float = 50.0
    cover: float = 1.0
    look: tuple[float, float, float, float] = FBM
    body: float = 0.0
    across: float = 0.0
    along: tuple[float, float] = (1.0, 0.0)


@dataclass(frozen=True)
class Grid:
    """The puffs of one size in one layer, as a frame needs them.

    Attributes
    ----------
    layer, level : int
    cell : float
        m.
    low, high : float
        m above the sea.
    rows : int
        Cells one above the other from low to high.
    blocks : int
        Along a side of a bucket.
    reach : (float, float, float, float)
        m: puffs appear from the first to the second and are gone from the third to the fourth.
    """

    layer: int
    level: int
    cell: float
    low: float
    high: float
    rows: int
    blocks: int
    reach: tuple[float, float, float, float]

    @property
    def block(self) -> int:
        """Cells along a side of a block, horizontally."""
        return 8 if self.rows <= FLAT_ROWS else 4

    @property
    def bucket(self) -> float:
        """m, side of a bucket."""
        return self.blocks * self.block * self.cell


def reaches(fineness: float | np.ndarray) -> np.ndarray:
    """Distance at which each size ends, m, without regard to what can be seen.

    Sizes up to 3 m matter inside of clouds, where every direction is full of them and nothing is far: these
    are drawn to ten times their own size. Large ones lie in thin layers and are drawn further.

    Parameters
    ----------
    fineness : float or (...)
        Reach over size of large puffs: the reciprocal of the angle under which one is seen where it ends.

    Returns
    -------
    (13,) or (..., 13)
    """
    sizes = np.array(SIZES)
    decades = np.log10(sizes)
    t = np.clip((decades - 0.5) / 2.0, 0.0, 1.0)
    finer = 1.0 + FINER * np.exp(-(((decades - 2.25) / 0.8) ** 2))
    return sizes * (10.0 + (finer * np.asarray(fineness)[..., None] - 10.0) * t * t * (3.0 - 2.0 * t))


def fineness_of(
    slabs: tuple[Slab, ...], number: float, height: float, farthest: float, radius: float
) -> float:
    """How fine puffs may be so that about a number of them is in sight, wherever the camera is.

    Of a sphere of radius R, seen from R + h, the part between distances a and b has an area of
    ``pi R (b² - a²) / (R + h)``: so many columns of cells there are of each size. A picture shows about a
    fifth of what is around, from space more.

    Parameters
    ----------
    slabs : the layers
    number : puffs in sight
    height : m above the sea
    farthest : m, beyond which no clouds are drawn
    radius : m, of the planet
    """
    sizes = np.array(SIZES)
    ends = reaches(_FINENESS)
    # in the middle of its fading a size has half of the matter
    far = ends * (1.0 - 0.5 * FADE)
    near = np.concatenate([np.zeros((len(ends), 1)), far[:, :-1]], 1)
    total = np.zeros(len(ends))
    for slab in slabs:
        away = max(slab.low - height, height - slab.high, 0.0)
        horizon = _horizon(height, radius) + _horizon(slab.high, radius)
        most = min(farthest, horizon)
        low, high = slab.core or (slab.low, slab.high)
        rows = np.maximum(np.round((high - low) / sizes), 1.0)
        # small ones are in clouds or not, of large ones most hold a cloud; of thick clouds one sees the skin
        part = slab.cover * (0.36 + 0.4 * slab.cover**3)
        filled = part ** (1.0 / (1.0 + (0.6 * sizes / max(slab.body, 1.0)) ** 2))
        rows = np.minimum(rows, 8.0) * filled
        area = np.maximum(np.clip(far, away, most) ** 2 - np.clip(near, away, most) ** 2, 0.0)
        visible = sizes * slab.extinction > LEAST_DEPTH
        total += (area * (rows * visible / sizes**2)).sum(1) * np.pi * radius / (radius + max(height, 0.0))
    # from low down, from orbit, from where the whole planet is in the picture
    shown = np.interp(np.log10(max(height, 1.0)), [4.6, 5.6, 7.0], [0.2, 0.48, 1.0])
    return float(np.interp(np.log(number / shown), np.log(total + 1.0), _FINENESS))


def _horizon(height: float, radius: float) -> float:
    """Distance of the horizon from a height, m."""
    return sqrt(max(height, 0.0) * (2.0 * radius + max(height, 0.0)))


_FINENESS = np.geomspace(12.0, 250.0, 32)


def grids(slabs: tuple[Slab, ...], ends: np.ndarray, height: float, farthest: float) -> list[Grid]:
    """What is to be drawn from a height: sizes that reach no layer are not there and cost nothing.

    Parameters
    ----------
    slabs : the layers
    ends : (13,), m, see `reaches`
    height : m above the sea
    farthest : m, beyond which no clouds are drawn
    """
    found = []
    for layer, slab in enumerate(slabs):
        below = max(slab.low - height, height - slab.high, 0.0)
        least = LEAST_DEPTH / slab.extinction
        begins = 0.0
        for level, size in enumerate(SIZES):
            last = level == len(SIZES) - 1 or ends[level] >= farthest
            end = farthest if last else float(ends[level])
            if size < least and not last:
                continue
            if end > below:
                # the smallest vanish before the camera is inside of them
                appears = begins * (1.0 - FADE) if begins else 0.5 * size
                there = begins or 1.5 * size
                fades = end * (1.0 - (0.15 if last else FADE))
                low, high = slab.core or (slab.low, slab.high)
                if size < 0.67 * (high - low):
                    low, high = slab.low, slab.high
                rows = max(1, round((high - low) / size))
                block = 8 if rows <= FLAT_ROWS else 4
                blocks = ceil(end / (block * size))
                found.append(Grid(layer, level, size, low, high, rows, blocks, (appears, there, fades, end)))
            begins = end
            if last:
                break
    return found


def looks(slabs: tuple[Slab, ...]) -> list[tuple[float, float, float, float]]:
    """The noise of small and of large puffs, layer by layer; of the latter values must be spread evenly."""
    return [look for slab in slabs for look in (slab.look, FIBRES if slab.look[3] > 0.5 else FBM)]


def grid_struct(count: int) -> Struct:
    """What the shaders are told of up to `count` grids."""
    return Struct(
        "PuffGrids",
        [
            ("corner", f"array<vec4i, {count}>", "camera's cell (x, y); its bucket's first cell minus that"),
            ("place", f"array<vec4f, {count}>", "camera from its cell's corner (x, y), m; cell; row, m"),
            ("reach", f"array<vec4f, {count}>", "m: appears between (x, y), is gone between (z, w)"),
            ("slab", f"array<vec4f, {count}>", "m: lowest, highest matter; lowest bucket's floor; bucket"),
            ("noise", f"array<vec4f, {count}>", "camera in the noise, repeats; 1/m"),
            ("look", f"array<vec4f, {count}>", "1/m, of dense clouds; which noise; its long axis"),
            ("clip", f"array<vec4f, {count}>", "m, bases; 1/m, softness; height of puffs; how far rows vary"),
            ("sheet", f"array<vec4f, {count}>", "a sheet from wherever, from above; its depth; jitter"),
            ("near", f"array<vec4f, {count}>", "1: small, know their cloud's surface; hold whole clouds"),
            ("info", f"array<vec4u, {count}>", "layer; rows; blocks along a bucket's side; seed"),
            ("oblique", "mat3x3f", "axes of the noise"),
            ("planet", "vec4f", "visible to the horizon: camera's share of the way, m; radius, m; unused"),
        ],
    )  # fmt: skip


def _above(size: float, none: float, all_: float) -> float:
    """0 up to a size, 1 from another on, evenly by the logarithm between."""
    return float(np.clip(np.log(size / none) / np.log(all_ / none), 0.0, 1.0)) if none > 0.0 else 0.0


OBLIQUE = np.array(
    [[0.589788, 0.462624, 0.661913], [0.0, 0.819648, -0.572867], [-0.807558, 0.33787, 0.483419]]
)
"""Axes of the noise: level layers cut it at an angle, so that what they show of it does not repeat."""

NOISE_TILE = 7.0
"""Cells, after which the noise that frays puffs of a size repeats."""


def grid_values(
    slabs: tuple[Slab, ...],
    found: list[Grid],
    count: int,
    *,
    camera_map: tuple[float, float],
    camera: np.ndarray,
    height: float,
    time: float,
    radius: float,
) -> dict[str, np.ndarray]:
    """The fields of `grid_struct` for a frame, float64 until the last step.

    Parameters
    ----------
    camera_map : m, east and north
    camera : (3,), m, world coordinates
    height : m above the sea
    time : s
    radius : m, of the planet
    """
    out = {
        "corner": np.zeros((count, 4), np.int32),
        "place": np.zeros((count, 4)),
        "reach": np.zeros((count, 4)),
        "slab": np.zeros((count, 4)),
        "noise": np.zeros((count, 4)),
        "look": np.zeros((count, 4)),
        "clip": np.zeros((count, 4)),
        "sheet": np.zeros((count, 4)),
        "near": np.zeros((count, 4)),
        "info": np.zeros((count, 4), np.uint32),
    }
    for i, grid in enumerate(found):
        slab = slabs[grid.layer]
        # the lattice drifts with its layer
        drift = np.asarray(slab.wind) * time
        place = np.asarray(camera_map) - drift
        cell = np.floor(place / grid.cell)
        side = grid.blocks * grid.block
        corner = np.floor(cell / side) * side - cell
        out["corner"][i] = (*(int(c) for c in cell), *(int(c) for c in corner))
        out["place"][i] = (*(place - cell * grid.cell), grid.cell, (grid.high - grid.low) / grid.rows)
        out["reach"][i] = grid.reach
        out["slab"][i] = (grid.low, grid.high, (floor(height / grid.bucket) - 1) * grid.bucket, grid.bucket)
        # where puffs are as large as the spaces between clouds, noise shows clouds in patches, not fibres
        large = _above(grid.cell, 6.0 * slab.body, 24.0 * slab.body)
        tile = NOISE_TILE * grid.cell * (1.0 + 1.3 * large)
        along = np.asarray(slab.along)
        along = along * (max(0.5 / np.hypot(*along), 1.0)) ** large
        across = np.array([-along[1], along[0]]) / np.hypot(*along)
        still = camera[:2] - drift
        at = OBLIQUE @ np.array([still @ along, still @ across, camera[2]]) / tile
        out["noise"][i] = (*(at % 1.0), 1.0 / tile)
        small = grid.cell < max(NEAR * slab.body, NEAR_FLAT * slab.across if grid.rows == 1 else 0.0)
        out["near"][i] = small, _above(grid.cell, 2.0 * slab.body, 4.0 * slab.body), 0.0, 0.0
        out["look"][i] = (slab.extinction, 2 * grid.layer + (not small), *along)
        # a single row holds whole clouds, which have no common base
        lone = grid.rows == 1
        spread = max(slab.soft, 0.2 * out["place"][i, 3])
        base = slab.low - (10.0 if lone else 0.5) * spread
        out["clip"][i] = (base, 1.0 / spread, 0.9 if lone else 1.0, 0.5 if lone else 1.0)
        dense = float(np.clip(slab.extinction * (grid.high - grid.low), *SHEET_DEPTHS))
        sheet = (_above(grid.cell, *SHEETS), _above(grid.cell, 1e3, 3e3)) if lone else (0.0, 0.0)
        out["sheet"][i] = (*sheet, dense, 0.4 if small else 0.5 if lone else 0.8)
        seed = (slab.seed + 0x9E3779B9 * (grid.level + 1)) & 0xFFFFFFFF
        out["info"][i] = (grid.layer, grid.rows, grid.blocks, seed)
    out["oblique"] = OBLIQUE
    out["planet"] = np.array([_horizon(height, radius), radius, 0.0, 0.0])
    return out
