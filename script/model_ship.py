"""The ship: five kilometres from prow to engines, plated, with trenches, a tower and nine engine bells.

Axes are glTF's: x left, y up, z forward, metres; the origin is amidships. Flat plates have no normals in the
file (glTF then asks for those of the triangles), and positions are whole multiples of eight centimetres: so
the file is small.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from model_shapes import Glb, Surface, grid, join, steps
from model_ship_plates import METRES, paint

QUANTUM = 0.08

# Along the hull: z, half width, height of the deck, depth of the keel, m. Two at one place make a step.
HULL = np.array(
    [
        (2500, 20, 12, 30), (2440, 95, 34, 78), (2150, 170, 70, 120), (1750, 228, 104, 150),
        (1750, 205, 92, 138), (1690, 205, 92, 138), (1690, 240, 112, 158), (900, 305, 150, 205),
        (900, 275, 130, 185), (800, 275, 130, 185), (800, 322, 165, 220), (150, 345, 185, 240),
        (150, 300, 150, 200), (-30, 300, 150, 200), (-30, 365, 205, 255), (-900, 395, 235, 270),
        (-900, 360, 205, 240), (-990, 360, 205, 240), (-990, 470, 265, 300), (-1750, 490, 280, 305),
        (-2050, 420, 235, 255), (-2050, 350, 200, 215), (-2220, 320, 180, 190),
    ],
    float,
)  # fmt: skip

# One half of the outline, from the middle of the deck to that of the keel: shares of half width and height.
OUTLINE = np.array(
    [
        (0.0, 1.0), (0.16, 1.0), (0.20, 0.86), (0.36, 0.84), (0.42, 0.92), (0.56, 0.86), (0.90, 0.34),
        (1.0, 0.16), (1.0, 0.09), (0.89, 0.07), (0.89, -0.09), (1.0, -0.11), (0.96, -0.34), (0.62, -0.88),
        (0.34, -0.98), (0.30, -0.86), (0.12, -0.86), (0.08, -1.0), (0.0, -1.0),
    ]
)  # fmt: skip


def outline(station: np.ndarray) -> np.ndarray:
    """The whole outline of a station, (n, 3), from the keel over the left side and round."""
    z, wide, top, bottom = station
    half = np.stack([OUTLINE[:, 0] * wide, np.where(OUTLINE[:, 1] > 0, top, bottom) * OUTLINE[:, 1]], 1)
    right = half * (-1, 1)
    ring = np.concatenate([half[::-1], right[1:]])
    return np.column_stack([ring, np.full(len(ring), z)])


def quads(corners: np.ndarray) -> Surface:
    """Flat quads (n, 4, 3), counter-clockwise from outside, with plates."""
    n = len(corners)
    along = corners[:, 1] - corners[:, 0]
    across = np.cross(along, corners[:, 3] - corners[:, 0])
    facing = np.abs(across).argmax(1)
    # seen along the axis it faces most, so that plates run on: decks x z, sides z y, ends x y
    pick = np.array([(2, 1), (0, 2), (0, 1)])[facing]
    uv = np.take_along_axis(corners, pick[:, None, :].repeat(4, 1), 2) / METRES
    first = 4 * np.arange(n)[:, None]
    triangles = np.concatenate([first + np.array(turn) for turn in ((0, 1, 2), (0, 2, 3))])
    return Surface(corners.reshape(-1, 3), triangles, uv.reshape(-1, 2))


def boxes(centre: np.ndarray, half: np.ndarray, axes: np.ndarray, taper: np.ndarray | float = 1.0) -> Surface:
    """Boxes without a lower side: middles of the foot (n, 3), half sizes and height (n, 3), axes (n, 3, 3).

    `axes` rows are the two directions of the foot and the outward normal; the top is smaller by `taper`.
    """
    corner = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)], float)
    taper = np.broadcast_to(taper, len(centre))[:, None, None]
    flat = corner * half[:, None, :2]
    foot = centre[:, None] + flat @ axes[:, :2]
    top = centre[:, None] + (flat * taper) @ axes[:, :2] + (half[:, 2:] * axes[:, 2])[:, None]
    sides = [
        np.stack([foot[:, i], foot[:, j], top[:, j], top[:, i]], 1)
        for i, j in ((0, 1), (1, 2), (2, 3), (3, 0))
    ]
    return quads(np.concatenate([*sides, top]))


def hull() -> np.ndarray:
    """The plated body as quads (n, 4, 3)."""
    rings = np.stack([outline(station) for station in HULL])
    found = []
    for front, back in pairwise(rings):
        parts = max(1, int(abs(front[0, 2] - back[0, 2]) // 210))
        t = steps(parts + 1)[:, None, None]
        cuts = front + (back - front) * t
        for a, b in pairwise(cuts):
            found.append(np.stack([a[:-1], b[:-1], b[1:], a[1:]], 1))
    stern = rings[-1]
    middle = np.broadcast_to(stern.mean(0), stern[:-1].shape)
    found.append(np.stack([stern[:-1], middle, middle, stern[1:]], 1))
    corners = np.concatenate(found)
    size = np.linalg.norm(np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]), axis=1)
    return corners[size > 1.0]


def shades(corners: np.ndarray) -> dict[str, np.ndarray]:
    """Which quads of the hull wear which paint."""
    x, y, z = corners.mean(1).T
    wide = np.interp(-z, -HULL[:, 0], HULL[:, 1])
    steep = corners[..., 2].max(1) - corners[..., 2].min(1) < 1.0
    ring = np.zeros(len(z), bool)
    for low, high in ((1690, 1750), (800, 900), (-30, 150), (-990, -900), (-2220, -2050)):
        ring |= (z > low) & (z < high)
    trench = (np.abs(y) < 25.0) & (np.abs(x) > 0.80 * wide)
    belly = (y < -0.75 * np.interp(-z, -HULL[:, 0], HULL[:, 3])) & (np.abs(x) < 0.32 * wide)
    dark = ring | trench | belly | steep
    band = ~dark & (((z > 1230) & (z < 1420)) | ((z > -1260) & (z < -1130)))
    return {"dark": dark, "band": band, "pale": ~dark & ~band}


def frames(corners: np.ndarray) -> np.ndarray:
    """For each quad its directions: along its first side, across it, outwards; (n, 3, 3)."""
    along = corners[:, 1] - corners[:, 0]
    along = along / np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-9)
    out = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    out = out / np.maximum(np.linalg.norm(out, axis=1, keepdims=True), 1e-9)
    return np.stack([along, np.cross(out, along), out], 1)


def clutter(corners: np.ndarray, rng: np.random.Generator, count: int) -> Surface:
    """Boxes of all sizes on the hull's plates, more where those are large, in clusters."""
    sides = (
        np.linalg.norm(corners[:, 1] - corners[:, 0], axis=1),
        np.linalg.norm(corners[:, 3] - corners[:, 0], axis=1),
    )
    area = sides[0] * sides[1]
    density = area * rng.lognormal(0.0, 0.9, len(corners))
    density[np.minimum(*sides) < 12.0] = 0.0
    which = rng.choice(len(corners), count, p=density / density.sum())
    u, v = rng.uniform(0.12, 0.88, (2, count))
    snap = rng.random(count) < 0.6  # rows of things that somebody ordered
    u = np.where(snap, np.round(u * 7.0) / 7.0 * 0.8 + 0.1, u)[:, None]
    v = np.where(snap, np.round(v * 5.0) / 5.0 * 0.8 + 0.1, v)[:, None]
    c = corners[which]
    foot = (1 - u) * ((1 - v) * c[:, 0] + v * c[:, 3]) + u * ((1 - v) * c[:, 1] + v * c[:, 2])
    size = np.exp(rng.normal(2.3, 0.75, (count, 2)))
    limit = 0.20 * np.stack([sides[0][which], sides[1][which]], 1)
    size = np.minimum(size, limit)
    height = np.minimum(rng.lognormal(1.9, 0.7, count), 1.6 * size.min(1))[:, None]
    return boxes(
        foot - 0.5 * frames(c)[:, 2], np.hstack([size, height]), frames(c), rng.choice([1.0, 0.8, 0.6], count)
    )


def tower() -> Surface:
    """The bridge: blocks on blocks behind the middle, with wings and masts."""
    upright = np.array([[(0, 0, 1), (1, 0, 0), (0, 1, 0)]], float)
    blocks = [  # z, height of the foot, half length, half width, height, taper, x
        (-1330, 255, 330, 170, 75, 0.86, 0), (-1360, 325, 230, 120, 70, 0.85, 0),
        (-1400, 390, 150, 82, 95, 0.80, 0), (-1390, 482, 92, 150, 26, 0.90, 0),
        (-1390, 506, 66, 74, 48, 0.70, 0), (-1440, 550, 22, 22, 110, 0.30, 0),
        (-1410, 550, 12, 12, 70, 0.30, 38), (-1410, 550, 12, 12, 70, 0.30, -38),
        (-1640, 262, 70, 260, 40, 0.80, 0), (-1150, 262, 60, 300, 26, 0.85, 0),
        (-430, 215, 190, 95, 38, 0.80, 0), (-430, 250, 110, 55, 34, 0.75, 0),
        (520, 160, 130, 70, 30, 0.75, 0), (1180, 118, 110, 48, 26, 0.70, 0),
    ]  # fmt: skip
    made = []
    for z, foot, length, width, height, taper, x in blocks:
        centre, half = np.array([[x, foot - 4.0, z]], float), np.array([[length, width, height]], float)
        made.append(boxes(centre, half, upright, taper))
    # turrets in two rows along the deck, radiators as fins at the stern
    rows = [(side * 0.48, z) for z in np.arange(-800.0, 1500.0, 190.0) for side in (-1, 1)]
    for share, z in rows:
        wide, deck = (np.interp(-z, -HULL[:, 0], HULL[:, column]) for column in (1, 2))
        centre = np.array([[share * wide, 0.86 * deck, z]])
        made.append(boxes(centre, np.array([[34.0, 26.0, 24.0]]), upright, 0.72))
        made.append(boxes(centre + np.array([0.0, 12.0, 48.0]), np.array([[46.0, 4.0, 7.0]]), upright, 1.0))
    for side in (-1, 1):
        for z in np.arange(-1950.0, -1150.0, 115.0):
            out = np.array([[(0, 0, 1), (0, side, 0), (side, 0, 0)]], float)
            made.append(
                boxes(np.array([[side * 462.0, -105.0, z]]), np.array([[26.0, 92.0, 150.0]]), out, 0.74)
            )
    return join(made)


def bells() -> list[Surface]:
    """The engines: three great bells and six small ones, inside and outside, smooth."""
    made = []
    places = [(0.0, 0.0, 118.0)] + [(x, 0.0, 104.0) for x in (-232.0, 232.0)]
    places += [(x, y, 46.0) for x in (-118.0, 118.0) for y in (-128.0, 118.0)] + [
        (0.0, y, 44.0) for y in (-165.0, 158.0)
    ]
    s = steps(11)
    for x, y, radius in places:
        outside = np.stack([radius * (0.52 + 0.48 * np.sqrt(s)), -2170.0 - 2.9 * radius * s], 1)
        lip = outside[-1:] * (0.95, 1.0)
        inside = outside[::-1] * (0.93, 1.0)
        inside[-1, 0] = 0.0
        angle = 2.0 * np.pi * steps(37)[:, None]
        for profile in (outside, np.concatenate([outside[-1:], lip]), np.concatenate([lip, inside])):
            points = np.stack(
                [
                    x + profile[:, 0] * np.cos(angle),
                    y + profile[:, 0] * np.sin(angle),
                    profile[:, 1] + 0 * angle,
                ],
                2,
            )
            along = np.linspace(0.0, radius * 3.0 / METRES, len(profile)) + 0.0 * angle
            around = angle * max(round(radius / 60.0), 1) / (2 * np.pi) + 0.0 * profile[:, 0]
            made.append(grid(points, np.stack([around, along], 2), weld=True))
    return made


def build() -> Glb:
    """The whole ship."""
    rng = np.random.default_rng(2026)
    glb = Glb("ship")
    color, normal, surface = (glb.texture(p, q) for p, q in zip(paint(), (74, 84, 66), strict=True))
    textures = {"normalTexture": {"index": normal}, "occlusionTexture": {"index": surface}}
    pbr = {"baseColorTexture": {"index": color}, "metallicRoughnessTexture": {"index": surface}}

    def paint_of(name: str, factor: tuple[float, ...], **more: object) -> int:
        values = {"baseColorFactor": [*factor, 1.0], **pbr}
        return glb.material(name=name, pbrMetallicRoughness=values, **textures, **more)

    corners = hull()
    worn = shades(corners)
    pale = paint_of("pale plating", (1.0, 1.0, 1.0))
    dark = paint_of("dark plating", (0.42, 0.43, 0.46))
    band = paint_of("ochre plating", (0.95, 0.50, 0.16))
    burnt = paint_of("bells", (0.32, 0.30, 0.29), doubleSided=True)
    plates = corners[~worn["dark"]]
    glb.add(join([quads(corners[worn["pale"]]), clutter(plates, rng, 1050), tower()]), pale, QUANTUM)
    glb.add(join([quads(corners[worn["dark"]]), clutter(corners, rng, 500)]), dark, QUANTUM)
    glb.add(quads(corners[worn["band"]]), band, QUANTUM)
    glb.add(join(bells()), burnt, QUANTUM)
    return glb
