#!/usr/bin/env python3
"""Bake the ground's base materials: python script/build_materials.py [name …], or their sheet: … --sheet

Writes two pictures per material to src/fallstreak/terrain/materials/data: `<name>.jpg`, the square root of
the colour's detail (mean 1/2 in linear light, so that a colour times twice the detail keeps its mean), and
`<name>.shape.jpg`, four squares below each other: height by rank (each as frequent as any other), slopes to
the east and to the north, share of the sky in view. The same Pillow and numpy write the same bytes.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

import numpy as np
from material_recipes import RECIPES
from material_tools import Canvas, blurred, halved
from PIL import Image

from fallstreak.terrain.materials import MATERIALS, SIDE, Material, load_materials

ROOT = Path(__file__).parents[1]
FOLDER = ROOT / "src/fallstreak/terrain/materials/data"
SHEET = ROOT / "docs/terrain/materials.png"
COLOUR_QUALITY, SHAPE_QUALITY = 78, 70
FLATTEN = 0.8  # how much of the differences between parts of a tile is taken out: they would show its repeats


def main(names: list[str]) -> None:
    total = 0
    for name in names or MATERIALS:
        start = time.perf_counter()
        detail, planes = bake(name)
        sizes = write(name, detail, planes)
        total += sum(sizes)
        print(f"{name:13}{sizes[0] // 1024:5} + {sizes[1] // 1024} KiB  {time.perf_counter() - start:5.1f} s")
    print(f"{total / 2**20:.2f} MiB")


def bake(name: str) -> tuple[np.ndarray, np.ndarray]:
    """Detail of the colour (side, side, 3), mean 1/2, and (4, side, side): rank, slopes, sky; all 0…1."""
    material = MATERIALS[name]
    canvas = Canvas(2 * SIDE, material.tile, seed=1000 + material.layer)
    height, tone = RECIPES[name](canvas)
    height = halved(height - height.min())
    height *= material.relief / np.ptp(height)
    texel = material.tile / SIDE
    sky = sky_view(height, texel)
    tone = halved(np.broadcast_to(tone, (2 * SIDE, 2 * SIDE, 3)))
    detail = tone * (0.35 + 0.65 * sky[..., None] / sky.mean())
    detail /= (blurred(detail, SIDE / 5) / detail.mean((0, 1))) ** FLATTEN
    return evened(detail), np.stack([ranks(height), *slopes(height, texel, material, name), sky])


def evened(detail: np.ndarray) -> np.ndarray:
    """Within 0…1 with a mean of 1/2 in each channel."""
    for _ in range(8):
        detail = np.clip(detail * (0.5 / detail.mean((0, 1))), 0.004, 1.0)
    return detail


def ranks(height: np.ndarray) -> np.ndarray:
    """Heights to 0…1, each as frequent as any other: so a share of places is a threshold."""
    order = np.empty(height.size)
    order[np.argsort(height, axis=None, kind="stable")] = (np.arange(height.size) + 0.5) / height.size
    return order.reshape(height.shape)


def slopes(height: np.ndarray, texel: float, material: Material, name: str) -> list[np.ndarray]:
    """Rise over run along x and y as codes 0…1 about 128/255; rows run north."""
    height = blurred(height, 0.6)
    found = [(np.roll(height, -1, a) - np.roll(height, 1, a)) / (2 * texel) for a in (1, 0)]
    outside = np.mean([np.abs(s) > material.steepest for s in found])
    if outside > 0.03:
        print(f"  {name}: {100 * outside:.1f} % of slopes are steeper than {material.steepest}")
    return [(128 + 127 * np.clip(s / material.steepest, -1, 1)) / 255 for s in found]


def sky_view(height: np.ndarray, texel: float) -> np.ndarray:
    """Cosine-weighted share of the sky over a periodic height field, from its horizons in 16 directions."""
    total = np.zeros_like(height)
    for angle in np.arange(16) * (np.pi / 8):
        horizon = np.zeros_like(height)
        for step in (1, 2, 3, 5, 8, 12, 18, 27):
            dx, dy = round(step * np.cos(angle)), round(step * np.sin(angle))
            rise = np.roll(height, (-dy, -dx), (0, 1)) - height
            np.maximum(horizon, rise / (texel * np.hypot(dx, dy)), out=horizon)
        total += 1.0 / (1.0 + horizon**2)  # 1 − sin² of the horizon's elevation
    return total / 16


def write(name: str, detail: np.ndarray, planes: np.ndarray) -> tuple[int, int]:
    """Both pictures; their sizes in bytes."""
    FOLDER.mkdir(exist_ok=True)
    paths = FOLDER / f"{name}.jpg", FOLDER / f"{name}.shape.jpg"
    colour = Image.fromarray(np.round(255 * np.sqrt(detail)).astype(np.uint8), "RGB")
    colour.save(paths[0], quality=COLOUR_QUALITY, optimize=True)
    shape = Image.fromarray(np.round(255 * planes.reshape(-1, SIDE)).astype(np.uint8), "L")
    shape.save(paths[1], quality=SHAPE_QUALITY, optimize=True)
    return paths[0].stat().st_size, paths[1].stat().st_size


def sheet(columns: int = 5, side: int = 150) -> None:
    """docs/terrain/materials.png: all materials, each a tile, under a sun 35° high in the west-northwest."""
    color, shape = (a.astype(float) / 255 for a in load_materials())
    sun = np.array([-0.75, 0.32, 0.57])
    pictures = []
    for material in MATERIALS.values():
        tilt = (shape[material.layer, ..., :2] * 255 - 128) / 127 * material.steepest
        normal = np.concatenate([-tilt, np.ones((SIDE, SIDE, 1))], 2)
        light = np.maximum(normal @ sun, 0.0) / np.linalg.norm(normal, axis=2)
        light = 1.5 * light + 0.4 * shape[material.layer, ..., 3]
        tint = np.array(material.albedo) / np.sqrt(np.mean(material.albedo))  # dark ones brighter, hues kept
        seen = np.clip(1.2 * color[material.layer, ..., :3] * tint * light[..., None], 0, 1) ** (1 / 2.2)
        picture = Image.fromarray(np.uint8(255 * seen[::-1])).resize((side, side), Image.Resampling.LANCZOS)
        pictures.append(np.asarray(picture))
    rows = [np.concatenate(pictures[k : k + columns], 1) for k in range(0, len(pictures), columns)]
    SHEET.parent.mkdir(exist_ok=True)
    Image.fromarray(np.concatenate(rows)).quantize(160, dither=Image.Dither.NONE).save(SHEET, optimize=True)
    print(f"{SHEET.stat().st_size // 1024} KiB in {SHEET.name}")


if __name__ == "__main__":
    if sys.argv[1:] == ["--sheet"]:
        sys.exit(sheet())
    unknown = [name for name in sys.argv[1:] if name not in MATERIALS]
    if unknown:
        sys.exit(f"no such material: {', '.join(unknown)}; there are {', '.join(MATERIALS)}")
    main(sys.argv[1:])
