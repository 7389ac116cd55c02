"""Textures of the sprites (provisional)."""

from __future__ import annotations

import numpy as np


def sheet() -> np.ndarray:
    """16 textures, (16, 128, 128, 4) uint8: slope right, slope up, thickness, opacity."""
    n = 128
    out = np.zeros((16, n, n, 4), np.uint8)
    y, x = np.mgrid[0:n, 0:n] / n
    for i in range(16):
        rng = np.random.default_rng(i)
        h = np.zeros((n, n))
        for octave, count in enumerate((5, 14, 40, 120)):
            points = rng.random((count, 2))
            d = np.full((n, n), 9.0)
            for px, py in points:
                dx = np.abs(x - px)
                dy = np.abs(y - py)
                d = np.minimum(d, np.hypot(np.minimum(dx, 1 - dx), np.minimum(dy, 1 - dy)))
            scale = 0.8 / np.sqrt(count)
            h += (1.0 - np.minimum(d / scale, 1.0) ** 2) * 0.5**octave
        h = (h - h.min()) / (h.max() - h.min())
        h = np.clip(0.5 + (h - np.median(h)) * 1.0, 0, 1)
        gy, gx = np.gradient(h)
        out[i, ..., 0] = np.clip(127.5 - gx * n * 12, 0, 255)
        out[i, ..., 1] = np.clip(127.5 + gy * n * 12, 0, 255)
        out[i, ..., 2] = 255 * h
        out[i, ..., 3] = 255
    return out
