"""What the recipes of materials are made with: a square that repeats, noise on it, things strewn over it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from fallstreak import noise

Form = Callable[[np.ndarray, np.ndarray, np.random.Generator], np.ndarray]
"""(u, v, random) → height in units of the radius, NaN or below the ground where there is nothing."""


class Canvas:
    """A square of ground that repeats.

    Parameters
    ----------
    side : int
        Samples along an edge.
    size : float
        m along an edge.
    seed : int
        Of all that is random here.
    """

    def __init__(self, side: int, size: float, seed: int):
        self.side, self.size, self.texel = side, size, size / side
        self.random = np.random.default_rng(seed)
        ticks = (np.arange(side) + 0.5) / side
        self.x, self.y = np.meshgrid(ticks, ticks)
        self._seed = seed * 1000

    def noise(self, cells: int | tuple[int, int], octaves: int = 6, gain: float = 0.5, fractal: str = "fbm",
              kind: str = "perlin") -> np.ndarray:  # fmt: skip
        """Noise with so many cells along the edge, mean 0 and standard deviation 1, another each time."""
        self._seed += 1
        most = int(np.log2(self.side / (2 * np.max(cells)))) + 1
        u, v = (cells, cells) if isinstance(cells, int) else cells
        points = (self.x * u, self.y * v)
        made = noise.fbm(points, min(octaves, most), kind=kind, fractal=fractal, gain=gain, seed=self._seed,
                         period=(u, v)).astype(float)  # fmt: skip
        return (made - made.mean()) / made.std()

    def walls(self, cells: int | tuple[int, int], warp: float = 0.0) -> np.ndarray:
        """Distance to the walls between scattered cells, 0…about 1; `warp` bends them. Both in cells."""
        self._seed += 1
        u, v = (cells, cells) if isinstance(cells, int) else cells
        bend = [warp * self.noise(2 * max(u, v), 4) if warp else 0.0 for _ in range(2)]
        points = (self.x * u + bend[0], self.y * v + bend[1])
        made = noise.sample(points, "cellular_f2f1", seed=self._seed, period=(u, v))
        return made.astype(float)

    def bent(self, field: np.ndarray, east: np.ndarray | float, north: np.ndarray | float) -> np.ndarray:
        """A field looked up at displaced places (m)."""
        i = np.round(self.y * self.side - 0.5 + north / self.texel).astype(int) % self.side
        j = np.round(self.x * self.side - 0.5 + east / self.texel).astype(int) % self.side
        return field[i, j]

    def strew(self, height: np.ndarray, tone: np.ndarray, count: int, radius: tuple[float, float], form: Form,
              colour: Callable[[np.random.Generator], np.ndarray], power: float = 2.0, sink: float = 0.3,
              lift: np.ndarray | float = 0.0) -> None:  # fmt: skip
        """Lay `count` things onto the ground, in place; what is higher hides what is lower.

        Radii (m) are spread between two bounds by a `power`: the greater, the fewer are large. Things stand
        on the ground below their middle, sunk by a part of their radius, `lift` (m) above it.
        """
        random, n = self.random, self.side
        sizes = np.sort(radius[0] + (radius[1] - radius[0]) * random.random(count) ** power)[::-1]
        ground = np.broadcast_to(lift, height.shape)
        for size in sizes:
            centre, angle = random.random(2) * n, random.random() * 2 * np.pi
            reach = int(np.ceil(1.5 * size / self.texel)) + 1
            rows = np.arange(int(centre[0]) - reach, int(centre[0]) + reach + 1)
            columns = np.arange(int(centre[1]) - reach, int(centre[1]) + reach + 1)
            v, u = np.meshgrid(rows + 0.5 - centre[0], columns + 0.5 - centre[1], indexing="ij")
            scale = self.texel / size
            turned = (
                (np.cos(angle) * u + np.sin(angle) * v) * scale,
                (np.cos(angle) * v - np.sin(angle) * u) * scale,
            )
            patch = np.ix_(rows % n, columns % n)
            middle = int(centre[0]) % n, int(centre[1]) % n
            own = form(*turned, random)
            top = (own - sink) * size + height[middle] * 0.6 + ground[middle]
            shade = colour(random)
            there = (own > 0.0) & (top > height[patch])
            height[patch] = np.where(there, top, height[patch])
            tone[patch] = np.where(there[..., None], shade, tone[patch])

    def streaks(
        self,
        height: np.ndarray,
        tone: np.ndarray,
        roots: np.ndarray,
        length: np.ndarray,
        lift: np.ndarray,
        colours: np.ndarray,
        curl: float = 0.6,
        steps: int = 48,
        thick: int = 1,
    ) -> None:
        """Draw blades or twigs, in place: curved lines from `roots` (texels) that rise to `lift` (m)."""
        random = self.random
        count = len(roots)
        heading = random.random(count) * 2 * np.pi
        bend = curl * random.standard_normal(count)
        t = np.linspace(0.0, 1.0, steps)
        angle = heading[:, None] + bend[:, None] * t
        run = (length / self.texel / steps)[:, None]
        i = roots[:, 0, None] + np.cumsum(np.sin(angle) * run, 1)
        j = roots[:, 1, None] + np.cumsum(np.cos(angle) * run, 1)
        base = height[roots[:, 0].astype(int) % self.side, roots[:, 1].astype(int) % self.side]
        z = base[:, None] + lift[:, None] * np.sqrt(t * (2 - t)) - 0.2 * lift[:, None] * t**3
        shade = colours[:, None, :] * (0.55 + 0.6 * t)[:, None]
        for di in range(thick):
            for dj in range(thick):
                rows, columns = (i + di).astype(int) % self.side, (j + dj).astype(int) % self.side
                order = np.argsort(z, axis=None, kind="stable")  # what is written last lies on top
                r, c, h = rows.ravel()[order], columns.ravel()[order], z.ravel()[order]
                above = h > height[r, c]
                r, c = r[above], c[above]
                height[r, c] = h[above]
                tone[r, c] = shade.reshape(-1, 3)[order][above]


def halved(field: np.ndarray) -> np.ndarray:
    """Means of 2×2."""
    return 0.25 * (field[::2, ::2] + field[1::2, ::2] + field[::2, 1::2] + field[1::2, 1::2])


def blurred(field: np.ndarray, sigma: float) -> np.ndarray:
    """A Gaussian blur (sigma in samples) of a field that repeats."""
    spectrum = np.fft.rfft2(field, axes=(0, 1))
    fy, fx = np.fft.fftfreq(field.shape[0])[:, None], np.fft.rfftfreq(field.shape[1])
    weight = np.exp(-2.0 * (np.pi * sigma) ** 2 * (fx * fx + fy * fy))
    weight = weight.reshape(weight.shape + (1,) * (field.ndim - 2))
    return np.fft.irfft2(spectrum * weight, s=field.shape[:2], axes=(0, 1))


def steps(value: np.ndarray, low: float, high: float) -> np.ndarray:
    """Smooth from 0 at `low` to 1 at `high`."""
    t = np.clip((value - low) / (high - low), 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t)


def stone(facets: int, flat: float = 0.6) -> Form:
    """An angular stone: what a few random planes leave of a block."""

    def form(u: np.ndarray, v: np.ndarray, random: np.random.Generator) -> np.ndarray:
        v = v * random.uniform(1.0, 1.7)
        top = flat + 0.35 * (random.random() - 0.5) * u + 0.35 * (random.random() - 0.5) * v
        for k in range(facets):
            angle = 2 * np.pi * (k + random.random() * 0.8) / facets
            steep = random.uniform(0.9, 3.0)
            top = np.minimum(top, steep * (random.uniform(0.75, 1.0) - np.cos(angle) * u - np.sin(angle) * v))
        return top

    return form


def pebble(u: np.ndarray, v: np.ndarray, random: np.random.Generator) -> np.ndarray:
    """A rounded stone, longer than wide, flatter than round."""
    v = v * random.uniform(1.0, 1.6)
    power = random.uniform(2.0, 3.0)
    rest = 1.0 - np.abs(u) ** power - np.abs(v) ** power
    return 0.7 * np.sqrt(np.maximum(rest, 0.0)) * np.where(rest > 0, 1, -1) - np.where(rest > 0, 0, 1e3)
