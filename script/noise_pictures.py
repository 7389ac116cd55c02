#!/usr/bin/env python3
"""Draw the pictures of docs/noise.md anew: python script/noise_pictures.py [docs/noise]"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from fallstreak import noise
from fallstreak.commands.noise import colour
from fallstreak.noise.kinds import FRACTALS, KINDS
from fallstreak.output.png import write_png

SIDE = 224
GAP = 8
HEIGHT = 0.37  # of the planes through 3-D noise: no octave has it on its lattice


def main(folder: str = "docs/noise") -> None:
    pictures = {
        **{f"kind_{name}": kind(name) for name in KINDS},
        **{f"fractal_{name}": fractal(name) for name in FRACTALS},
        "warp": warp(),
        "curl": curl(),
        "journal": journal(),
        "far": far(),
        "smooth": smooth(),
        "tile": tile(),
        "cube": cube(),
    }
    Path(folder).mkdir(parents=True, exist_ok=True)
    for name, picture in pictures.items():
        write_png(Path(folder) / f"{name}.png", picture)
        print(f"{name}.png {picture.shape[1]}×{picture.shape[0]}")


def kind(name: str) -> np.ndarray:
    """One octave, six cells across, by the range that the kind has."""
    about = KINDS[name]
    contrast = 0.8 if about.low < 0 else 1.0  # few values come near the ends
    return grey(plane(6, kind=name), contrast * about.low, contrast * about.high)


def fractal(name: str) -> np.ndarray:
    values = plane(3, octaves=8, fractal=name, seed=11)
    if name == "turbulence":  # looks as billow does: show what it is for
        values = np.sin(4 * np.pi * points(1)[0] + 14 * values)
    return grey(values)


def warp() -> np.ndarray:
    return grey(noise.warp(points(3), 1.2, 7, seed=4))


def curl() -> np.ndarray:
    """White noise smeared along the flow (Cabral and Leedom 1993): what its streamlines look like."""
    size, reach, cells = 2 * SIDE, 24, 4
    dust = np.random.default_rng(1).random((size, size))
    ticks = (np.arange(size) + 0.5) * cells / size
    total = np.zeros((size, size))
    for way in (1.0, -1.0):
        x, y = np.meshgrid(ticks, ticks)
        for _ in range(reach):
            column, row = (np.clip((p * size / cells).astype(int), 0, size - 1) for p in (x, y))
            total += dust[row, column]
            velocity = noise.curl(np.stack([x, y], -1), octaves=2, seed=3).astype(float)
            velocity /= np.maximum(np.linalg.norm(velocity, axis=-1, keepdims=True), 1e-6)
            x, y = x + way * velocity[..., 0] * cells / size, y + way * velocity[..., 1] * cells / size
    smeared = total.reshape(SIDE, 2, SIDE, 2).mean((1, 3))
    return grey(smeared, *np.percentile(smeared, (1, 99)))


def journal() -> np.ndarray:
    """Table, Improved, Perlin, simplex, lit from the left as ground: one octave above, seven below."""
    rows = []
    for octaves, cells in ((1, 10), (7, 3)):
        row = []
        for name in ("table", "improved", "perlin", "simplex"):
            finer = 0.6 if name == "simplex" else 1.0  # its cells are smaller: show features of one size
            row.append(lit(plane(finer * cells, kind=name, octaves=octaves, seed=2)))
        rows.append(beside(row))
    return beside(rows, across=False)


def far() -> np.ndarray:
    """64 m of noise with cells of 8 m, 10 000 km from the origin: float64 above, float32 below."""
    x, y = np.meshgrid(1e7 + np.arange(912) * (64 / 912), np.arange(96) * (64 / 912))
    strips = [
        noise.fbm((x.astype(t), y.astype(t), np.full_like(x, 0.3, t)), 4, frequency=1 / 8)
        for t in (np.float64, np.float32)
    ]
    low, high = strips[0].min(), strips[0].max()
    return beside([grey(strip, low, high) for strip in strips], across=False)


def smooth() -> np.ndarray:
    """A plane that recedes to the horizon, a row at a time: all octaves, and those that the row can show."""
    width, height = 452, SIDE
    parts = []
    for clamped in (False, True):
        picture = np.empty((height, width), np.float32)
        for row in range(height):
            distance = height / (row + 4.0)
            x = (np.arange(width) - width / 2) * distance / height
            ahead = np.full(width, 2.0 * distance)
            # foreshortened: rows lie farther apart than columns
            spacing = max(distance, 2.0 * distance**2) / height if clamped else None
            points = x, ahead, np.full(width, HEIGHT)
            picture[row] = noise.fbm(points, 8, frequency=3, gain=0.7, spacing=spacing)
        parts.append(grey(picture, -0.5, 0.5))
    return beside(parts)


def tile() -> np.ndarray:
    """Four copies of one tile."""
    one = grey(noise.grid((112, 112), period=4, octaves=2, kind="cellular_f2f1", seed=9))
    return np.tile(one, (2, 2))


def cube() -> np.ndarray:
    """The six faces, unfolded, and the ball they make."""
    size, options = 112, {"octaves": 10, "frequency": 1.3, "seed": 8, "gain": 0.55}
    faces = noise.cube(size, **options)
    low, high = faces.min(), faces.max()
    cross = np.full((3 * size, 4 * size, 3), 255, np.uint8)
    for face, (row, column) in enumerate(((1, 2), (1, 0), (0, 1), (2, 1), (1, 1), (1, 3))):
        part = slice(row * size, (row + 1) * size), slice(column * size, (column + 1) * size)
        cross[part] = colour(faces[face], low, high, "land", 8)
    v, u = np.mgrid[-1 : 1 : 3j * size, -1 : 1 : 3j * size] * 1.05
    w = np.sqrt(np.maximum(1 - u * u - v * v, 0))
    ball = colour(noise.fbm((u, -v, w), **options), low, high, "land", 8)
    light = np.clip(0.75 * w - 0.5 * u - 0.45 * v, 0.05, 1) ** 0.7
    ball = np.where((u * u + v * v < 1)[..., None], ball * light[..., None], 255)
    return beside([cross, np.rint(ball).astype(np.uint8)])


def points(cells: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    ticks = np.arange(SIDE) * cells / SIDE
    x, y = np.meshgrid(ticks, ticks)
    return x, y, np.full_like(x, HEIGHT)


def plane(cells: float, **options) -> np.ndarray:
    return noise.grid((1, SIDE, SIDE), step=cells / SIDE, origin=(0, 0, HEIGHT), **options)[0]


def lit(height: np.ndarray) -> np.ndarray:
    """As ground, whose slopes are half a unit on the average, under light from the upper left."""
    slope_y, slope_x = np.gradient(height)
    steepness = 0.5 / np.sqrt((slope_x**2 + slope_y**2).mean())
    x, y = steepness * slope_x, steepness * slope_y
    return grey((1.0 + 0.9 * x + 0.6 * y) / np.sqrt(1 + x**2 + y**2), 0.0, 1.6)


def grey(values: np.ndarray, low: float | None = None, high: float | None = None) -> np.ndarray:
    low = values.min() if low is None else low
    high = values.max() if high is None else high
    return np.rint(255 * np.clip((values - low) / (high - low), 0, 1)).astype(np.uint8)


def beside(pictures: list[np.ndarray], *, across: bool = True) -> np.ndarray:
    """With white between them."""
    gap = [(0, 0), (GAP, 0)] if across else [(GAP, 0), (0, 0)]
    gap += [(0, 0)] * (pictures[0].ndim - 2)
    padded = [np.pad(p, gap if i else 0, constant_values=255) for i, p in enumerate(pictures)]
    return np.concatenate(padded, axis=1 if across else 0)


if __name__ == "__main__":
    if len(sys.argv) > 2:
        sys.exit(__doc__)
    main(*sys.argv[1:])
