"""The ground on the CPU, float64: the height that the GPU draws, and what the passes are built from."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from importlib import import_module
from importlib.resources import as_file, files
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np

from ..world.errors import WorldError
from ..world.terrain import is_path
from .continuation import FileLand
from .elevation import ElevationGrid, read_elevation
from .fractal import FractalLand
from .land.levels import Levels
from .land.shape import LandModel, LandShape, land_values
from .pyramid import build
from .quick import quicken

SHIPPED = ("jacksboro",)
LANDS = {"canyons": "Canyons", "alpine": "Alpine", "plains": "Plains", "dunes": "Dunes"}
"""Kinds of land made from noise at every sample: module and class in ``land/``."""

FINER = {"canyons": (1.8, 3.0), "alpine": (1.9, 1.9)}
"""Land so rugged that its mesh has to be so much finer for the same error on the screen: samples closer than
`COARSE`, and the others. Walls of canyons are smooth up to the size of their layers."""
COARSE = 8.0  # m

LARGE = 8 << 20  # bytes of elevation files: above, compiled loops save more than loading them takes
SEED = 101  # added to the world's seed for all noise of the ground
SINK = (0.86, 0.97)  # of the extent: where the land sinks to the globe (shape_pass.wesl)
FINEST = 0.25  # m, the step of `height`: finer than the clipmap's finest samples


@dataclass(frozen=True)
class TerrainModel:
    """Everything that is known about the ground of a world.

    Attributes
    ----------
    land : LandModel or None
        None where the world has no terrain (the bare sphere).
    radius : planet radius, m
    extent : m, half the width of the map
    island : bool
        The sea begins where the elevation file ends.
    finer : (float, float)
        Edges of its mesh are shorter by this than those of smooth land: where samples are closer than
        `COARSE`, and farther off.
    """

    land: LandModel | None
    radius: float
    extent: float
    island: bool = False
    finer: tuple[float, float] = (1.0, 1.0)

    def shape(self, east: Any, north: Any, step: Any = FINEST) -> LandShape:
        """The land at places of the map as samples `step` metres apart hold it; arrays broadcast."""
        assert self.land is not None
        east, north = np.asarray(east, np.float64), np.asarray(north, np.float64)
        found = self.land.shape(east, north, step)
        t = np.clip((np.hypot(east, north) / self.extent - SINK[0]) / (SINK[1] - SINK[0]), 0.0, 1.0)
        sunk = t * t * (3.0 - 2.0 * t)
        outside = self.land.outside
        drained = 0.0 if self.island else sunk
        return LandShape(
            found.height + (outside - found.height) * sunk,
            found.water + (outside - 10.0 - found.water) * drained,
            found.shift_east * (1.0 - sunk),
            found.shift_north * (1.0 - sunk),
            found.lost,
            found.open,
        )

    def height(self, east: Any, north: Any) -> Any:
        """Height of what one stands or floats on above sea level: the ground, or water that lies over it, m.

        Parameters
        ----------
        east, north : numbers or arrays that broadcast together, metres on the map

        Returns
        -------
        float or float64 array of the broadcast shape
        """
        e, n = np.broadcast_arrays(np.asarray(east, np.float64), np.asarray(north, np.float64))
        if self.land is None:
            return np.zeros(e.shape)[()]
        found = self.shape(e, n)
        return np.maximum(found.height, found.water)[()]


def shipped_path(name: str) -> Path:
    """Path of a shipped elevation model; WorldError for an unknown name."""
    if name not in SHIPPED:
        raise WorldError(
            f'terrain.file is "{name[:60]}"; allowed are the shipped '
            f"models ({', '.join(SHIPPED)}) and paths, which hold a dot or a slash"
        )
    with as_file(files("fallstreak.terrain") / "data" / f"{name}.npz") as path:
        return path


def elevation_paths(terrain: Any) -> tuple[Path, ...]:
    """The elevation files of a world's terrain, shipped ones too, in the order named."""
    return tuple(
        path
        for name, found in zip(terrain.names, terrain.found, strict=True)
        for path in (found if is_path(name) else (shipped_path(name),))
    )


def terrain_model(world: Any) -> TerrainModel:
    """The ground of a world; kept for the worlds asked last, because building it takes seconds."""
    t = world.terrain
    paths = elevation_paths(t) if t.source == "file" else ()
    key = (
        t.source,
        paths,
        t.stamps if paths else (),
        t.material,
        t.extent,
        t.surroundings,
        t.vertical_exaggeration,
        t.octaves,
        tuple(sorted(land_values(t).items())),
        (world.place.latitude, world.place.longitude),
        world.planet.radius,
        world.seed,
    )
    return _build(key)


@lru_cache(maxsize=4)
def _build(key: tuple) -> TerrainModel:
    source, paths, _, material, extent, surroundings, exaggeration, octaves, values, place, radius, seed = key
    if source == "none":
        return TerrainModel(None, radius, extent)
    land = SimpleNamespace(**dict(values))
    ground = (seed + SEED) & 0xFFFFFFFF
    if source in LANDS:
        kind = getattr(import_module(f"fallstreak.terrain.land.{source}"), LANDS[source])
        return TerrainModel(kind(land, ground), radius, extent, finer=FINER.get(source, (1.0, 1.0)))
    if source == "fractal":
        base, relief = (x / max(exaggeration, 1e-9) for x in (land.base_height, land.relief))
        heights = FractalLand(
            base,
            relief,
            land.feature_size,
            land.roughness,
            octaves,
            exaggeration=exaggeration,
            seed=seed,
            extent=extent,
            dry=material == "mars",
        )
    else:
        if sum(path.stat().st_size for path in paths if path.is_file()) > LARGE:
            quicken()
        grid = read_elevation(paths)
        _check_near(grid, place, radius, extent)
        heights = FileLand(grid, place, radius, surroundings, seed, exaggeration)
    island = source == "file" and surroundings == "sea"
    level = 0.3 if island else land.water_level
    return TerrainModel(Levels(build(heights, extent), extent, ground, level), radius, extent, island)


_FINEST_FILE, _COARSEST_FILE = 0.01, 1e6  # m between samples


def _check_near(grid: ElevationGrid, place, radius: float, extent: float) -> None:
    rows, columns = grid.shape
    c, r = np.meshgrid(np.linspace(0, columns - 1, 9), np.linspace(0, rows - 1, 9))
    column, row = grid.pixels(0.0, 0.0, place, radius)
    c, r = np.append(c, np.clip(column, 0, columns - 1)), np.append(r, np.clip(row, 0, rows - 1))
    east, north = grid.map_position(c, r, place, radius)
    nearest = float(np.hypot(east, north).min())
    if nearest > extent:
        raise WorldError(
            f"{grid.name}: the elevations lie {nearest / 1e3:,.0f} km from place (latitude {place[0]:g}, "
            f"longitude {place[1]:g}), beyond terrain.extent of {extent / 1e3:g} km: "
            "set place to a point in the file"
        )
    spacing = grid.spacing(place, radius)
    if not _FINEST_FILE <= spacing <= _COARSEST_FILE:
        raise WorldError(
            f"{grid.name}: its samples are {spacing:.3g} m apart; "
            f"allowed are {_FINEST_FILE:g} m to {_COARSEST_FILE / 1e3:g} km"
        )
