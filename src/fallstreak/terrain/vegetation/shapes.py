"""What plants and rocks look like: meshes made in code, one height high, with their foot at the origin.

Trees are wood and cards with pictures of twigs (`cards.py`). Normals of leaves point out of the crown, as a
crowd of leaves catches light, not as each card would; `sky` falls towards the trunk and the ground.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from .mesh import Builder, Mesh, grid, repeated

UP = np.array([0.0, 0.0, 1.0])


def _unit(v: np.ndarray) -> np.ndarray:
    return v / np.maximum(np.linalg.norm(v, axis=-1, keepdims=True), 1e-9)


# ---- conifer ---------------------------------------------------------------------------------------------


def _conifer_radius(z: np.ndarray | float) -> np.ndarray | float:
    """Length of branches at a height, tree heights: longest low down, a spire above."""
    t = np.clip((np.asarray(z) - 0.05) / 0.95, 0.0, 1.0)
    return 0.012 + 0.185 * (1.0 - t) ** 0.92 * (0.72 + 0.28 * np.minimum(t / 0.12, 1.0))


def _fronds(
    b: Builder, rng: np.random.Generator, z: np.ndarray, turn: np.ndarray, length: np.ndarray, stations: int
) -> None:
    """Branches (n): strips folded like roofs along their axes, which sag and turn up at the tips."""
    n = len(z)
    s = np.linspace(0.0, 1.0, stations)[None, :, None]  # along a branch
    across = np.array([-1.0, 0.0, 1.0])[None, None, :]
    out, side = (np.stack(v, -1)[:, None, None, :] for v in (
        (np.cos(turn), np.sin(turn), 0.0 * turn), (-np.sin(turn), np.cos(turn), 0.0 * turn)))  # fmt: skip
    z, length = z[:, None, None], length[:, None, None]
    age = 1.0 - z
    rise = np.radians(38.0 - 62.0 * age + rng.normal(0, 6.0, z.shape))
    sag = (0.34 * age + 0.06) * (0.8 + 0.4 * rng.uniform(size=z.shape))
    height = z + length * (s * np.sin(rise) - sag * s * s + 0.26 * age * s**4)
    half = length * (0.29 if stations > 2 else 0.36) + 0.010
    fold = np.radians(rng.uniform(26, 48, z.shape))
    roll = rng.normal(0.0, 0.25, z.shape)
    tilt = across * fold + roll
    sunk = half * (np.abs(across) * np.sin(fold) + across * np.sin(roll))
    places = (
        (length * s * np.cos(rise))[..., None] * out
        + (half * across * np.cos(tilt))[..., None] * side
        + (height - sunk)[..., None] * UP
    )
    ruffle = rng.normal(0.0, 0.16, (n, 1, 1, 3))
    normals = ruffle + 0.6 * out * (0.35 + s)[..., None] + 0.5 * UP + 0.55 * across[..., None] * side
    shape = (n, stations, 3)
    uv = np.stack(np.broadcast_arrays(0.5 + 0.5 * across, s), -1)
    b.add(
        places.reshape(-1, 3),
        normals.reshape(-1, 3),
        np.broadcast_to(uv, (*shape, 2)).reshape(-1, 2),
        repeated(grid(stations, 3), 3 * stations, n),
        sky=np.broadcast_to(0.22 + 0.78 * s**0.8 * (0.62 + 0.38 * z), shape).ravel(),
        bend=np.broadcast_to(s**1.5 * np.minimum(1.0, length / 0.12), shape).ravel(),
        phase=np.broadcast_to(rng.uniform(size=z.shape), shape).ravel(),
        leaf=1.0,
    )


def _trunk(b: Builder, top: float, radius: float, sides: int, rings: int) -> None:
    z = np.linspace(0.0, top, rings)
    flare = 1.0 + 0.7 * np.exp(-z / 0.02)
    points = np.stack([0.006 * np.sin(7 * z), 0.006 * np.cos(5 * z) - 0.006, z - 0.015], 1)
    b.tube(points, radius * flare * (1.0 - 0.93 * z / top), sides, np.zeros(rings), sky=0.3)


@lru_cache
def conifer(level: int = 0) -> Mesh:
    """A spruce: whorls of drooping branches about a straight trunk."""
    rng = np.random.default_rng(11)
    b = Builder()
    fine = level == 0
    _trunk(b, 0.97, 0.0125, 7 if fine else 4, 7 if fine else 3)
    heights = 0.085 + 0.885 * np.linspace(0.0, 1.0, 34 if fine else 21) ** 0.92
    count = np.where(heights < 0.78, 8, 5) if fine else np.where(heights < 0.75, 7, 5)
    whorl = np.repeat(np.arange(len(heights)), count)
    place = np.concatenate([np.arange(c) for c in count]) + rng.uniform(-0.3, 0.3, len(whorl))
    z = heights[whorl] + rng.normal(0.0, 0.009, len(whorl))
    turn = 2.4 * whorl + 2 * np.pi * place / count[whorl]
    # trees are fuller on some sides than on others
    lobe = 1.0 + 0.12 * np.sin(turn + 1.0 + 5 * z) + 0.08 * np.sin(2 * turn + 4.0 - 9 * z)
    length = _conifer_radius(z) * lobe * rng.uniform(0.78, 1.12, len(z)) * (1.0 if fine else 1.06)
    _fronds(b, rng, z, turn, length, 4 if fine else 2)
    for turn in (0.3, 1.87):  # the leader
        side = np.array([np.cos(turn), np.sin(turn), 0.0])
        places = np.array([-0.018 * side, 0.018 * side, -0.018 * side, 0.018 * side])
        places[:, 2] += [0.93, 0.93, 1.0, 1.0]
        uv = np.array([(0.15, 0.45), (0.85, 0.45), (0.15, 1.0), (0.85, 1.0)])
        b.add(places, places * [9, 9, 0] + UP, uv, grid(2, 2), sky=1.0, bend=0.3, phase=0.5, leaf=1.0)
    return b.mesh()


# ---- crowns of leaves ------------------------------------------------------------------------------------


def _crown(
    b: Builder,
    rng: np.random.Generator,
    lumps: np.ndarray,
    cards: int,
    size: float,
    middle: np.ndarray,
    floor: float,
) -> None:
    """Sprays of leaves over a heap of balls (n, 4: place, radius), none deep inside another ball."""
    weight = lumps[:, 3] ** 2
    share = np.round(cards * weight / weight.sum()).astype(int)
    low, high = lumps[:, 2].min(), (lumps[:, 2] + lumps[:, 3]).max()
    parts = []
    for lump, count in zip(lumps, share, strict=True):
        out = _unit(rng.normal(size=(6 * count, 3)))
        out[:, 2] = np.where(out[:, 2] > -0.55, out[:, 2], -out[:, 2])
        at = lump[:3] + lump[3] * rng.uniform(0.72, 1.0, (6 * count, 1)) * out
        depth = (np.linalg.norm(at[:, None] - lumps[:, :3], axis=2) / lumps[:, 3]).min(1)
        good = np.flatnonzero((depth > 0.62) & (at[:, 2] > floor))[:count]
        parts.append(np.concatenate([at[good], out[good], depth[good, None]], 1))
    found = np.concatenate(parts)
    at, out, depth = found[:, :3], found[:, 3:6], found[:, 6]
    n = len(at)
    normal = _unit(0.6 * out + 0.6 * _unit(at - middle) + 0.4 * UP)
    height = (at[:, 2] - low) / (high - low)
    sky = np.clip((0.30 + 0.35 * depth) * (0.75 + 0.35 * out[:, 2]) + 0.30 * height, 0.30, 1.0)
    # a spray hangs more or less along the crown's surface
    face = _unit(normal + rng.normal(0.0, 0.75, (n, 3)))
    along = _unit(np.cross(face, rng.normal(size=(n, 3))))
    across = np.cross(face, along)
    corners = np.stack([-across - along, across - along, across + along, -across + along], 1)
    reach = size * rng.uniform(0.75, 1.25, (n, 1, 1))
    normals = (normal + rng.normal(0.0, 0.28, (n, 3)))[:, None] + 0.4 * corners
    b.add(
        (at[:, None] + reach * corners).reshape(-1, 3),
        normals.reshape(-1, 3),
        np.tile([(0, 0), (1, 0), (1, 1), (0, 1)], (n, 1)),
        repeated(np.array([(0, 1, 2), (0, 2, 3)]), 4, n),
        sky=np.repeat(sky * rng.uniform(0.7, 1.0, n), 4),
        bend=np.repeat(0.4 + 0.6 * depth, 4),
        phase=np.repeat(rng.uniform(size=n), 4),
        leaf=1.0,
    )


def _heap(
    rng: np.random.Generator, count: int, middle: np.ndarray, reach: np.ndarray, size: float
) -> np.ndarray:
    """Balls that fill an ellipsoid more or less: a crown's clumps, (count, 4)."""
    golden = np.pi * (3.0 - np.sqrt(5.0))
    k = np.arange(count)
    z = 1.0 - 1.75 * (k + 0.5) / count  # few below
    ring = np.sqrt(1.0 - z * z)
    turn = golden * k + rng.normal(0.0, 0.3, count)
    out = np.stack([ring * np.cos(turn), ring * np.sin(turn), z], 1) * rng.uniform(0.75, 1.08, (count, 1))
    radius = size * rng.uniform(0.75, 1.3, count)
    return np.concatenate([middle + out * (reach - 0.7 * size), radius[:, None]], 1)


@lru_cache
def broadleaf(level: int = 0) -> Mesh:
    """An oak or a maple: a short trunk, limbs, a heap of leafy clumps."""
    rng = np.random.default_rng(5)
    b = Builder()
    fine = level == 0
    middle = np.array([0.0, 0.0, 0.60])
    lumps = _heap(rng, 17, middle, np.array([0.33, 0.33, 0.37]), 0.135)
    lumps = np.concatenate([lumps, [[0.02, 0.0, 0.62, 0.24]]])
    fork = np.array([0.0, 0.0, 0.30])
    z = np.array([0.0, 0.05, 0.18, 0.30, 0.55]) - 0.015
    trunk = np.stack([0.012 * np.sin(9 * z), 0.01 * np.cos(11 * z) - 0.01, z], 1)
    b.tube(trunk, np.array([0.030, 0.021, 0.018, 0.015, 0.005]), 7 if fine else 4, np.zeros(5), sky=0.5)
    for lump in lumps[: 17 if fine else 6]:
        start = fork + UP * rng.uniform(-0.04, 0.14)
        end = lump[:3]
        knee = 0.5 * (start + end) - 0.03 * UP
        b.tube(np.stack([start, knee, end]), np.array([0.008, 0.006, 0.002]), 4, np.zeros(3), sky=0.35)
    _crown(b, rng, lumps, 700 if fine else 210, 0.058 if fine else 0.088, middle, 0.16)
    return b.mesh()


@lru_cache
def shrub(level: int = 0) -> Mesh:
    """A bush: leaves from the ground up."""
    rng = np.random.default_rng(8)
    b = Builder()
    fine = level == 0
    middle = np.array([0.0, 0.0, 0.25])
    lumps = _heap(rng, 9, np.array([0.0, 0.0, 0.42]), np.array([0.62, 0.62, 0.45]), 0.27)
    lumps[:, 2] = np.maximum(lumps[:, 2], 0.16)
    if fine:
        for lump in lumps:
            points = np.stack([np.zeros(3), 0.5 * lump[:3] - [0, 0, 0.06], lump[:3]])
            b.tube(points, np.array([0.022, 0.016, 0.006]), 3, np.zeros(3), sky=0.35)
    _crown(b, rng, lumps, 130 if fine else 52, 0.155 if fine else 0.20, middle, 0.02)
    return b.mesh()


@lru_cache
def juniper(level: int = 0) -> Mesh:
    """A small tree of dry land: crooked stems, a dense crown that almost reaches the ground."""
    rng = np.random.default_rng(14)
    b = Builder()
    fine = level == 0
    middle = np.array([0.0, 0.0, 0.50])
    lumps = _heap(rng, 10, middle, np.array([0.46, 0.46, 0.47]), 0.19)
    lumps[:, 2] = np.maximum(lumps[:, 2], 0.25)
    lumps = np.concatenate([lumps, [[0.0, 0.0, 0.55, 0.28]]])
    for lump in lumps[: 7 if fine else 3]:
        knee = 0.45 * lump[:3] + np.array([0.03, -0.04, 0.04])
        stem = np.stack([-0.03 * UP, knee, lump[:3]])
        b.tube(stem, np.array([0.045, 0.03, 0.008]), 5 if fine else 3, np.zeros(3), sky=0.4)
    _crown(b, rng, lumps, 300 if fine else 110, 0.095 if fine else 0.135, middle, 0.10)
    return b.mesh()


# ---- rock ------------------------------------------------------------------------------------------------


def _ball(level: int) -> tuple[np.ndarray, np.ndarray]:
    """An icosahedron, every triangle cut in four `level` times: unit directions and triangles."""
    g = (1 + np.sqrt(5)) / 2
    points = [(-1, g, 0), (1, g, 0), (-1, -g, 0), (1, -g, 0), (0, -1, g), (0, 1, g), (0, -1, -g), (0, 1, -g),
              (g, 0, -1), (g, 0, 1), (-g, 0, -1), (-g, 0, 1)]  # fmt: skip
    faces = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2),
             (10, 7, 6), (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5),
             (2, 4, 11), (6, 2, 10), (8, 6, 7), (9, 8, 1)]  # fmt: skip
    v, f = _unit(np.array(points, float)), np.array(faces)
    for _ in range(level):
        edges = np.sort(f[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), 1)
        unique, index = np.unique(edges, axis=0, return_inverse=True)
        a, c, e = (len(v) + index.reshape(-1, 3)).T
        v = np.concatenate([v, _unit(v[unique[:, 0]] + v[unique[:, 1]])])
        f = np.concatenate([np.stack(t, 1) for t in (
            (f[:, 0], a, e), (f[:, 1], c, a), (f[:, 2], e, c), (a, c, e))])  # fmt: skip
    return v, f


@lru_cache
def rock(level: int = 0) -> Mesh:
    """A boulder: a ball that planes have cut, weathered, a third of it under the ground."""
    rng = np.random.default_rng(3)
    directions, faces = _ball(3 - level)
    planes = _unit(rng.normal(size=(15, 3)) * [1.0, 1.0, 0.8])
    distance = rng.uniform(0.55, 0.86, 15)
    cut = distance / np.maximum(directions @ planes.T, 1e-3)
    radius = np.minimum(-np.log(np.exp(-70 * np.minimum(cut, 2.0)).sum(1)) / 70, 1.0)
    for scale, height in ((2.2, 0.10), (5.0, 0.06), (11.0, 0.035)):
        wave, shift = rng.normal(size=(6, 3)) * scale, rng.uniform(0, 2 * np.pi, 6)
        radius = radius + height * np.sin(directions @ wave.T + shift).mean(1)
    places = directions * radius[:, None] * [0.8, 0.62, 0.62]
    corners = places[faces]
    flat = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals = np.zeros_like(places)
    for k in range(3):
        np.add.at(normals, faces[:, k], flat)
    places = 1.2 * places + 0.36 * UP
    sky = np.clip(0.35 + 0.65 * places[:, 2] / 0.5, 0.25, 1.0) * (0.7 + 0.3 * _unit(normals)[:, 2])
    fold = np.abs(directions).sum(1, keepdims=True)
    uv = (
        0.5 + 0.5 * directions[:, :2] / fold
    )  # an octahedron unfolded: the lower half lies over the upper one
    b = Builder()
    b.add(places, normals, 3.0 * uv, faces, sky=sky, bend=0.0, phase=0.0, leaf=0.0)
    return b.mesh()
