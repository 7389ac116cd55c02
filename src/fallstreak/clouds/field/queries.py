"""What `world.clouds` answers: extinction, optical depth, inside; vectorised, float64."""

from __future__ import annotations

from datetime import datetime
from typing import Any

import numpy as np

from .model import Field, field_of

_LEAST, _MOST = 24, 4096  # steps of a line through a layer
_FINE = 60.0  # steps to a repeat of the coarse noise
_PLACES = 1 << 17


def extinction(world: Any, points: Any, time: Any = 0.0) -> np.ndarray:
    """Extinction of all clouds, 1/m; see `world.clouds.extinction`."""
    places, shape = _places(points)
    return field_of(world).extinction(places, seconds(world, time)).reshape(shape)


def inside(world: Any, points: Any, time: Any = 0.0) -> np.ndarray:
    """Whether places are in a cloud; see `world.clouds.inside`."""
    places, shape = _places(points)
    field, now = field_of(world), seconds(world, time)
    out = np.zeros(len(places), bool)
    for index, layer in enumerate(field.layers):
        out |= field.layer_extinction(index, places, now) > 0.1 * layer.extinction
    return out.reshape(shape)


def optical_depth(world: Any, a: Any, b: Any, time: Any = 0.0) -> np.ndarray:
    """Optical depth along lines; see `world.clouds.optical_depth`.

    Midpoints of steps that are a 60th of the noise's repeat (humilis 25 m, cumulonimbus 180 m); lines longer
    than 4096 of them have longer ones. Error about 2 % of lines that meet a cloud.
    """
    starts, ends = np.broadcast_arrays(np.asarray(a, np.float64), np.asarray(b, np.float64))
    start, shape = _places(starts)
    end, _ = _places(ends)
    field, now = field_of(world), seconds(world, time)
    total = np.zeros(len(start))
    for index in range(len(field.layers)):
        total += _through(field, index, start, end, now)
    return total.reshape(shape)


def _through(field: Field, index: int, start: np.ndarray, end: np.ndarray, time: float) -> np.ndarray:
    """Optical depth of a layer along lines (n, 3)."""
    layer = field.layers[index]
    low, high = layer.bounds
    rise = end[:, 2] - start[:, 2]
    with np.errstate(divide="ignore", invalid="ignore"):
        cuts = (np.array([low, high]) - start[:, 2:]) / rise[:, None]
    level = np.abs(rise) < 1e-9
    within = (start[:, 2] > low) & (start[:, 2] < high)
    first = np.where(level, 0.0, np.clip(cuts.min(1), 0.0, 1.0))
    last = np.where(level, within.astype(float), np.clip(cuts.max(1), 0.0, 1.0))
    length = np.linalg.norm(end - start, axis=1) * (last - first)
    at = np.flatnonzero(length > 0.0)
    steps = np.clip(np.ceil(length[at] * _FINE / layer.tile), _LEAST, _MOST).astype(np.int64)
    total = np.zeros(len(start))
    done = 0
    while done < len(at):
        # as many lines as fit, at least one
        count = max(int(np.searchsorted(np.cumsum(steps[done:]), _PLACES)), 1)
        lines, number = at[done : done + count], steps[done : done + count]
        each = np.repeat(np.arange(len(lines)), number)
        rank = np.arange(len(each)) - np.repeat(np.cumsum(number) - number, number)
        line = lines[each]
        part = first[line] + (last[line] - first[line]) * (rank + 0.5) / number[each]
        points = start[line] + part[:, None] * (end[line] - start[line])
        found = field.layer_extinction(index, points, time)
        total[lines] = np.bincount(each, found, len(lines)) * length[lines] / number
        done += count
    return total


def seconds(world: Any, time: Any) -> float:
    """Seconds since the scene's start, of a number or of a moment."""
    if isinstance(time, datetime):
        if time.tzinfo is None:
            raise ValueError(f"time {time.isoformat()} has no zone")
        return (time - world.time).total_seconds()
    value = float(time)
    if not np.isfinite(value):
        raise ValueError(f"time must be finite, not {value}")
    return value


def _places(points: Any) -> tuple[np.ndarray, tuple[int, ...]]:
    """(n, 3) float64, and the shape without the last axis."""
    places = np.asarray(points, np.float64)
    if places.ndim == 0 or places.shape[-1] != 3:
        raise ValueError(f"places must be (..., 3): east, north, height in metres; not {places.shape}")
    if not np.isfinite(places).all():
        raise ValueError("places must be finite")
    return places.reshape(-1, 3), places.shape[:-1]
