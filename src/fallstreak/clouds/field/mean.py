"""Extinction of blobs, as puffs of all sizes stand for them: float64 twin of ``mean.wesl``."""

from __future__ import annotations

import numpy as np

from . import density
from .cells import patchy
from .layers import Layer
from .model import Field
from .uniform import HEIGHTS, KNOTS

LEAST = 1e-6
"""Transmittance: whatever lets less through is as black."""


def mean_extinction(field: Field, points: np.ndarray, size: float, time: float) -> np.ndarray:
    """What lets the same light through as the clouds in a blob do on average.

    Parameters
    ----------
    points : (n, 3)
        East, north, height, m.
    size : float
        Diameter of the blobs, m.
    time : float
        s since the scene's start.

    Returns
    -------
    (n,)
        1/m. Against the mean transmittance of upright lines through blobs (`seen_through`) at coverage .4:
        the mean over a layer is right within .03 (cumulonimbus .06), a single blob within .05 to .2.
    """
    return sum(
        (_layer_mean(field, index, points, size, time) for index in range(len(field.layers))),
        np.zeros(len(points)),
    )


def _layer_mean(field: Field, index: int, points: np.ndarray, size: float, time: float) -> np.ndarray:
    layer = field.layers[index]
    low, high = layer.bounds
    opacity = np.zeros(len(points))
    at = np.flatnonzero((points[:, 2] + 0.5 * size > low) & (points[:, 2] - 0.5 * size < high))
    if not len(at):
        return opacity
    blurred = _smooth(0.5 * layer.body, 1.5 * layer.body, size)
    if blurred < 1.0:
        opacity[at] += (1.0 - blurred) * -np.expm1(-size * _soft(field, index, points[at], size, time))
    if blurred > 0.0:
        opacity[at] += blurred * -np.expm1(-size * _statistical(field, index, points[at], size, time))
    exponents = [1.0, *field.calibrations[index].blobs]
    opacity **= np.interp(_rank(layer, size), np.arange(len(exponents)), exponents)
    return _dense(opacity, size)


def _dense(opacity: np.ndarray, size: float) -> np.ndarray:
    """Extinction of blobs of an opacity."""
    return -np.log(np.maximum(1.0 - opacity, LEAST)) / size


def _rank(layer: Layer, size: float) -> float:
    """Where a size lies among `Layer.blobs`, the first at 1."""
    first, second = layer.blobs[:2]
    return float(np.log2(size / first) / np.log2(second / first)) + 1.0


def fitted(field: Field) -> np.ndarray:
    """Exponents by which blobs of all sizes let through what they should on average over the first layer.

    The field must have been calibrated without: ones.
    """
    layer = field.layers[0]
    low, high = layer.bounds
    random = np.random.default_rng(7)
    blobs, lines, steps = 400, 8, 12
    out = []
    for size in layer.blobs:
        place = random.uniform(size=(blobs, 3)) * [80 * layer.cell, 80 * layer.cell, high - low]
        place[:, 2] += low
        want = seen_through(field, place, size, lines, steps, random)
        opacity = -np.expm1(-size * _layer_mean(field, 0, place, size, 0.0))
        least, most = 0.6, 1.7
        for _ in range(20):
            middle = np.sqrt(least * most)
            if (opacity**middle).mean() > 1.0 - want.mean():
                least = middle
            else:
                most = middle
        out.append(middle)
    return np.array(out)


def seen_through(
    field: Field, places: np.ndarray, size: float, lines: int, steps: int, random: np.random.Generator
) -> np.ndarray:
    """Mean transmittance of upright lines through cubes of the field's first layer, at time 0: (n,)."""
    low, high = field.layers[0].bounds
    off = (random.uniform(size=(len(places), lines, 1, 2)) - 0.5) * size
    bottom = np.clip(places[:, 2] - 0.5 * size, low, high)
    part = np.clip(places[:, 2] + 0.5 * size, low, high) - bottom
    points = np.empty((len(places), lines, steps, 3))
    points[..., :2] = places[:, None, None, :2] + off
    points[..., 2] = (bottom[:, None] + part[:, None] * (np.arange(steps) + 0.5) / steps)[:, None]
    extinction = field.layer_extinction(0, points.reshape(-1, 3), 0.0).reshape(len(places), lines, steps)
    return np.exp(-extinction.mean(-1) * part[:, None]).mean(1)


def _soft(field: Field, index: int, points: np.ndarray, size: float, time: float) -> np.ndarray:
    """The field with edges as soft as the blob is large."""
    layer = field.layers[index]
    value, water = field.gathered(index, points, time)
    amplitude = layer.genus.amplitude * np.clip(1.5 - size / (0.25 * layer.tile), 0.0, 1.0)
    noise = density.noise_at(layer, points, time)
    eaten = value + amplitude * (noise - 0.5) * np.minimum(4.0 * value, 1.0)
    soft = min(0.5 * size / layer.body, density.SURFACE)
    part = _smooth(density.SURFACE - soft, density.SURFACE + layer.genus.edge + soft, eaten)
    extinction = water / np.maximum(value, 1e-12)
    return np.where(value > 0.0, _broken(part, extinction, size), 0.0)


def _statistical(field: Field, index: int, points: np.ndarray, size: float, time: float) -> np.ndarray:
    """Without the field itself: by the outlines of the clouds around, and beyond cells by coverage."""
    layer = field.layers[index]
    wide = _smooth(0.7 * layer.cell, 1.6 * layer.cell, size)
    opacity = np.zeros(len(points))
    if wide < 1.0:
        opacity += (1.0 - wide) * _outlined(field, index, points, size, time)
    if wide > 0.0:
        opacity += wide * -np.expm1(-size * _calibrated(field, index, points, size, time))
    return _dense(opacity, size)


def _calibrated(field: Field, index: int, points: np.ndarray, size: float, time: float) -> np.ndarray:
    """By the layer's calibration at the coverage that is asked for."""
    layer = field.layers[index]
    places = (points[:, :2] - np.asarray(layer.wind) * time) / layer.cell
    seen = 1.0 - _smooth(3.0 * layer.cell, 15.0 * layer.cell, size)
    asked = field.coverage(index, points[:, 0], points[:, 1])
    coverage = patchy(layer, places, asked, float(seen))
    knot = np.interp(coverage, KNOTS, np.arange(len(KNOTS)))
    top, bottom = (_below(field, index, knot, points[:, 2] + h) for h in (0.5 * size, -0.5 * size))
    depth, filled = ((t - b) / size for t, b in zip(top, bottom, strict=True))
    # low blobs see what is filled at their height, lump by lump; high ones whole columns, where clouds hide
    # each other
    low, high = layer.bounds
    tall = _smooth(0.25, 1.0, size / (high - low))
    return (1.0 - tall) * _broken(filled, 0.85 * layer.extinction, min(size, layer.body)) + tall * depth


def _broken(part: np.ndarray, extinction: float | np.ndarray, size: float) -> np.ndarray:
    """A part of the blob is filled, the rest is clear."""
    return -np.log(np.maximum(1.0 - part + part * np.exp(-extinction * size), LEAST)) / size


def _outlined(field: Field, index: int, points: np.ndarray, size: float, time: float) -> np.ndarray:
    """Opacity of blobs by the clouds around, each as wide as its model is at the blob's heights."""
    clouds, rows = field.around(index, points, time)
    near = clouds[rows]
    way = points[:, None, :2] - near["place"]
    blur = 0.25 * size * size
    tall = near["top"] - near["base"]
    ends = (points[:, None, 2] - near["base"] + np.array([[-0.5 * size], [0.5 * size]])[..., None]) / tall
    low, high = np.clip(ends, 0.0, 1.0)
    some = (high > low) & (near["radius"] > 0.0)
    span = np.where(some, high - low, 1.0)
    parts = (low + span / 6.0, low + 0.5 * span, high - span / 6.0)
    areas = np.stack([_area_at(field, near["model"], np.clip(part, 0.0, 1.0)) for part in parts])
    widest = areas.max(0)
    depth = 0.85 * near["extinction"] * span * tall * areas.mean(0) / np.maximum(widest, 1e-6)
    own = 0.5 * near["radius"] ** 2 * widest
    k = np.maximum(1.0 - 0.5 * (way * way).sum(-1) / (own + blur), 0.0)
    hidden = 1.5 * near["formation"] * own / (own + blur) * k * k * -np.expm1(-depth)
    return np.minimum(np.where(some, hidden, 0.0).sum(1), 1.0)


def _area_at(field: Field, model: np.ndarray, part: np.ndarray) -> np.ndarray:
    """Area of models at parts of their heights, over that of their discs."""
    place = part * HEIGHTS
    row = np.minimum(place.astype(np.int64), HEIGHTS - 1)
    table = field.outlines
    return table[model, row] + (place - row) * (table[model, row + 1] - table[model, row])


def _below(field: Field, index: int, knot: np.ndarray, height: np.ndarray) -> list[np.ndarray]:
    """Optical depth of columns of a layer below heights, and how much of them is filled; by calibration."""
    low, high = field.layers[index].bounds
    found = field.calibrations[index]
    row = np.minimum(knot.astype(np.int64), len(KNOTS) - 2)
    place = np.clip((height - low) / (high - low), 0.0, 1.0) * HEIGHTS
    part = np.minimum(place.astype(np.int64), HEIGHTS - 1)
    f, g = place - part, knot - row
    out = []
    for table in (found.profile, found.filled):
        below = table[row, part] + f * (table[row, part + 1] - table[row, part])
        above = table[row + 1, part] + f * (table[row + 1, part + 1] - table[row + 1, part])
        out.append(below + g * (above - below))
    return out


def _smooth(low: float, high: float, x: float | np.ndarray) -> np.ndarray:
    t = np.clip((x - low) / (high - low), 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t)
