"""How far the edges of the land's shadows in a picture are from those of rays.

The rays (float64) go through the land's own model, not through what the GPU keeps of it: in samples about as
wide as a pixel of the picture wherever they pass. So the figures hold all that is between them and the
picture: the clipmap's levels, the mesh, the sweep and its half floats.
"""

from __future__ import annotations

from itertools import pairwise
from math import ceil, log2

import numpy as np
from numba import njit, prange
from shadow_stage import Picture, Stage

from fallstreak.terrain.model import TerrainModel, terrain_model
from fallstreak.world.state import local_axes

SAMPLES = 768
"""Along a side of a square of heights about the camera; the next is twice as wide."""
HELD = 0.49 * SAMPLES
FINEST = 0.5
REACH = 6e4
"""m from the camera, as far as rays go."""
FARTHEST = 40
"""Pixels beyond which an edge counts as so far off."""


class Ground:
    """Heights about a camera, in samples about as wide as a pixel: float64.

    Attributes
    ----------
    squares : (levels, SAMPLES, SAMPLES)
        m above the sea; rows run north.
    """

    def __init__(self, model: TerrainModel, east: float, north: float, reach: float):
        levels = 1 + ceil(log2(reach / (HELD * FINEST)))
        self.squares = np.empty((levels, SAMPLES, SAMPLES))
        for level, square in enumerate(self.squares):
            along = (np.arange(SAMPLES) - SAMPLES // 2) * FINEST * 2.0**level
            found = model.shape(*np.meshgrid(east + along, north + along), FINEST * 2.0**level)
            square[:] = np.maximum(found.height, found.water)

    def height(self, offset: np.ndarray) -> np.ndarray:
        """m above the sea at offsets from the camera on the map, (n, 2)."""
        return np.array([_height(self.squares, east, north)[0] for east, north in offset])

    def spacing(self, offset: np.ndarray) -> np.ndarray:
        """m between samples there."""
        return np.array([_height(self.squares, east, north)[1] for east, north in offset])


@njit
def _height(squares, east, north):
    """Height at an offset from the camera, and m between samples there."""
    away = max(abs(east), abs(north)) / (HELD * FINEST)
    level = min(int(np.ceil(np.log2(max(away, 1.0)))), len(squares) - 1)
    spacing = FINEST * 2.0**level
    x, y = east / spacing + SAMPLES // 2, north / spacing + SAMPLES // 2
    i, j = min(max(int(x), 0), SAMPLES - 2), min(max(int(y), 0), SAMPLES - 2)
    fx, fy = x - i, y - j
    grid = squares[level]
    south = grid[j, i] + fx * (grid[j, i + 1] - grid[j, i])
    upper = grid[j + 1, i] + fx * (grid[j + 1, i + 1] - grid[j + 1, i])
    return south + fy * (upper - south), spacing


@njit(parallel=True)
def hidden(squares, offset, key, radius, reach):
    """Whether rays from the ground towards the middle of the light's disc meet ground, (n,).

    Parameters
    ----------
    squares
        Of `Ground`.
    offset : (n, 2)
        m on the map, from the camera.
    key : (n, 3)
        Towards the light, axes of each place.
    reach : float
        m from the camera, beyond which nothing is looked for.
    """
    dark = np.zeros(len(offset), np.bool_)
    top = squares.max()
    for n in prange(len(offset)):
        flat = np.hypot(key[n, 0], key[n, 1])
        east, north = key[n, 0] / flat, key[n, 1] / flat
        start, spacing = _height(squares, offset[n, 0], offset[n, 1])
        gone = 0.0
        while True:
            gone += 0.5 * spacing
            x, y = offset[n, 0] + gone * east, offset[n, 1] + gone * north
            # straight rays over ground that sinks
            height = start + gone * key[n, 2] / flat + gone * gone / (2.0 * radius)
            if height > top or max(abs(x), abs(y)) > reach:
                break
            ground, spacing = _height(squares, x, y)
            if ground > height:
                dark[n] = True
                break
    return dark


def edges(stage: Stage, bands: tuple[float, ...]) -> tuple[float, list[tuple[float, float, np.ndarray]]]:
    """Where shadows of land end in a picture, against rays.

    Parameters
    ----------
    stage : Stage
        Of a world whose land alone throws shadows.
    bands : m
        Borders of distance.

    Returns
    -------
    share : float
        Intersection over union of the dark pixels.
    list of (from m, to m, distances)
        From each pixel where the rays' shadow ends to the next one where the picture's does, pixels.
    """
    camera = stage.camera()
    picture, _ = stage.render(camera)
    seen = np.isfinite(picture.along)
    picture, light = stage.render(camera, picture.places[seen], picture.normals[seen])
    pose, radius = stage.pose(), stage.world.planet.radius
    offset, axes = _on_map(picture.places[seen], (pose.east, pose.north), radius)
    key = np.einsum("nij,i->nj", axes, stage.key)
    model = terrain_model(stage.world)
    ground = Ground(model, pose.east, pose.north, REACH)
    dark = hidden(ground.squares, offset, key, radius, REACH)
    # what faces away is dark in both
    step = 0.5 * ground.spacing(offset)
    slope = np.stack(
        [
            (ground.height(offset + step[:, None] * s) - ground.height(offset - step[:, None] * s))
            / (2 * step)
            for s in np.eye(2)
        ],
        -1,
    )
    away = (slope * key[:, :2]).sum(-1) > key[:, 2]
    masks = np.zeros((2, *seen.shape), bool)
    masks[0, seen], masks[1, seen] = dark | away, (light[:, 0] < 0.5) | away
    same = _same_surface(picture)
    found = [_ends(mask, same) for mask in masks]
    away_from_eye = np.linalg.norm(picture.places - camera.position, axis=-1)
    out = []
    for low, high in pairwise(bands):
        with np.errstate(invalid="ignore"):
            chosen = found[0] & (away_from_eye >= low) & (away_from_eye < high)
        off = _nearest(np.argwhere(chosen), found[1])
        if len(off):
            out.append((low, high, off))
    share = (masks[0] & masks[1]).sum() / max((masks[0] | masks[1]).sum(), 1)
    return float(share), out


def _on_map(places: np.ndarray, camera: tuple[float, float], radius: float) -> tuple[np.ndarray, np.ndarray]:
    """Offsets from a camera on the map (n, 2), and the axes there as columns (n, 3, 3)."""
    across = np.hypot(places[:, 0], places[:, 1])
    distance = radius * np.arctan2(across, places[:, 2] + radius)
    at = places[:, :2] / np.maximum(across, 1e-9)[:, None] * distance[:, None]
    # axes turn by 1e-5 in 64 m
    cells, inverse = np.unique(np.round(at / 64.0).astype(int), axis=0, return_inverse=True)
    axes = np.array([local_axes(64.0 * east, 64.0 * north, radius) for east, north in cells])
    return at - np.asarray(camera), axes[inverse]


def _same_surface(picture: Picture) -> np.ndarray:
    """Whether a pixel and the next to the right (0) and below (1) show one surface: (2, H, W)."""
    out = np.zeros((2, *picture.along.shape), bool)
    with np.errstate(invalid="ignore"):
        out[0, :, :-1] = np.abs(np.diff(np.log(picture.along), axis=1)) < 0.05
        out[1, :-1] = np.abs(np.diff(np.log(picture.along), axis=0)) < 0.05
    return out


def _ends(mask: np.ndarray, same: np.ndarray) -> np.ndarray:
    """Pixels whose right or lower neighbour on the same surface is otherwise."""
    out = np.zeros(mask.shape, bool)
    out[:, :-1] |= (mask[:, 1:] != mask[:, :-1]) & same[0, :, :-1]
    out[:-1] |= (mask[1:] != mask[:-1]) & same[1, :-1]
    return out


def _nearest(points: np.ndarray, mask: np.ndarray) -> np.ndarray:
    """Distance of each point (n, 2) to the next pixel of a mask, at most `FARTHEST`."""
    best = np.full(len(points), float(FARTHEST))
    wide = np.pad(mask, FARTHEST)
    steps = np.arange(-FARTHEST, FARTHEST + 1)
    offsets = np.stack(np.meshgrid(steps, steps), -1).reshape(-1, 2)
    offsets = offsets[np.argsort((offsets**2).sum(-1), kind="stable")]
    alive = np.arange(len(points))
    for offset in offsets[(offsets**2).sum(-1) <= FARTHEST**2]:
        if not alive.size:
            break
        y, x = (points[alive] + offset + FARTHEST).T
        hit = wide[y, x]
        best[alive[hit]] = np.hypot(*offset)
        alive = alive[~hit]
    return best
