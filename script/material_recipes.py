"""How each base material is made: from a canvas to height (in any unit) and tone (relative colour)."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from material_tools import Canvas, blurred, pebble, steps, stone

Made = tuple[np.ndarray, np.ndarray]


def greys(spread: float, warmth: float = 0.06) -> Callable[[np.random.Generator], np.ndarray]:
    """Colours of stones: their own brightness, and a little warmer or cooler."""

    def colour(random: np.random.Generator) -> np.ndarray:
        warm = warmth * random.standard_normal()
        return np.exp(spread * random.standard_normal()) * np.array([1 + warm, 1.0, 1 - warm])

    return colour


def paint(tone: np.ndarray, share: np.ndarray, colour: tuple[float, float, float]) -> None:
    """Mix a colour over a tone, in place."""
    tone += share[..., None] * (np.array(colour) - tone)


def whole(canvas: Canvas, field: np.ndarray | float = 1.0) -> np.ndarray:
    """A grey tone."""
    return np.ones((canvas.side, canvas.side, 3)) * np.asarray(field)[..., None]


def sandstone(c: Canvas) -> Made:
    """Fine beds, some of them cross-bedded and some weathered out, with pits and a few joints."""
    sag = 0.02 * c.noise(2, 4) + 0.004 * c.noise(8, 4)
    depth = c.y + sag
    beds = np.zeros_like(depth)
    for k, (count, weight) in enumerate([(9, 1.0), (23, 0.7), (53, 0.45), (127, 0.25)]):
        table = c.random.standard_normal(count)
        place = (depth + 0.37 * k) * count % count
        low = place.astype(int) % count
        t = steps(place - np.floor(place), 0.35, 1.0)
        beds += weight * (table[low] * (1 - t) + table[(low + 1) % count] * t)
    cross = np.sin(2 * np.pi * (40 * c.y + 13 * c.x + 3 * c.noise(3, 3) * 0.3)) * steps(
        c.noise((1, 5), 3), 0.2, 0.9
    )
    grain, rough = c.noise(96, 3), c.noise(12, 6, 0.55)
    pits = steps(c.noise((18, 40), 2), 1.3, 2.2)
    joints = 1 - steps(c.walls((3, 2), 0.04), 0.0, 0.025)
    height = 0.55 * beds + 0.12 * cross + 0.25 * rough + 0.03 * grain - 0.8 * pits - 1.2 * joints
    tone = whole(c, 1 + 0.07 * beds + 0.06 * cross + 0.05 * rough + 0.05 * grain - 0.2 * pits)
    paint(tone, 0.35 * steps(c.noise((3, 11), 4) + 0.6 * beds, 0.8, 2.2), (1.12, 0.86, 0.74))
    paint(tone, 0.45 * steps(c.noise((40, 3), 5), 0.9, 2.4), (0.62, 0.58, 0.56))  # streaks that water left
    return height, tone


def limestone(c: Canvas) -> Made:
    """Thick beds that break off in steps, fluted and pitted by rain, with lichen."""
    depth = c.y + 0.012 * c.noise(3, 4) + 0.004 * c.noise(16, 3)
    count = 7
    table = c.random.random(count) * 1.2
    bed = (depth * count) % count
    edge = bed - np.floor(bed)
    steps_ = table[bed.astype(int) % count] + 0.5 * edge
    gap = np.exp(-((np.minimum(edge, 1 - edge) / 0.035) ** 2))
    joints = 1 - steps(c.walls((5, 7), 0.05), 0.0, 0.04)
    flutes = np.abs(c.noise((24, 4), 3))
    rough, fine = c.noise(10, 7, 0.55), c.noise(70, 3)
    pits = steps(c.walls(36, 0.2), 0.55, 0.9) * steps(c.noise(5, 3), 0.0, 1.0)
    height = 0.9 * steps_ + 0.3 * rough + 0.16 * flutes - 0.7 * gap - 0.5 * joints - 0.35 * pits + 0.03 * fine
    tone = whole(c, 1 + 0.09 * rough + 0.04 * fine - 0.25 * gap - 0.2 * joints - 0.1 * pits)
    paint(tone, 0.5 * steps(c.noise(9, 6), 0.9, 1.7), (0.60, 0.60, 0.58))
    paint(tone, 0.35 * steps(c.noise(14, 6), 1.4, 2.0), (1.10, 0.98, 0.70))
    return height, tone


def granite(c: Canvas) -> Made:
    """Rounded blocks between joints, crystals, lichen."""
    big = c.walls((2, 3), 0.03)
    level = blurred(c.noise(3, 2), 20)
    joints = 1.1 * np.sqrt(steps(big, 0.0, 0.30)) - 0.5 * (1 - steps(big, 0.0, 0.02))
    sheets = np.abs(c.noise((2, 3), 4))
    cracks = 1 - steps(sheets, 0.0, 0.025)
    rough, lumps, crystal = c.noise(24, 6, 0.6), c.noise(5, 4, 0.45), c.walls(150)
    height = joints + 0.7 * level + 0.35 * lumps + 0.10 * rough - 0.25 * cracks + 0.05 * crystal
    tone = whole(c, 1 + 0.04 * rough + 0.05 * lumps + 0.45 * (crystal - crystal.mean()) - 0.2 * cracks)
    paint(tone, 0.55 * (c.noise(170, 1) > 1.2), (0.40, 0.38, 0.38))
    paint(tone, 0.30 * (c.noise(140, 1) > 1.0), (1.25, 1.08, 0.98))
    paint(tone, 0.65 * steps(c.noise(9, 7, 0.65), 0.9, 1.3), (0.52, 0.54, 0.50))
    paint(tone, 0.5 * steps(c.noise(14, 7, 0.65), 1.7, 2.0), (1.0, 1.04, 0.66))
    paint(tone, 0.35 * steps(c.noise((10, 3), 4), 0.5, 2.0) * (1 - cracks), (0.70, 0.68, 0.66))
    paint(tone, 0.3 * steps(c.noise(3, 3), 0.3, 2.0), (1.14, 0.98, 0.84))
    return height, tone


def scree(c: Canvas) -> Made:
    """Angular stones piled on each other, dark between them."""
    height, tone = 0.02 * c.noise(6, 4), whole(c, 0.45)
    c.strew(height, tone, 2600, (0.03, 0.10), stone(6), greys(0.16))
    c.strew(height, tone, 620, (0.07, 0.32), stone(6), greys(0.18), power=3.0)
    c.strew(height, tone, 900, (0.025, 0.07), stone(5), greys(0.2))
    rough = c.noise(40, 5, 0.6)
    paint(tone, 0.25 * steps(c.noise(24, 5), 0.8, 1.5), (0.62, 0.62, 0.58))
    return height + 0.003 * rough, tone * (1 + 0.09 * rough)[..., None]


def gravel(c: Canvas) -> Made:
    """Rounded and broken pebbles in sand."""
    height, tone = 0.003 * c.noise(8, 6), whole(c, 0.8 + 0.08 * c.noise(120, 2))
    c.strew(height, tone, 6500, (0.006, 0.018), pebble, greys(0.22, 0.09))
    c.strew(height, tone, 900, (0.012, 0.05), pebble, greys(0.25, 0.1), power=3.0)
    c.strew(height, tone, 400, (0.01, 0.03), stone(5), greys(0.25, 0.1))
    c.strew(height, tone, 2500, (0.004, 0.012), pebble, greys(0.25, 0.1))
    return height, tone * (1 + 0.06 * c.noise(90, 3))[..., None]


def sand(c: Canvas) -> Made:
    """Wind ripples, steep to the lee, that fork and end."""
    bend = 0.55 * c.noise(2, 3) + 0.22 * c.noise((9, 5), 2)
    phase = (c.x * 30 + bend) % 1.0
    ripple = np.where(phase < 0.68, np.sin(np.pi * phase / 1.36), np.cos(np.pi * (phase - 0.68) / 0.64))
    ripple = blurred(ripple, 5.0) * (0.75 + 0.22 * c.noise(5, 3))
    grain = c.noise(200, 2)
    height = 0.008 * ripple + 0.0022 * c.noise(3, 4) + 0.00016 * grain
    tone = whole(c, 1 + 0.05 * (ripple - ripple.mean()) + 0.035 * grain + 0.03 * c.noise(5, 5))
    paint(tone, 0.5 * (c.noise(220, 1) > 2.1), (0.55, 0.52, 0.5))
    return height, tone


def soil(c: Canvas) -> Made:
    """Clods and crumbs, some straw and pebbles."""
    height, tone = 0.006 * c.noise(6, 7, 0.6), whole(c, 0.85 + 0.08 * c.noise(60, 4))

    def clod(u: np.ndarray, v: np.ndarray, random: np.random.Generator) -> np.ndarray:
        lumps = 0.16 * np.sin(5 * u + 9 * random.random()) * np.sin(5 * v + 9 * random.random())
        return 0.75 - 0.9 * (u * u + v * v * random.uniform(1.0, 1.7)) + lumps

    c.strew(height, tone, 900, (0.008, 0.045), clod, greys(0.14, 0.04), power=3.0)
    c.strew(height, tone, 5000, (0.004, 0.014), clod, greys(0.16, 0.04))
    c.strew(height, tone, 60, (0.006, 0.02), pebble, greys(0.3, 0.05))
    straw = 260
    roots, length = c.random.random((straw, 2)) * c.side, c.random.uniform(0.03, 0.1, straw)
    yellow = np.array([1.9, 1.75, 1.4]) * c.random.uniform(0.6, 1.0, (straw, 1))
    c.streaks(height, tone, roots, length, np.full(straw, 0.004), yellow, 0.2)
    height += 0.0012 * c.noise(80, 4)
    return height, tone * (1 + 0.1 * c.noise(70, 4))[..., None]


def blades(
    c: Canvas,
    height: np.ndarray,
    tone: np.ndarray,
    count: int,
    length: tuple[float, float],
    rise: float,
    colours: list[tuple[float, float, float]],
    clump: np.ndarray,
) -> None:
    """Grass: blades that stand denser and longer where `clump` (0…1) is high."""
    roots = c.random.random((3 * count, 2)) * c.side
    here = clump[roots[:, 0].astype(int), roots[:, 1].astype(int)]
    kept = c.random.random(3 * count) < 0.15 + 0.85 * here
    roots, here = roots[kept][:count], here[kept][:count]
    n = len(roots)
    longest = c.random.uniform(*length, n) * (0.5 + 0.7 * here)
    pick = np.array(colours)[c.random.integers(0, len(colours), n)]
    shade = pick * np.exp(0.22 * c.random.standard_normal((n, 1)))
    c.streaks(height, tone, roots, longest, rise * longest, shade, 0.7, thick=2)


BLADES = [(0.9, 1.0, 0.85), (1.05, 1.05, 0.8), (0.8, 0.95, 0.8), (1.3, 1.15, 1.1), (0.75, 0.9, 0.9)]


def grass(c: Canvas) -> Made:
    """Tufts of blades, dead ones among them, down to dark ground."""
    clump = np.clip(0.5 + 0.33 * c.noise(7, 3), 0, 1)
    height, tone = 0.004 * c.noise(8, 3) + 0.012 * clump, whole(c, 0.45)
    tone *= np.array([1.1, 0.95, 0.9])
    blades(c, height, tone, 12000, (0.04, 0.12), 0.25, [*BLADES, (1.7, 1.4, 1.5), (1.3, 1.1, 1.1)], clump)
    blades(c, height, tone, 9000, (0.05, 0.16), 0.4, BLADES, clump)
    height = 0.5 * height + 0.5 * blurred(height, 4) - 0.6 * blurred(height, 40)
    patch = c.noise(6, 4)
    return height, tone * (1 + 0.10 * patch[..., None] * np.array([1.0, 0.5, 0.6]))


def turf(c: Canvas) -> Made:
    """Short alpine grass with cushions, bare earth and stones in it."""
    clump = np.clip(0.5 + 0.4 * c.noise(6, 4), 0, 1)
    height, tone = 0.012 * clump + 0.003 * c.noise(24, 4), whole(c, 0.55 + 0.06 * c.noise(50, 3))
    tone *= np.array([1.15, 0.95, 0.95])
    c.strew(height, tone, 70, (0.01, 0.05), stone(6, 0.45), greys(0.2, 0.04), power=3.0, sink=0.25)
    tone *= (1 + 0.06 * c.noise(60, 4))[..., None]

    def cushion(u: np.ndarray, v: np.ndarray, random: np.random.Generator) -> np.ndarray:
        return 0.45 * (1 - u * u - v * v * random.uniform(1, 1.5))

    c.strew(
        height, tone, 130, (0.02, 0.07), cushion, lambda r: np.array([0.75, 0.95, 0.75]) * r.uniform(0.8, 1.2)
    )
    blades(c, height, tone, 13000, (0.02, 0.06), 0.5, [*BLADES, (1.6, 1.3, 1.2), (1.4, 1.2, 1.1)], clump)
    return 0.6 * height + 0.4 * blurred(height, 3), tone


def forest_floor(c: Canvas) -> Made:
    """Fallen leaves over each other, twigs, needles, moss, a root."""
    height = 0.015 * c.noise(4, 5)
    root = np.abs(c.noise(2, 3))
    height += 0.05 * np.sqrt(np.maximum(0.0, 1 - (root / 0.09) ** 2))
    tone = whole(c, 0.5 + 0.06 * c.noise(80, 3))
    paint(tone, steps(-root, -0.09, -0.07), (0.75, 0.72, 0.75))
    paint(tone, 0.8 * steps(c.noise(4, 5), 0.9, 1.4), (0.55, 0.95, 0.5))

    def leaf(u: np.ndarray, v: np.ndarray, random: np.random.Generator) -> np.ndarray:
        wide = random.uniform(0.35, 0.6) * (1 - u * u) * (1 + 0.25 * np.cos(9 * u))
        fold = random.uniform(0.1, 0.5) * np.abs(v) + random.uniform(-0.25, 0.25) * u + 0.2 * random.random()
        return np.where((np.abs(v) < wide) & (np.abs(u) < 1), 0.12 + np.maximum(fold, 0.0), -1.0)

    browns = np.array(
        [(1.0, 0.9, 0.75), (1.35, 1.1, 0.7), (1.5, 0.95, 0.55), (0.7, 0.65, 0.6), (1.7, 1.5, 0.8)]
    )

    def fallen(random: np.random.Generator) -> np.ndarray:
        return browns[random.choice(5, p=[0.35, 0.25, 0.12, 0.2, 0.08])] * np.exp(
            0.2 * random.standard_normal()
        )

    c.strew(height, tone, 2600, (0.018, 0.045), leaf, fallen, sink=0.05)
    twigs = 160
    roots, length = c.random.random((twigs, 2)) * c.side, c.random.uniform(0.05, 0.3, twigs)
    bark = np.array([0.7, 0.62, 0.6]) * c.random.uniform(0.6, 1.4, (twigs, 1))
    c.streaks(height, tone, roots, length, np.full(twigs, 0.012), bark, 0.5, 160, 3)
    c.strew(height, tone, 1100, (0.02, 0.05), leaf, fallen, sink=0.02)
    height += 0.001 * c.noise(90, 3)
    return height, tone * (1 + 0.07 * c.noise(100, 3))[..., None]


def crown(ragged: np.ndarray, c: Canvas) -> Callable[..., np.ndarray]:
    """The top of a tree: a dome that breaks up into boughs."""

    def form(u: np.ndarray, v: np.ndarray, random: np.random.Generator) -> np.ndarray:
        away = np.hypot(u, v * random.uniform(0.95, 1.25))
        angle = np.arctan2(v, u)
        lobes = random.integers(4, 8)
        edge = 1.0 + 0.13 * np.cos(lobes * angle + 6.3 * random.random()) + 0.07 * np.cos(
            (2 * lobes + 1) * angle + 6.3 * random.random())  # fmt: skip
        start = random.integers(0, c.side, 2)
        own = ragged[
            np.ix_((start[0] + np.arange(u.shape[0])) % c.side, (start[1] + np.arange(u.shape[1])) % c.side)
        ]
        away = away / edge + 0.10 * own
        dome = np.sqrt(np.maximum(1.0 - away * away, 0.0))
        return np.where(away < 1.0, 0.15 + dome * random.uniform(0.8, 1.25) + 0.09 * own, -1.0)

    return form


def canopy(c: Canvas) -> Made:
    """A wood from above: crowns of all sizes and several kinds, dark gaps."""
    height, tone = 0.4 * c.noise(6, 3), whole(c, 0.28)
    boughs = 0.7 * c.noise(40, 4, 0.6) + 0.7 * c.noise(64, 3, 0.7)
    kinds = np.array(
        [(0.95, 1.0, 0.9), (1.2, 1.0, 0.8), (0.75, 0.92, 0.85), (1.5, 1.02, 0.72), (0.62, 0.8, 0.8)]
    )

    def foliage(random: np.random.Generator) -> np.ndarray:
        return kinds[random.choice(5, p=[0.4, 0.2, 0.2, 0.08, 0.12])] * np.exp(
            0.26 * random.standard_normal()
        )

    form = crown(boughs, c)
    c.strew(height, tone, 260, (1.0, 2.2), form, foliage, sink=0.0)
    c.strew(height, tone, 210, (2.0, 5.6), form, foliage, power=1.6, sink=0.0, lift=1.5)
    leaves = c.noise(150, 2)
    height += 0.25 * leaves
    return height, tone * np.maximum(1 + 0.16 * boughs + 0.12 * leaves, 0.3)[..., None]


def shrubs(c: Canvas) -> Made:
    """Bushes with bare and grassy ground between them."""
    height = 0.06 * c.noise(4, 6) + 0.008 * c.noise(60, 4)
    patch = c.noise(6, 5)
    tone = whole(c, 1.15 + 0.1 * c.noise(40, 5, 0.6))
    paint(tone, 0.6 * steps(patch, -0.2, 1.0), (1.0, 1.05, 0.8))
    c.strew(height, tone, 500, (0.03, 0.13), stone(6), greys(0.2), power=4.0)
    boughs = 0.7 * c.noise(60, 4, 0.7) + 0.7 * c.noise(128, 2)
    kinds = np.array([(0.7, 0.85, 0.7), (0.85, 0.85, 0.75), (0.6, 0.72, 0.62), (1.15, 0.95, 0.8)])

    def foliage(random: np.random.Generator) -> np.ndarray:
        return kinds[random.integers(0, 4)] * np.exp(0.18 * random.standard_normal())

    form = crown(boughs, c)
    c.strew(height, tone, 420, (0.10, 0.3), form, foliage, sink=0.15)
    c.strew(height, tone, 130, (0.3, 1.0), form, foliage, sink=0.1)
    leaves = c.noise(200, 2)
    return height + 0.02 * leaves, tone * np.maximum(1 + 0.13 * boughs + 0.1 * leaves, 0.3)[..., None]


def dust(c: Canvas) -> Made:
    """Fine dust with faint ripples, small stones half buried in it."""
    phase = 2 * np.pi * (22 * c.y + 0.6 * c.noise(3, 3))
    ripple = np.sin(phase) * np.clip(0.4 + 0.5 * c.noise(3, 3), 0, 1)
    fine = c.noise(160, 3)
    height = 0.006 * c.noise(3, 6) + 0.0022 * ripple + 0.0003 * fine
    tone = whole(c, 1 + 0.03 * c.noise(6, 6) + 0.025 * fine + 0.02 * ripple)

    def dark(random: np.random.Generator) -> np.ndarray:
        return np.array([0.55, 0.68, 0.8]) * np.exp(0.25 * random.standard_normal())

    c.strew(height, tone, 500, (0.008, 0.02), stone(5), dark, sink=0.25)
    c.strew(height, tone, 90, (0.015, 0.075), stone(6), dark, power=3.0, sink=0.25)
    return height, tone


def basalt(c: Canvas) -> Made:
    """Broken lava: blocks between cooling cracks, full of bubbles, dust in the joints."""
    blocks = c.walls((6, 7), 0.06)
    level = blurred(c.noise(7, 1), 8)
    cracks = steps(blocks, 0.0, 0.10)
    rough = c.noise(10, 7, 0.6)
    bubbles = steps(c.walls(90, 0.1), 0.62, 0.95) * steps(c.noise(5, 3), -0.6, 0.6)
    height = 0.9 * cracks + 0.5 * level + 0.3 * rough - 0.22 * bubbles
    tone = whole(c, 1 + 0.1 * rough + 0.05 * c.noise(120, 2) - 0.25 * bubbles)
    paint(tone, 0.6 * (1 - cracks) + 0.3 * steps(c.noise(6, 5) - 0.5 * rough, 0.6, 1.8), (1.7, 1.3, 1.05))
    return height, tone


def mud(c: Canvas) -> Made:
    """Dried mud: plates with curled edges between cracks."""
    plates, fine_plates = c.walls(9, 0.03), c.walls(22, 0.03)
    crack = steps(plates, 0.015, 0.07)
    small = steps(fine_plates, 0.0, 0.05) * 0.25
    curl = np.exp(-plates / 0.12)
    fine = c.noise(30, 6, 0.6)
    level = blurred(c.noise(9, 1), 6)
    height = crack * (1 + 0.35 * curl + 0.25 * level) + small + 0.06 * fine
    tone = whole(c, 0.55 + 0.45 * crack + 0.06 * fine + 0.08 * level + 0.05 * curl)
    paint(tone, 0.25 * steps(c.noise(4, 5), 0.4, 1.6), (1.2, 1.12, 1.0))
    return height, tone


_ROCKS = (sandstone, limestone, granite, scree, gravel, sand, basalt, dust, mud)
_GREENS = (soil, grass, turf, forest_floor, canopy, shrubs)
RECIPES: dict[str, Callable[[Canvas], Made]] = {recipe.__name__: recipe for recipe in (*_ROCKS, *_GREENS)}
