"""The ship's plating: a square of panels that repeats, as colour, normals and surface."""

from __future__ import annotations

import numpy as np

import fallstreak as fs

SIDE = 1024
METRES = 520.0
"""Of hull that one copy covers."""


def plates(rng: np.random.Generator) -> np.ndarray:
    """Which plate each texel belongs to: a square cut again and again, (SIDE, SIDE) int."""
    owner = np.zeros((SIDE, SIDE), int)
    stack = [(0, 0, SIDE, SIDE)]
    number = 0
    while stack:
        x, y, w, h = stack.pop()
        smallest = rng.choice([20, 28, 44, 80], p=[0.25, 0.35, 0.25, 0.15])
        if max(w, h) > 2.2 * smallest and (max(w, h) > 190 or rng.random() < 0.93):
            share = rng.uniform(0.3, 0.7)
            if w * rng.uniform(0.8, 1.25) > h:
                cut = int(w * share)
                stack += [(x, y, cut, h), (x + cut, y, w - cut, h)]
            else:
                cut = int(h * share)
                stack += [(x, y, w, cut), (x, y + cut, w, h - cut)]
            continue
        owner[y : y + h, x : x + w] = number
        number += 1
    return owner


def paint(seed: int = 5) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Colour (sRGB), normal map and surface (occlusion, roughness, metal), each (SIDE, SIDE, 3) uint8."""
    rng = np.random.default_rng(seed)
    owner = plates(rng)
    count = owner.max() + 1
    rise = rng.choice([0.0, 0.7, 1.4, 2.2], count, p=[0.35, 0.3, 0.2, 0.15])[owner]
    # grooves between plates, a texel and a half wide
    edge = np.zeros((SIDE, SIDE))
    for axis in (0, 1):
        differs = owner != np.roll(owner, 1, axis)
        edge = np.maximum(edge, differs | np.roll(differs, -1, axis))
    near = edge.copy()
    for shift in (1, -1, 2, -2):
        for axis in (0, 1):
            near = np.maximum(near, np.roll(edge, shift, axis) * (0.6 if abs(shift) == 1 else 0.3))
    grime = fs.noise.grid((SIDE, SIDE), period=6, octaves=6, seed=seed)
    streaks = fs.noise.grid((SIDE, SIDE), period=24, octaves=4, seed=seed + 1)
    height = rise - 1.6 * edge + 0.10 * streaks
    tone = rng.normal(0.0, 0.075, count)[owner]
    dark = (rng.random(count) < 0.07)[owner]
    light = (rng.random(count) < 0.06)[owner]
    base = 0.40 * np.exp(tone + 0.25 * grime + 0.10 * streaks - 0.55 * near)
    base = np.where(dark, 0.58 * base, np.where(light, 1.25 * base, base))
    hue = rng.normal(0.0, 0.018, count)[owner]
    color = base[..., None] * (np.array([0.98, 1.0, 1.03]) + hue[..., None] * np.array([1.0, 0.1, -1.0]))
    # small ports in rows on some plates: dark glass
    ports = (rng.random(count) < 0.10)[owner] & (near < 0.1)
    rows, columns = np.indices((SIDE, SIDE))
    ports &= ((rows % 12) < 3) & ((columns % 7) < 4)
    color = np.where(ports[..., None], 0.02, color)
    slope_x = (np.roll(height, -1, 1) - np.roll(height, 1, 1)) * 0.35
    slope_y = (np.roll(height, -1, 0) - np.roll(height, 1, 0)) * 0.35
    normal = np.stack([-slope_x, slope_y, np.ones_like(height)], 2)  # green is up in the picture
    normal /= np.linalg.norm(normal, axis=2, keepdims=True)
    rough = np.clip(0.50 + 0.10 * rng.normal(0, 1, count)[owner] + 0.12 * grime + 0.15 * near, 0.22, 0.95)
    rough = np.where(ports, 0.12, rough)
    metal = np.where(dark, 0.75, 0.25) * (1.0 - 0.6 * np.clip(near, 0, 1)) * ~ports
    srgb = np.where(color <= 0.0031308, 12.92 * color, 1.055 * np.maximum(color, 1e-9) ** (1 / 2.4) - 0.055)
    surface = np.stack([1.0 - 0.75 * np.clip(near, 0, 1), rough, metal], 2)
    pictures = (srgb * 255.0, normal * 127.5 + 127.5 + 0.5, surface * 255.0)
    return tuple(np.clip(np.round(p), 0, 255).astype(np.uint8) for p in pictures)
