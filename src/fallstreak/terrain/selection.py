"""CPU twin (float64) of ``selection.wesl``, ``mesh.wesl`` and ``heights_pass.wesl``: the tests' measure."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from .clipmap import TILE
from .model import TerrainModel
from .projection import map_from_world, world_from_map

MORPH_START = 0.83
Bounds = Callable[[int, np.ndarray, np.ndarray], np.ndarray]
"""Lowest, highest, largest shifts east and north, of the tiles of a level that hold samples first .. last."""


def bounds_of(held: np.ndarray) -> Bounds:
    """What the GPU's bounds say.

    Parameters
    ----------
    held : (levels, tiles, tiles, 4), the buffer ``terrain.bounds``
    """
    tiles = held.shape[1]

    def find(level: int, first: np.ndarray, last: np.ndarray) -> np.ndarray:
        column, row = (np.arange(first[i] // TILE, last[i] // TILE + 1) % tiles for i in (0, 1))
        found = held[level][np.ix_(row, column)]
        return np.array([found[..., 0].min(), *found[..., 1:].reshape(-1, 3).max(0)], float)

    return find


def range_of(frame: dict[str, Any], level: int) -> float:
    """Of its own widths that a node of a level of the clipmap can be away."""
    return min(frame["range"] * 2.0 ** max(level - frame["coarse_level"], 0.0), frame["coarse_range"])


def first_sample(frame: dict[str, Any], grid: int, cells: np.ndarray, level: int) -> np.ndarray:
    """First sample of a node: `cells` is its column and row, `level` that of the clipmap."""
    return cells * grid - (grid << (frame["depth"] - 1 - level))


def select_nodes(
    bounds: Bounds,
    frame: dict[str, Any],
    grid: int,
    clip_from_world: np.ndarray,
    camera: np.ndarray,
    radius: float,
) -> np.ndarray:
    """Nodes that are drawn for a camera.

    Parameters
    ----------
    bounds : of the heights and shifts in the clipmap's tiles
    frame : dict
        Of `Terrain.frame_values`.
    grid : quads along a node's side
    clip_from_world : (4, 4), of camera-relative positions
    camera : (3,) world position, m
    radius : planet radius, m

    Returns
    -------
    (count, 3) int: x, y, level
    """
    out, queue = [], [(0, 0)]
    for depth in range(frame["depth"] + 1):
        level = frame["depth"] - depth
        size = frame["leaf"] * 2.0**level
        following = []
        for x, y in queue:
            if level < frame["clip_levels"]:
                corner = np.array([x, y]) * size - 0.5 * frame["leaf"] * 2.0 ** frame["depth"]
                offset = corner - frame["camera_map"]
                d = np.maximum(np.maximum(offset, -(offset + size)), 0.0)
                nearest = np.sqrt(d @ d + frame["camera_above"] ** 2)
                drawn = level == 0 or nearest >= 0.5 * range_of(frame, level - 1) * size
                held = np.array([frame["lowest"], frame["highest"], *2 * (frame["shift_bound"],)])
                if drawn:
                    first = first_sample(frame, grid, np.array([x, y]), level)
                    coarser = min(level + 1, frame["clip_levels"] - 1)
                    halve = coarser - level
                    own = bounds(level, first, first + grid)
                    next_ = bounds(coarser, first >> halve, (first + grid) >> halve)
                    held = np.array([min(own[0], next_[0]), *np.maximum(own[1:], next_[1:])])
                if not _is_visible(frame, corner, size, held, clip_from_world, camera, radius):
                    continue
                if drawn:
                    out.append((x, y, depth))
                    continue
            following += [(2 * x + i, 2 * y + j) for j in (0, 1) for i in (0, 1)]
        queue = following
    return np.array(out, int).reshape(-1, 3)


def _is_visible(frame, corner, size, held, clip_from_world, camera, radius) -> bool:
    d = np.maximum(np.maximum(corner, -(corner + size)), 0.0)
    if d @ d > frame["extent"] ** 2:
        return False
    places = corner + size * np.array([[0, 0], [1, 0], [0, 1], [1, 1], [0.5, 0.5]])
    points = world_from_map(places[:, :1], places[:, 1:], held[None, :2], radius).reshape(-1, 3) - camera
    slack = size * size / (4.0 * radius) + np.array([held[2], held[3], 0.16 * max(held[2], held[3])])
    low, high = points.min(0) - slack, points.max(0) + slack
    centre, half = 0.5 * (low + high), 0.5 * (high - low)
    m = clip_from_world
    for plane in (m[3] + m[0], m[3] - m[0], m[3] + m[1], m[3] - m[1], m[3]):
        if plane[:3] @ centre + plane[3] + np.abs(plane[:3]) @ half < 0.0:
            return False
    base = radius + frame["lowest"]
    eye = max(float(map_from_world(camera, radius)[2]) - frame["lowest"], 0.0)
    top = max(held[1] - frame["lowest"], 0.0)
    away = np.maximum(np.maximum(low, -high), 0.0)
    return bool(np.linalg.norm(away) <= np.sqrt(eye * (2 * base + eye)) + np.sqrt(top * (2 * base + top)))


@dataclass(frozen=True)
class Vertices:
    """Where the vertices of a node are; arrays of one entry, or row, per vertex.

    Attributes
    ----------
    offset : (n, 2), on the map, from the camera, m
    level : of the clipmap
    fine, coarse : (n, 2), the samples of `level` and of the next between which it lies
    part : 0 at the fine sample … 1 at the coarse one
    """

    offset: np.ndarray
    level: np.ndarray
    fine: np.ndarray
    coarse: np.ndarray
    part: np.ndarray


def morphed(frame: dict[str, Any], node: np.ndarray, grid: int) -> Vertices:
    """Vertices of a node (x, y, quadtree level) as ``mesh.wesl`` moves them; (grid + 1)² of them."""
    cells, own = np.array(node[:2], int), frame["depth"] - int(node[2])
    unit = frame["leaf"] * 2.0**own / grid
    index = np.arange((grid + 1) ** 2)
    origin = first_sample(frame, grid, cells, own)
    at = np.stack([index % (grid + 1), index // (grid + 1)], 1)
    corner = origin * unit - np.array(frame["camera_map"])
    offset, part = np.zeros(at.shape), np.zeros(len(at))
    fine, coarse, level = np.zeros_like(at), np.zeros_like(at), np.zeros_like(index)
    going = np.ones(len(at), bool)
    for i in range(4):
        last = own + i + 1 >= frame["clip_levels"]
        here = corner + at * unit
        distance = np.sqrt((here**2).sum(1) + frame["camera_above"] ** 2)
        reach = range_of(frame, own + i) * unit * 2.0**i * grid
        p = np.clip((distance / reach - MORPH_START) / (1.0 - MORPH_START), 0.0, 1.0) * (not last)
        odd = (origin + at) & (1 << i)
        new = here - odd * p[:, None] * unit
        offset[going], part[going], level[going] = new[going], p[going], own + i
        fine[going] = ((origin + at) >> i)[going]
        coarse[going] = ((origin + at - odd * (not last)) >> (i + 1))[going]
        going = going & (p >= 1.0)
        if last or not going.any():
            break
        at = np.where(going[:, None], at - odd, at)
    return Vertices(offset, level, fine, coarse, part)


def vertex_shape(model: TerrainModel, spacing: float, v: Vertices) -> tuple[np.ndarray, np.ndarray]:
    """Height (n,) and shift (n, 2) of vertices, m, by the land's own twin; `spacing` is that of level 0."""
    height, shift = np.zeros(len(v.part)), np.zeros((len(v.part), 2))
    for samples, level, weight in ((v.fine, v.level, 1.0 - v.part), (v.coarse, v.level + 1, v.part)):
        step = spacing * 2.0**level
        found = model.shape(samples[:, 0] * step, samples[:, 1] * step, step)
        height += weight * np.maximum(found.height, found.water)
        shift += weight[:, None] * np.stack([found.shift_east, found.shift_north], 1)
    return height, shift
