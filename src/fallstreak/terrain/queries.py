"""What `world.terrain` answers: heights, normals, slopes, materials, rays; all vectorised, float64."""

from __future__ import annotations

from functools import lru_cache
from importlib import import_module
from typing import Any

import numpy as np

from ..world.errors import WorldError
from .above import Above
from .cover.cover import Sites
from .model import SEED, TerrainModel, terrain_model
from .projection import map_from_world, world_from_map
from .ray import Hits, Surface, cast

DETAIL = 1.0  # m between the samples that slopes and materials are told from
_COARSE = 3  # 4 m: the patches in which the highest of several sheets of an overhang is looked for


@lru_cache(maxsize=4)
def surface_of(model: TerrainModel) -> Surface:
    """The drawn ground of a model, with the patches that were asked for."""
    return Surface(model)


@lru_cache(maxsize=4)
def above_of(model: TerrainModel) -> Above:
    """The highest ground of a model, with the squares that were asked for."""
    return Above(model)


def height(world: Any, east: Any, north: Any) -> Any:
    """Highest ground or water over places, m above sea level; see `world.terrain.height`."""
    model = terrain_model(world)
    e, n = _places(east, north)
    if model.land is None or model.land.shift_bound == 0.0:
        out = model.height(e, n)
    else:
        out = above_of(model).height(float(e), float(n)) if e.ndim == 0 else None
        if out is None:
            out = _from_above(model, e, n)[0]
    return float(out) if np.ndim(out) == 0 else out


def normal(world: Any, east: Any, north: Any) -> np.ndarray:
    """Unit normals of ground or water in world axes, (..., 3); see `world.terrain.normal`."""
    model = terrain_model(world)
    e, n = _places(east, north)
    if model.land is None:
        return _upright(model, e, n)
    if model.land.shift_bound > 0.0:
        return _from_above(model, e, n)[1]
    surface, half = surface_of(model), 0.5 * DETAIL
    p = surface.points(np.stack([e + half, e - half, e, e]), np.stack([n, n, n + half, n - half]), DETAIL)
    out = np.cross(p[0] - p[1], p[2] - p[3])
    return out / np.linalg.norm(out, axis=-1, keepdims=True)


def slope(world: Any, east: Any, north: Any) -> Any:
    """Rise over run of ground or water; see `world.terrain.slope`."""
    e, n = _places(east, north)
    up = _upright(terrain_model(world), e, n)
    along = np.clip((normal(world, e, n) * up).sum(-1), 1e-6, 1.0)
    out = np.sqrt(1.0 - along**2) / along
    return float(out) if np.ndim(out) == 0 else out


def materials(world: Any, east: Any, north: Any, step: float = DETAIL) -> dict[str, np.ndarray]:
    """Shares of base materials by name; see `world.terrain.materials`."""
    model = terrain_model(world)
    e, n = _places(east, north)
    if model.land is None:
        raise WorldError('this world has no ground (terrain.source is "none"): there are no materials')
    kind = import_module(f"fallstreak.terrain.cover.{world.terrain.material}")
    weights = kind.cover(sites(model, world.seed, e, n, step)).weights
    out: dict[str, np.ndarray] = {}
    for name, weight in zip(kind.PALETTE, np.moveaxis(weights, -1, 0), strict=True):
        out[name] = out.get(name, 0.0) + np.broadcast_to(weight, e.shape)
    return out


def ray(world: Any, origin: Any, direction: Any, max_distance: float) -> Hits:
    """Where rays meet the ground; see `world.terrain.ray`."""
    start, along = np.broadcast_arrays(
        np.atleast_2d(np.asarray(origin, np.float64)), np.atleast_2d(np.asarray(direction, np.float64))
    )
    if start.shape[-1:] != (3,) or start.ndim != 2:
        raise ValueError(
            f"origin and direction must be (3,) or (n, 3), not {np.shape(origin)} and {np.shape(direction)}"
        )
    if not (np.isfinite(start).all() and np.isfinite(along).all() and (np.abs(along).max(1) > 0.0).all()):
        raise ValueError("origin and direction must be finite, and no direction zero")
    return cast(surface_of(terrain_model(world)), start, along, float(max_distance))


def sites(model: TerrainModel, seed: int, east: np.ndarray, north: np.ndarray, step: float) -> Sites:
    """Places as ``surface_pass.wesl`` tells the cover of them."""
    here = model.shape(east, north, step)
    around = (
        np.stack([east + step, east - step, east, east]),
        np.stack([north, north, north + step, north - step]),
    )
    s = model.shape(*around, step)
    run_east = np.stack(
        [
            2.0 * step + s.shift_east[0] - s.shift_east[1],
            s.shift_north[0] - s.shift_north[1],
            s.height[0] - s.height[1],
        ],
        -1,
    )
    run_north = np.stack(
        [
            s.shift_east[2] - s.shift_east[3],
            2.0 * step + s.shift_north[2] - s.shift_north[3],
            s.height[2] - s.height[3],
        ],
        -1,
    )
    up = np.cross(run_east, run_north)
    up /= np.linalg.norm(up, axis=-1, keepdims=True)
    about, centre = _about(model, east, north, max(step, 32.0), 4)
    wide, _ = _about(model, east, north, max(step, 256.0), 3)
    steep = np.hypot(up[..., 0], up[..., 1]) / np.maximum(up[..., 2], 0.05)
    return Sites(
        east=east,
        north=north,
        step=step,
        seed=(seed + SEED) & 0xFFFFFFFF,
        height=here.height,
        normal=up,
        slope=np.hypot(steep, here.lost),
        hollow=np.clip((about - centre) / 6.0, -1.0, 1.0),
        relief=0.01 * (here.height - wide),
        water=here.water - here.height,
        open=here.open,
        land=np.clip(10.0 - 10.0 * np.hypot(east, north) / (0.97 * model.extent), 0.0, 1.0),
    )


def _about(model: TerrainModel, east, north, step: float, reach: int):
    """Mean height of four samples `reach` steps off, and the height between them."""
    off = reach * step * np.array([0.0, 1.0, -1.0, 0.0, 0.0]).reshape((5,) + (1,) * np.ndim(east))
    side = np.roll(off, 2, axis=0)
    heights = model.shape(east + off, north + side, step).height
    return heights[1:].mean(0), heights[0]


def _from_above(model: TerrainModel, east: np.ndarray, north: np.ndarray):
    """Height and normal of the highest sheet over places of a land with overhangs."""
    land, radius = model.land, model.radius
    assert land is not None
    top = max(land.bounds()[1], land.outside) + 10.0
    start = world_from_map(east, north, top, radius).reshape(-1, 3)
    down = -(start + np.array([0.0, 0.0, radius]))
    hits = cast(surface_of(model), start, down, level=_COARSE)
    found = map_from_world(hits.position, radius)[2]
    return found.reshape(east.shape), hits.normal.reshape((*east.shape, 3))


def _places(east: Any, north: Any) -> tuple[np.ndarray, np.ndarray]:
    e, n = np.broadcast_arrays(np.asarray(east, np.float64), np.asarray(north, np.float64))
    return e, n


def _upright(model: TerrainModel, east: np.ndarray, north: np.ndarray) -> np.ndarray:
    out = world_from_map(east, north, 0.0, model.radius) + np.array([0.0, 0.0, model.radius])
    return out / np.linalg.norm(out, axis=-1, keepdims=True)
