"""Where rays meet the ground, on the CPU in float64.

A ray walks through the same kind of mesh that the picture is drawn from: patches of samples of the land, the
finer the nearer, drawn where their shift moves them (overhangs are hit from below). Newton's method takes the
hit from the mesh to the land. Patches are kept, so that rays side by side share them.

Error: on the land as its samples hold it, below 1 cm where Newton converges (gentle ground), else that of a
triangle whose sides are `SHARPNESS` of the distance. What is thinner than that (a needle of rock 2 m wide,
1 km away) may be missed.
"""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass
from typing import Any

import numpy as np

from .model import FINEST, TerrainModel
from .projection import map_from_world, world_from_map

QUADS, BLOCK = 32, 8
SHARPNESS = 0.002  # spacing of samples over their distance
NEAREST = 0.5  # m, the finest spacing
COARSER = 3  # levels up lies the mesh that tells whether a ray can come near the ground
KEPT = 4000  # patches; 35 kB each
_CORNERS = np.arange(BLOCK + 1)


@dataclass(frozen=True)
class Hits:
    """Where rays meet the ground; for those that do not: inf and nan.

    Attributes
    ----------
    distance : (n,) m from the origin
    position : (n, 3) world coordinates, m
    normal : (n, 3) of the ground there, unit, world axes
    """

    distance: np.ndarray
    position: np.ndarray
    normal: np.ndarray


@dataclass(frozen=True)
class _Patch:
    places: np.ndarray  # (QUADS + 1, QUADS + 1, 2) of the samples on the map
    points: np.ndarray  # (…, 3) where they are drawn, world coordinates
    low: np.ndarray  # (blocks, 3) of each block of quads: least east, north, height of what is drawn
    high: np.ndarray


class Surface:
    """The drawn ground of a model, patch by patch."""

    def __init__(self, model: TerrainModel):
        self.model = model
        self._patches: OrderedDict[tuple[int, int, int], _Patch] = OrderedDict()

    @property
    def finest(self) -> int:
        """The level from which on patches are as wide as samples may be shifted: else many are looked at."""
        bound = self.model.land.shift_bound if self.model.land is not None else 0.0
        return max(round(np.log2(max(bound, 1.0) / (QUADS * NEAREST))), 0)

    def points(self, east: np.ndarray, north: np.ndarray, step: Any) -> np.ndarray:
        """World coordinates (..., 3) of samples of the map; of the water where that stands higher."""
        s = self.model.shape(east, north, step)
        top = np.maximum(s.height, s.water)
        return world_from_map(east + s.shift_east, north + s.shift_north, top, self.model.radius)

    def patches(self, keys: np.ndarray) -> list[_Patch]:
        """The patches of (level, column, row), made where they are new."""
        names = [(int(k), int(i), int(j)) for k, i, j in keys]
        new = [name for name in names if name not in self._patches]
        for first in range(0, len(new), 64):
            self._make(new[first : first + 64])
        found = []
        for name in names:
            self._patches.move_to_end(name)
            found.append(self._patches[name])
        while len(self._patches) > KEPT:
            self._patches.popitem(last=False)
        return found

    def _make(self, names: list[tuple[int, int, int]]) -> None:
        spacing = NEAREST * 2.0 ** np.array([name[0] for name in names])[:, None, None]
        across, up = np.meshgrid(np.arange(QUADS + 1), np.arange(QUADS + 1))
        east = (np.array([name[1] for name in names])[:, None, None] * QUADS + across) * spacing
        north = (np.array([name[2] for name in names])[:, None, None] * QUADS + up) * spacing
        s = self.model.shape(east, north, spacing)
        drawn = np.stack([east + s.shift_east, north + s.shift_north, np.maximum(s.height, s.water)], -1)
        points = world_from_map(drawn[..., 0], drawn[..., 1], drawn[..., 2], self.model.radius)
        # each block with the samples on all its sides
        rows = (np.arange(0, QUADS, BLOCK)[:, None] + _CORNERS)[:, None, :, None]
        columns = (np.arange(0, QUADS, BLOCK)[:, None] + _CORNERS)[None, :, None, :]
        blocks = drawn[:, rows, columns].reshape(len(names), (QUADS // BLOCK) ** 2, -1, 3)
        for i, name in enumerate(names):
            places = np.stack([east[i], north[i]], -1)
            self._patches[name] = _Patch(places, points[i], blocks[i].min(1), blocks[i].max(1))


def cast(
    surface: Surface,
    origin: np.ndarray,
    direction: np.ndarray,
    reach: float = np.inf,
    level: int | None = None,
) -> Hits:
    """The first ground that rays meet.

    Parameters
    ----------
    surface : Surface
    origin, direction : (n, 3) float64; world coordinates, m, and any length
    reach : m, the farthest that counts
    level : of the patches, NEAREST · 2^level m between samples; by default by distance
    """
    model = surface.model
    direction = direction / np.linalg.norm(direction, axis=1, keepdims=True)
    count = len(origin)
    best, place = np.full(count, np.inf), np.zeros((count, 2))
    normal = np.full((count, 3), np.nan)
    beyond = model.land.outside if model.land is not None else 0.0
    if model.land is not None:
        best, place, spacing = _walk(surface, origin, direction, reach, level)
        hit = np.isfinite(best)
        best[hit], normal[hit] = _refined(
            surface, origin[hit], direction[hit], best[hit], place[hit], spacing[hit]
        )
    ball, _ = _sphere(origin, direction, model.radius, model.radius + beyond)
    with np.errstate(invalid="ignore"):
        at = origin + np.where(np.isfinite(ball), ball, 0.0)[:, None] * direction
    east, north, _ = map_from_world(at, model.radius)
    outside = (model.land is None) | (np.hypot(east, north) > 0.97 * model.extent)
    globe = np.isfinite(ball) & outside & (ball < best) & (ball <= reach)
    best[globe] = ball[globe]
    centre = np.array([0.0, 0.0, -model.radius])
    normal[globe] = (at[globe] - centre) / np.linalg.norm(at[globe] - centre, axis=1, keepdims=True)
    missed = ~(np.isfinite(best) & (best <= reach))
    best[missed], normal[missed] = np.nan, np.nan
    position = origin + best[:, None] * direction
    return Hits(np.where(missed, np.inf, best), position, normal)


def _sphere(origin, direction, radius: float, size: float):
    """Distances at which rays enter and leave a sphere about the planet's middle; inf where they miss it."""
    x = origin + np.array([0.0, 0.0, radius])
    along = (x * direction).sum(1)
    # |x|² − size² without the difference of two great squares
    z = origin[:, 2]
    outside = (
        origin[:, 0] ** 2 + origin[:, 1] ** 2 + z * (z + 2.0 * radius) + (radius - size) * (radius + size)
    )
    under = along**2 - outside
    root = np.sqrt(np.maximum(under, 0.0))
    far = np.where(along <= 0.0, -along + root, -outside / np.maximum(along + root, 1e-9))
    near = np.where(along <= 0.0, outside / np.maximum(-along + root, 1e-9), -along - root)
    hits = (under >= 0.0) & (far > 0.0)
    return np.where(hits, np.where(near > 0.0, near, np.where(outside > 0, np.inf, 0.0)), np.inf), np.where(
        hits, far, -np.inf
    )


def _walk(surface: Surface, origin, direction, reach: float, level: int | None):
    """Through the patches along each ray: distance, place on the map, spacing of the first triangle hit."""
    model = surface.model
    land = model.land
    assert land is not None
    count = len(origin)
    best, place = np.full(count, np.inf), np.zeros((count, 2))
    spacing = np.full(count, NEAREST)
    # bounds of the land are those of its samples; water may stand higher
    top = max(land.bounds()[1], land.outside, float(np.max(model.shape(0.0, 0.0).water))) + 1.0
    t, end = _sphere(origin, direction, model.radius, model.radius + top)
    end = np.minimum(end, reach)
    active = np.flatnonzero(t < end)
    while len(active):
        start = t[active]
        k = (
            np.maximum(np.log2(np.maximum(start, 1e-3) * SHARPNESS / NEAREST), surface.finest).astype(int)
            if level is None
            else np.full(len(active), level)
        )
        size = QUADS * NEAREST * 2.0**k
        stop = np.minimum(start + size, end[active])
        # a little back: where spacings change, what one mesh holds may lie behind the other
        first = np.maximum(start - 0.25 * size, 0.0)
        a, b = (
            np.stack(map_from_world(origin[active] + s[:, None] * direction[active], model.radius), 1)
            for s in (first, stop)
        )
        length = stop - first
        slack = (1e-3 * length + 0.01)[:, None] * [1.0, 1.0, 0.0]
        slack[:, 2] = 0.01 + length**2 / (8.0 * model.radius)
        low, high = np.minimum(a, b) - slack, np.maximum(a, b) + slack
        found = _nearest(surface, origin[active], direction[active], first, stop, low, high, k, size)
        hit = np.isfinite(found[0])
        best[active[hit]], place[active[hit]] = found[0][hit], found[1][hit]
        spacing[active] = NEAREST * 2.0**k
        t[active] = stop
        lost = high[:, 2] < land.bounds()[0] - 1e3
        active = active[~hit & ~lost & (stop < end[active])]
    return best, place, spacing


def _nearest(surface: Surface, origin, direction, first, stop, low, high, level, size):
    """The nearest triangle between two distances of each ray, among the patches that can hold it."""
    bound = surface.model.land.shift_bound  # type: ignore[union-attr]
    corner = np.floor((low[:, :2] - bound) / size[:, None]).astype(int)
    last = np.floor((high[:, :2] + bound) / size[:, None]).astype(int)
    rays, keys = [], []
    for dj in range(int((last - corner)[:, 1].max()) + 1):
        for di in range(int((last - corner)[:, 0].max()) + 1):
            cell = corner + np.array([di, dj])
            near = np.hypot(*((np.maximum(np.abs(cell + 0.5) - 0.5, 0.0)) * size[:, None]).T)
            here = np.flatnonzero((cell <= last).all(1) & (near < surface.model.extent))
            rays.append(here)
            keys.append(np.column_stack([level[here], cell[here]]))
    ray, key = np.concatenate(rays), np.concatenate(keys)
    near = _may_touch(surface, low[ray, 2], key)
    ray, key = ray[near], key[near]
    best, place = np.full(len(origin), np.inf), np.zeros((len(origin), 2))
    if not len(ray):
        return best, place
    unique, which = np.unique(key, axis=0, return_inverse=True)
    owners, corners, places = [], [], []
    order = np.argsort(which.ravel(), kind="stable")
    ends = np.cumsum(np.bincount(which.ravel(), minlength=len(unique)))
    for patch, begin, finish in zip(surface.patches(unique), np.r_[0, ends[:-1]], ends, strict=True):
        mine = ray[order[begin:finish]]
        touch = ((low[mine, None] <= patch.high) & (high[mine, None] >= patch.low)).all(2)
        for r, block in zip(*np.nonzero(touch), strict=True):
            row, column = (BLOCK * int(v) for v in divmod(int(block), QUADS // BLOCK))
            part = slice(row, row + BLOCK + 1), slice(column, column + BLOCK + 1)
            owners.append(mine[r])
            corners.append(patch.points[part])
            places.append(patch.places[part])
    for begin in range(0, len(owners), 8192):
        part = slice(begin, begin + 8192)
        who = np.array(owners[part])
        t, at = _triangles(
            np.stack(corners[part]),
            np.stack(places[part]),
            origin[who],
            direction[who],
            first[who],
            stop[who],
        )
        for i in np.flatnonzero(np.isfinite(t)):
            if t[i] < best[who[i]]:
                best[who[i]], place[who[i]] = t[i], at[i]
    return best, place


def _may_touch(surface: Surface, lowest: np.ndarray, key: np.ndarray) -> np.ndarray:
    """Whether a ray comes so low that it may meet a patch, as a coarser patch around that tells: what is left
    out of its samples is lower than four of their spacings."""
    wide = np.column_stack([key[:, 0] + COARSER, key[:, 1:] >> COARSER])
    unique, which = np.unique(wide, axis=0, return_inverse=True)
    if not len(unique):
        return np.zeros(0, bool)
    side = QUADS // BLOCK
    high = np.stack([patch.high[:, 2] for patch in surface.patches(unique)])
    column, row = ((key[:, i] - (wide[:, i] << COARSER)) * side >> COARSER for i in (1, 2))
    return lowest <= high[which.ravel(), row * side + column] + 4.0 * NEAREST * 2.0 ** wide[:, 0]


def _triangles(points, places, origin, direction, first, stop):
    """The nearest triangle of each block of quads: distance and place on the map (Möller & Trumbore 1997).

    Triangles as the GPU's mesh has them: all diagonals from south-west to north-east.
    """
    p = points - origin[:, None, None]
    a, b, c, d = p[:, :-1, :-1], p[:, :-1, 1:], p[:, 1:, 1:], p[:, 1:, :-1]
    m = places
    ma, mb, mc, md = m[:, :-1, :-1], m[:, :-1, 1:], m[:, 1:, 1:], m[:, 1:, :-1]
    ray = direction[:, None, None]
    best, at = np.full(len(points), np.inf), np.zeros((len(points), 2))
    for v0, v1, v2, m0, m1, m2 in ((a, b, c, ma, mb, mc), (a, c, d, ma, mc, md)):
        one, two = v1 - v0, v2 - v0
        q = np.cross(ray, two)
        det = (one * q).sum(-1)
        with np.errstate(divide="ignore", invalid="ignore"):
            u = -(v0 * q).sum(-1) / det
            r = np.cross(-v0, one)
            v = (ray * r).sum(-1) / det
            t = (two * r).sum(-1) / det
            inside = (u >= -1e-9) & (v >= -1e-9) & (u + v <= 1.0 + 1e-9)
            inside &= (t >= first[:, None, None]) & (t <= stop[:, None, None])
        t = np.where(inside, t, np.inf).reshape(len(points), -1)
        i = t.argmin(1)
        rows = np.arange(len(points))
        nearer = t[rows, i] < best
        best = np.where(nearer, t[rows, i], best)
        u, v = (w.reshape(len(points), -1)[rows, i][:, None] for w in (u, v))
        m0, m1, m2 = (w.reshape(len(points), -1, 2)[rows, i] for w in (m0, m1, m2))
        with np.errstate(invalid="ignore"):
            at = np.where(nearer[:, None], m0 + u * (m1 - m0) + v * (m2 - m0), at)
    return best, at


def _refined(surface: Surface, origin, direction, distance, place, spacing):
    """From triangles to the land: Newton's method for place and distance; and the normal there."""
    m, t = place.copy(), distance.copy()
    step = np.maximum(0.5 * spacing, FINEST)
    delta = 0.5 * step
    normal = np.zeros((len(t), 3))
    good = np.zeros(len(t), bool)
    for turn in range(5):
        east = m[:, 0] + delta * np.array([[0.0], [1.0], [-1.0], [0.0], [0.0]])
        north = m[:, 1] + delta * np.array([[0.0], [0.0], [0.0], [1.0], [-1.0]])
        p = surface.points(east, north, step[None])
        along_east = (p[1] - p[2]) / (2.0 * delta[:, None])
        along_north = (p[3] - p[4]) / (2.0 * delta[:, None])
        normal = np.cross(along_east, along_north)
        rest = origin + t[:, None] * direction - p[0]
        good = np.linalg.norm(rest, axis=1) < 0.01 + 1e-7 * t
        if turn == 4 or good.all():
            break
        matrix = np.stack([along_east, along_north, -direction], -1)
        safe = np.abs(np.linalg.det(matrix)) > 1e-3
        matrix[~safe] = np.eye(3)
        change = np.linalg.solve(matrix, rest[..., None])[..., 0]
        change[~safe | good] = 0.0
        change *= np.minimum(1.0, spacing / np.maximum(np.abs(change).max(1), 1e-9))[:, None]
        m, t = m + change[:, :2], t + change[:, 2]
    good &= np.abs(t - distance) < 4.0 * spacing
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-12)
    return np.where(good, t, distance), normal
