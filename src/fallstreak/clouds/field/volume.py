"""The volume of noise that eats at clouds: 64³ texels of four channels that repeat.

Channels: billows (rounded lumps as on cauliflower, inverse cellular noise, 4 cells a side and finer), fBm of
Perlin noise (4 cells and finer), fine billows (8 cells and finer), fibres (ridged Perlin noise). Every
channel's values are spread evenly from 0 to 1, so that all are equally strong. CPU and GPU have the same
bytes.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np

SIZE = 64
DATA = Path(__file__).parent / "data" / "volume.npz"


@cache
def volume() -> np.ndarray:
    """(64, 64, 64, 4) uint8, axes z, y, x; as `baked` made it: compiling what that needs takes seconds."""
    with np.load(DATA) as held:
        return held["volume"]


def baked() -> np.ndarray:
    """The volume, made anew."""
    from ...noise import grid

    shape = (SIZE,) * 3
    channels = [
        -grid(shape, kind="cellular_f1", octaves=3, gain=0.42, frequency=4, period=4, seed=11, step=1 / SIZE),
        grid(shape, kind="perlin", octaves=4, gain=0.55, frequency=4, period=4, seed=12, step=1 / SIZE),
        -grid(shape, kind="cellular_f1", octaves=2, gain=0.45, frequency=8, period=8, seed=13, step=1 / SIZE),
        grid(
            shape, kind="perlin", fractal="ridged", octaves=4, frequency=4, period=4, seed=14, step=1 / SIZE
        ),
    ]
    return np.stack([_even(channel) for channel in channels], -1)


def _even(values: np.ndarray) -> np.ndarray:
    """Values replaced by their rank, as bytes."""
    flat = values.ravel()
    edges = np.quantile(flat, np.arange(1, 256) / 256.0)
    return np.searchsorted(edges, flat).astype(np.uint8).reshape(values.shape)


def sample(points: np.ndarray) -> np.ndarray:
    """Trilinear look-up as the GPU's, between centres of texels, repeating.

    Parameters
    ----------
    points : (n, 3)
        x, y, z in repeats.

    Returns
    -------
    (n, 4) float64, 0 to 1
    """
    p = points * SIZE - 0.5
    low = np.floor(p)
    f = p - low
    low = low.astype(np.int64) % SIZE
    high = (low + 1) % SIZE
    texels = volume().reshape(-1, 4)
    out = np.zeros((len(points), 4))
    for corner in range(8):
        side = [(corner >> axis) & 1 for axis in range(3)]
        x, y, z = ((high if side[a] else low)[:, a] for a in range(3))
        weight = np.prod([f[:, a] if side[a] else 1.0 - f[:, a] for a in range(3)], axis=0)
        out += weight[:, None] * texels[(z * SIZE + y) * SIZE + x]
    return out / 255.0
