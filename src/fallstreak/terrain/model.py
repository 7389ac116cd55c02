"""The ground on the CPU, float64: the height that the GPU draws, and what the passes are built from."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from importlib.resources import as_file, files
from pathlib import Path
from typing import Any

import numpy as np

from ..noise import patterns
from ..world.errors import WorldError
from . import spline
from .continuation import FileLand
from .elevation import ElevationGrid, read_elevation
from .fractal import FractalLand
from .pyramid import SIZE, Pyramid, build

SHIPPED = ("jacksboro",)

# heights.wesl and bumps.wesl
BORDER = (0.8, 0.95)
COARSEST, FINEST_DRAWN = 7, 2
LEAF_DEPTH = 14  # of the quadtree
SEED = 101  # added to the world's seed for the bumps


@dataclass(frozen=True)
class TerrainModel:
    """Everything that is known about the ground of a world.

    Attributes
    ----------
    pyramid : Pyramid or None
        None where the world has no terrain (the bare sphere).
    radius : planet radius, m
    seed : int
    """

    pyramid: Pyramid | None
    radius: float
    seed: int

    def height(self, east: Any, north: Any, bumps: bool = True) -> Any:
        """Height above sea level, m.

        Parameters
        ----------
        east, north : numbers or arrays that broadcast together, metres on the map
        bumps : bool
            With the small bumps that are drawn near the camera (wavelengths 128 to 4 m).

        Returns
        -------
        float or float64 array of the broadcast shape
        """
        return self.height_and_slope(east, north, bumps)[0]

    def height_and_slope(self, east: Any, north: Any, bumps: bool = True, step: Any = 0.0):
        """Height (m) and its derivatives towards east and north.

        Parameters
        ----------
        east, north, bumps : as for `height`
        step : number or array, m
            Distance between the vertices of the mesh: heights are filtered for it, as the GPU does. 0: as
            fine as is known.

        Returns
        -------
        tuple of three float64 arrays of the broadcast shape
        """
        e, n, step = np.broadcast_arrays(np.asarray(east, np.float64), north, step)
        shape = e.shape
        if self.pyramid is None:
            return tuple(np.zeros(shape)[()] for _ in range(3))
        e, n, step = e.ravel(), n.ravel().astype(np.float64), step.ravel().astype(np.float64)
        pyramid = self.pyramid
        wanted = np.log2(np.maximum(step, 1e-6) / pyramid.spacing)
        level = np.clip(np.maximum(covering_level(pyramid, e, n), wanted), 0.0, pyramid.levels - 1.0)
        out = np.zeros((3, len(e)))
        for k in range(pyramid.levels):
            weight = np.clip(1.0 - np.abs(level - k), 0.0, 1.0)
            here = weight > 0.0
            if here.any():
                spacing = pyramid.spacing * 2**k
                column, row = (x[here] / spacing + (SIZE / 2 - 0.5) for x in (e, n))
                value, dx, dy = spline.evaluate_with_slopes(pyramid.coefficients[k], column, row)
                out[:, here] += weight[here] * np.stack([value, dx / spacing, dy / spacing])
        if bumps:
            roughness = roughness_of_slope(np.hypot(out[1], out[2])) * land_weight(pyramid, e, n)
            for power in range(first_octave(pyramid.spacing), FINEST_DRAWN - 1, -1):
                scale = 2.0**power
                part = roughness * np.clip(2.0 - 4.0 * step / scale, 0.0, 1.0)
                value, dx, dy = patterns.slope(e / scale, n / scale, self.seed + SEED + power + 16)
                out += part * np.stack([value * scale, dx, dy])
        return tuple(row.reshape(shape)[()] for row in out)

    def drawn_height(self, east: Any, north: Any, step: Any) -> Any:
        """Height of a vertex of the mesh, m: past the map's edge it dives under the globe."""
        assert self.pyramid is not None
        dive = 0.1 * np.maximum(np.hypot(east, north) - 0.985 * self.pyramid.extent, 0.0)
        return self.height_and_slope(east, north, step=step)[0] - dive


def covering_level(pyramid: Pyramid, east, north):
    """The finest level that covers a place, as a real number (twin of heights.wesl)."""
    reach = np.maximum(np.abs(east), np.abs(north)) / (0.5 * SIZE * pyramid.spacing * BORDER[1])
    level = np.maximum(np.ceil(np.log2(np.maximum(reach, 1e-6))), 0.0)
    t = np.clip((reach * 2.0**-level * BORDER[1] - BORDER[0]) / (BORDER[1] - BORDER[0]), 0.0, 1.0)
    return level + t * t * (3.0 - 2.0 * t)


def roughness_of_slope(slope):
    """Amplitude over wavelength of the bumps (twin of bumps.wesl)."""
    t = np.clip((slope - 0.05) / 0.55, 0.0, 1.0)
    return 0.012 + 0.038 * t * t * (3.0 - 2.0 * t)


def land_weight(pyramid: Pyramid, east, north):
    """1 on the land, 0 where it has sunk to the globe at the edge of the map (twin of bumps.wesl)."""
    return np.clip(10.0 - 10.0 * np.hypot(east, north) / (0.97 * pyramid.extent), 0.0, 1.0)


def first_octave(spacing: float) -> int:
    """The coarsest bump: what the levels cannot hold, at most 128 m."""
    return int(min(COARSEST, np.floor(np.log2(1.5 * spacing))))


def shipped_path(name: str) -> Path:
    """Path of a shipped elevation model; WorldError for an unknown name."""
    if name not in SHIPPED:
        raise WorldError(
            f'terrain.file is "{name[:60]}"; allowed are the shipped '
            f"models ({', '.join(SHIPPED)}) or a path to a .npz or .tif"
        )
    with as_file(files("fallstreak.terrain") / "data" / f"{name}.npz") as path:
        return path


def terrain_model(world: Any) -> TerrainModel:
    """The ground of a world; kept for the worlds asked last, because building it takes seconds."""
    t = world.terrain
    key = (
        t.source,
        str(t.path) if t.path else t.file,
        t.path.stat().st_mtime_ns if t.path and t.path.is_file() else 0,
        t.material,
        t.extent,
        t.surroundings,
        t.vertical_exaggeration,
        (t.base_height, t.relief, t.feature_size, t.roughness, t.octaves) if t.source == "fractal" else None,
        (world.place.latitude, world.place.longitude),
        world.planet.radius,
        world.seed,
    )
    return _build(key)


@lru_cache(maxsize=4)
def _build(key: tuple) -> TerrainModel:
    source, file, _, material, extent, surroundings, exaggeration, fractal, place, radius, seed = key
    if source == "none":
        return TerrainModel(None, radius, seed)
    if source == "fractal":
        land = FractalLand(
            *fractal, exaggeration=exaggeration, seed=seed, extent=extent, dry=material == "mars"
        )
    else:
        path = Path(file) if Path(file).suffix else shipped_path(file)
        grid = read_elevation(path)
        _check_near(grid, place, radius, extent)
        land = FileLand(grid, place, radius, surroundings, seed, exaggeration)
    return TerrainModel(build(land, extent), radius, seed)


def _check_near(grid: ElevationGrid, place, radius: float, extent: float) -> None:
    rows, columns = grid.heights.shape
    c, r = np.meshgrid(np.linspace(0, columns - 1, 9), np.linspace(0, rows - 1, 9))
    east, north = grid.map_position(c.ravel(), r.ravel(), place, radius)
    nearest = float(np.hypot(east, north).min())
    if nearest > extent:
        raise WorldError(
            f"{grid.name}: the elevations lie {nearest / 1e3:,.0f} km from place (latitude {place[0]:g}, "
            f"longitude {place[1]:g}), beyond terrain.extent of {extent / 1e3:g} km: "
            "set place to a point in the file"
        )


def height_query(world: Any, east: Any, north: Any) -> Any:
    """`world.terrain.height(east, north)`: metres above sea level with bumps, see `TerrainModel.height`."""
    out = terrain_model(world).height(east, north)
    return float(out) if np.ndim(out) == 0 else out
