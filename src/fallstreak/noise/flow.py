"""Curls of Perlin noise: flows without sources (Bridson, Houriham, Nordenstam 2007, "Curl-noise").

In 2-D the noise is the stream function. In 3-D three noises are the components of the potential: the words
are then those of the first, of the second and of the third.
"""

from __future__ import annotations

from .kernels import kernel
from .perlin import perlin2_slopes, perlin3_slopes


@kernel("curl", 2, derivatives=True)
def curl2(cells, offsets, words, periods):
    value, x, y = perlin2_slopes(cells, offsets, words, periods)
    return value, y, -x


@kernel("curl", 3, derivatives=True)
def curl3(cells, offsets, words, periods):
    a, _, ay, az = perlin3_slopes(cells, offsets, words[:4], periods)
    _, bx, _, bz = perlin3_slopes(cells, offsets, words[4:8], periods)
    _, cx, cy, _ = perlin3_slopes(cells, offsets, words[8:], periods)
    return a, cy - bz, az - cx, bx - ay
