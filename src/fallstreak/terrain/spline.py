"""Cubic B-splines on a grid: twice differentiable, so that a 90 m elevation model does not look faceted.

A spline through the samples needs coefficients that differ from them (Unser, Aldroubi, Eden 1991, "Fast
B-spline transforms": one recursive filter each way). The GPU evaluates the same coefficients with the same 16
weights (`sampling.wesl`), so that CPU and GPU agree to rounding.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from .quick import loops

_POLE = np.sqrt(3.0) - 2.0


def coefficients(samples: np.ndarray) -> np.ndarray:
    """Samples (rows, columns) → coefficients of the cubic B-spline through them (mirrored edges), float64."""
    quick = loops()
    if quick is None:
        return _filter(_filter(np.asarray(samples, np.float64)).T).T
    out = np.multiply(samples, 6.0, dtype=np.float64, order="C")
    out[0] = _start(out)
    quick.filter_down(out, _POLE)
    out *= 6.0
    out[:, 0] = _start(out.T)
    quick.filter_across(out, _POLE)
    return out


def _filter(values: np.ndarray) -> np.ndarray:
    # Along the first axis: causal, then anticausal; each step is one vector operation over the other axis.
    out = values * 6.0
    out[0] = _start(out)
    for i in range(1, len(out)):
        out[i] += _POLE * out[i - 1]
    out[-1] = _POLE / (_POLE * _POLE - 1.0) * (out[-1] + _POLE * out[-2])
    for i in range(len(out) - 2, -1, -1):
        out[i] = _POLE * (out[i + 1] - out[i])
    return out


def _start(lines: np.ndarray) -> np.ndarray:
    # the causal filter's first value, of lines that are mirrored there
    powers = _POLE ** np.arange(min(len(lines), 30))
    return np.tensordot(powers, lines[: len(powers)], 1)


def weights(t: np.ndarray) -> tuple[np.ndarray, ...]:
    """The four B-spline weights at fraction ``t`` between the second and the third coefficient."""
    s = 1.0 - t
    return (
        s * s * s / 6.0,
        (4.0 - 6.0 * t * t + 3.0 * t * t * t) / 6.0,
        (4.0 - 6.0 * s * s + 3.0 * s * s * s) / 6.0,
        t * t * t / 6.0,
    )


def slope_weights(t: np.ndarray) -> tuple[np.ndarray, ...]:
    """Derivatives of `weights` by ``t``."""
    s = 1.0 - t
    return -0.5 * s * s, 1.5 * t * t - 2.0 * t, 2.0 * s - 1.5 * s * s, 0.5 * t * t


def evaluate(grid: np.ndarray, column: Any, row: Any) -> np.ndarray:
    """The spline at fractional positions (sample centres are whole numbers; the edge is repeated outside)."""
    column, row = np.broadcast_arrays(np.asarray(column, np.float64), np.asarray(row, np.float64))
    quick = loops()
    if quick is not None:
        value = np.empty(column.shape)
        # of one type, writable too: for another, Numba would compile the loop once more
        grid, column, row = (np.require(x, np.float64, ["C", "W"]) for x in (grid, column, row))
        quick.evaluate(grid, column.ravel(), row.ravel(), value.reshape(-1))
        return value
    value = np.zeros(column.shape)
    wx, wy = weights(column - np.floor(column)), weights(row - np.floor(row))
    for k, taps in enumerate(_taps(grid, column, row)):
        value += wy[k] * sum(w * tap for w, tap in zip(wx, taps, strict=True))
    return value


def evaluate_with_slopes(
    grid: np.ndarray, column: Any, row: Any
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Values, derivatives by column, derivatives by row; see `evaluate`."""
    column, row = np.broadcast_arrays(np.asarray(column, np.float64), np.asarray(row, np.float64))
    value, dx, dy = (np.zeros(column.shape) for _ in range(3))
    tx, ty = column - np.floor(column), row - np.floor(row)
    wx, wy, sx, sy = weights(tx), weights(ty), slope_weights(tx), slope_weights(ty)
    for k, taps in enumerate(_taps(grid, column, row)):
        line = sum(w * tap for w, tap in zip(wx, taps, strict=True))
        value += wy[k] * line
        dx += wy[k] * sum(w * tap for w, tap in zip(sx, taps, strict=True))
        dy += sy[k] * line
    return value, dx, dy


def _taps(grid: np.ndarray, column: np.ndarray, row: np.ndarray) -> Iterator[list[np.ndarray]]:
    """For each of the four rows around a position, the four coefficients in it."""
    j, i = np.floor(column).astype(np.intp), np.floor(row).astype(np.intp)
    flat = grid.ravel()
    columns = [np.clip(j + k, 0, grid.shape[1] - 1) for k in range(-1, 3)]
    for k in range(-1, 3):
        start = np.clip(i + k, 0, grid.shape[0] - 1) * grid.shape[1]
        yield [flat.take(start + c, mode="clip") for c in columns]


def blur(values: np.ndarray, radius: float) -> np.ndarray:
    """Near-Gaussian mean with standard deviation ``radius`` samples: three box means, edges repeated."""
    width = max(round(np.sqrt(4.0 * radius * radius + 1.0)), 1) | 1
    quick = loops()
    out = np.array(values, np.float64, order="C")
    if quick is not None:
        between = np.empty_like(out)
        for _ in range(3):
            quick.mean_down(out, width, between)
            quick.mean_across(between, width, out)
        return out
    for axis in (0, 1, 0, 1, 0, 1):
        pad = [(0, 0), (0, 0)]
        pad[axis] = (width // 2 + 1, width // 2)
        total = np.cumsum(np.pad(out, pad, mode="edge"), axis=axis)
        out = (total[width:] - total[:-width] if axis == 0 else total[:, width:] - total[:, :-width]) / width
    return out


def halved(values: np.ndarray) -> np.ndarray:
    """Means of blocks of 2 × 2; an odd last row or column is left out."""
    rows, columns = (n // 2 * 2 for n in values.shape)
    upper, lower = values[0:rows:2], values[1:rows:2]
    out = upper[:, 0:columns:2] + upper[:, 1:columns:2]
    out += lower[:, 0:columns:2] + lower[:, 1:columns:2]
    out *= 0.25
    return out
