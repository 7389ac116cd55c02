"""Pictures of twigs: what the cards of trees and shrubs are covered with, drawn by code.

Four layers, rgba8: a spruce's frond, a spray of leaves, a spray of small leaves, bark. Red is the tone (0.5
is the mean of what stands there), green says leaf or needle (1) or wood (0), blue how much sky reaches it,
alpha how much of the texel is covered; the others are multiplied by alpha, so that mips need no care.
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from functools import lru_cache

import numpy as np

SIZE = 512
"""Texels along a side."""

FROND, LEAVES, SPRAY, BARK = range(4)
_FINE = 2  # drawn twice as large, then averaged


def cards(layers: Collection[int] = (FROND, LEAVES, SPRAY, BARK)) -> np.ndarray:
    """The layers, (4, SIZE, SIZE, 4) uint8, row 0 where the twig begins; what is not asked for is empty."""
    empty = np.zeros((SIZE, SIZE, 4), np.uint8)
    return np.stack([_layer(i) if i in layers else empty for i in range(4)])


@lru_cache
def _layer(index: int) -> np.ndarray:
    rng = np.random.default_rng(20 + index)
    if index == FROND:
        return _frond(rng)
    if index == LEAVES:
        return _spray(rng, 400, 0.082, 0.5)
    if index == SPRAY:
        return _spray(rng, 420, 0.07, 0.4)
    return _bark(rng)


class _Sheet:
    """A drawing of dark and light strokes on nothing."""

    def __init__(self):
        from PIL import Image, ImageDraw

        self._picture = Image.new("RGBA", (SIZE * _FINE, SIZE * _FINE))
        self._pen = ImageDraw.Draw(self._picture)

    def line(self, a: np.ndarray, b: np.ndarray, width: float, *look: float) -> None:
        """A stroke from a to b (0…1 across and along); `look` is tone, leaf, sky."""
        scale = SIZE * _FINE
        points = [float(v) * scale for v in (*a, *b)]
        self._pen.line(points, fill=_texel(*look), width=max(1, round(width * scale)))

    def polygon(self, points: np.ndarray, *look: float) -> None:
        """A filled outline, (n, 2)."""
        self._pen.polygon((np.asarray(points) * (SIZE * _FINE)).ravel().tolist(), fill=_texel(*look))

    def texels(self) -> np.ndarray:
        """The drawing as a layer."""
        # what is not covered is 0 in all channels: the mean is already multiplied by the coverage
        fine = np.asarray(self._picture, np.uint16)
        rows = fine[0::2] + fine[1::2]
        return ((rows[:, 0::2] + rows[:, 1::2]) // 4).astype(np.uint8)


def _texel(tone: float, leaf: float, sky: float) -> tuple[int, int, int, int]:
    r, g, b = (int(min(max(255 * v, 0), 255)) for v in (tone, leaf, sky))
    return r, g, b, 255


def _frond(rng: np.random.Generator) -> np.ndarray:
    """A branch of a spruce from above: side twigs with needles, longest before the middle."""
    sheet = _Sheet()
    strokes: list[Callable[[], None]] = []

    def twig(start: np.ndarray, angle: float, length: float, tone: float) -> None:
        bend = rng.normal(0.0, 0.10)
        direction = np.array([np.sin(angle), np.cos(angle)])
        turned = np.array([np.sin(angle + bend), np.cos(angle + bend)])
        end = start + length * (0.5 * direction + 0.5 * turned)
        sheet.line(start, end, 0.0035, 0.35, 0.0, 0.7)
        for s in np.arange(0.0, 1.0, 0.0075 / max(length, 0.01)):
            at = start + (end - start) * s
            for side in (-1.0, 1.0):
                lean = angle + bend * s + side * rng.uniform(0.55, 1.0)
                reach = rng.uniform(0.020, 0.034) * (1.0 - 0.35 * s)
                tip = at + reach * np.array([np.sin(lean), np.cos(lean)])
                shade = tone * rng.uniform(0.7, 1.25) * (0.62 + 0.75 * s)
                sky = 0.4 + 0.6 * s
                strokes.append(
                    lambda at=at, tip=tip, shade=shade, sky=sky: sheet.line(at, tip, 0.004, shade, 1.0, sky)
                )

    root = np.array([0.5, 0.0])
    sheet.line(root, np.array([0.5, 0.9]), 0.009, 0.3, 0.0, 0.6)
    for v in np.arange(0.03, 0.98, 0.047):
        for side in (-1.0, 1.0):
            at = np.array([0.5, v + rng.uniform(-0.01, 0.01)])
            length = 0.47 * min(1.0, (v + 0.16) / 0.36) * (1.02 - v) ** 0.62 * rng.uniform(0.8, 1.1)
            angle = side * rng.uniform(0.72, 1.0)
            tone = rng.uniform(0.28, 0.62)
            twig(at, angle, length, tone)
            if length > 0.2:
                for part in (0.5,):
                    start = at + part * length * np.array([np.sin(angle), np.cos(angle)])
                    twig(start, angle - side * rng.uniform(0.5, 0.8), 0.4 * (1 - part) * length + 0.04, tone)
    twig(np.array([0.5, 0.86]), 0.0, 0.12, 0.55)
    for i in rng.permutation(len(strokes)):
        strokes[i]()
    return sheet.texels()


def _spray(rng: np.random.Generator, count: int, length: float, width: float) -> np.ndarray:
    """Leaves about a few twigs; `width` is a leaf's, over its length."""
    sheet = _Sheet()
    stem = np.array([0.5, 0.05])
    for angle in (-0.6, -0.3, 0.05, 0.35, 0.65):
        end = stem + rng.uniform(0.4, 0.6) * np.array([np.sin(angle), np.cos(angle)])
        sheet.line(stem, end, 0.006, 0.35, 0.0, 0.5)
    outline = np.array([(0.0, 0.0), (0.2, 0.36), (0.5, 0.5), (0.78, 0.3), (1.0, 0.0)])
    outline = np.concatenate([outline, outline[-2:0:-1] * [1.0, -1.0]])
    order = np.sort(rng.uniform(0.0, 1.0, count))
    for depth in order:  # what lies behind is drawn first and is darker
        radius, turn = 0.42 * rng.uniform() ** 0.6, rng.uniform(0, 2 * np.pi)
        centre = np.array([0.5, 0.52]) + radius * np.array([np.sin(turn), np.cos(turn)])
        angle = turn + rng.normal(0.0, 0.9)
        along, across = np.array([np.sin(angle), np.cos(angle)]), np.array([np.cos(angle), -np.sin(angle)])
        size = length * rng.uniform(0.7, 1.3)
        tilt = rng.uniform(0.45, 1.0)  # leaves are seen from aslant
        points = (
            centre + size * (outline[:, :1] - 0.3) * along + size * width * tilt * outline[:, 1:] * across
        )
        tone = (0.33 + 0.27 * depth) * rng.uniform(0.75, 1.25)
        sky = 0.55 + 0.45 * depth
        half = len(outline) // 2 + 1
        sheet.polygon(points, tone * 0.9, 1.0, sky)
        sheet.polygon(points[:half], tone * 1.12, 1.0, sky)  # the two halves of a leaf fold
    return sheet.texels()


def _bark(rng: np.random.Generator) -> np.ndarray:
    """Bark and stone alike: a grain that repeats at the borders, rougher along than across."""
    spectrum = np.fft.fft2(rng.normal(size=(SIZE, SIZE)))
    v, u = np.meshgrid(np.fft.fftfreq(SIZE), np.fft.fftfreq(SIZE), indexing="ij")
    grain = np.fft.ifft2(spectrum / (1e-3 + np.hypot(u, v)) ** 1.1).real
    grain /= grain.std()
    tone = np.clip(0.5 + 0.13 * grain, 0.1, 0.95)
    opaque = np.ones_like(tone)
    return np.round(255 * np.stack([tone, 0 * tone, np.clip(0.85 + 0.1 * grain, 0.4, 1), opaque], -1)).astype(
        np.uint8
    )
