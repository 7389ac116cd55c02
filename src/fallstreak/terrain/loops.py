"""Compiled loops over heights (see `quick`): each does in one pass what takes NumPy dozens over an array.

They add and multiply in the order in which NumPy's would, so the numbers are the same. What they are given is
float64 and contiguous; threads may run side by side.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit

from ..noise.machine_code import keyed

_STRIPE = 64  # columns at a time: two passes over them find them in the cache
_LANES = 8  # rows at a time along a row: their chains of sums do not wait for each other


def _compiled(function) -> Any:
    return keyed(njit(cache=True, nogil=True, error_model="numpy")(function))


@_compiled
def filter_down(values, pole):
    """The recursive filter along the first axis, in place; row 0 holds its start already."""
    rows, columns = values.shape
    last = pole / (pole * pole - 1.0)
    for left in range(0, columns, _STRIPE):
        right = min(left + _STRIPE, columns)
        for i in range(1, rows):
            for j in range(left, right):
                values[i, j] += pole * values[i - 1, j]
        for j in range(left, right):
            values[rows - 1, j] = last * (values[rows - 1, j] + pole * values[rows - 2, j])
        for i in range(rows - 2, -1, -1):
            for j in range(left, right):
                values[i, j] = pole * (values[i + 1, j] - values[i, j])


@_compiled
def filter_across(values, pole):
    """The recursive filter along the second axis, in place; column 0 holds its start already."""
    rows, columns = values.shape
    last = pole / (pole * pole - 1.0)
    for top in range(0, rows, _LANES):
        bottom = min(top + _LANES, rows)
        for j in range(1, columns):
            for i in range(top, bottom):
                values[i, j] += pole * values[i, j - 1]
        for i in range(top, bottom):
            values[i, columns - 1] = last * (values[i, columns - 1] + pole * values[i, columns - 2])
        for j in range(columns - 2, -1, -1):
            for i in range(top, bottom):
                values[i, j] = pole * (values[i, j + 1] - values[i, j])


@_compiled
def evaluate(grid, column, row, out):
    """The spline with coefficients `grid` at fractional positions (1-D); the edge is repeated outside."""
    rows, columns = grid.shape
    wx, wy = np.empty(4), np.empty(4)
    for n in range(len(out)):
        # held in range before they become whole numbers: what lies far outside repeats the edge all the same
        across, up = np.floor(column[n]), np.floor(row[n])
        _weigh(column[n] - across, wx)
        _weigh(row[n] - up, wy)
        j = int(min(max(across, -3.0), columns + 2.0))
        i = int(min(max(up, -3.0), rows + 2.0))
        value = 0.0
        for k in range(4):
            at = min(max(i + k - 1, 0), rows - 1)
            line = 0.0
            for m in range(4):
                line += wx[m] * grid[at, min(max(j + m - 1, 0), columns - 1)]
            value += wy[k] * line
        out[n] = value


@njit(inline="always")
def _weigh(t, w):
    s = 1.0 - t
    w[0] = s * s * s / 6.0
    w[1] = (4.0 - 6.0 * t * t + 3.0 * t * t * t) / 6.0
    w[2] = (4.0 - 6.0 * s * s + 3.0 * s * s * s) / 6.0
    w[3] = t * t * t / 6.0


@_compiled
def slope_square(grid, spacing, out):
    """Square of the spline's slope at its samples, `spacing` metres apart; the edge is repeated outside."""
    rows, columns = grid.shape
    for i in range(rows):
        a, b = max(i - 1, 0), min(i + 1, rows - 1)
        for j in range(columns):
            c, d = max(j - 1, 0), min(j + 1, columns - 1)
            across = (grid[a, d] - grid[a, c]) / (2.0 * spacing)
            across += 4.0 * ((grid[i, d] - grid[i, c]) / (2.0 * spacing))
            across = (across + (grid[b, d] - grid[b, c]) / (2.0 * spacing)) / 6.0
            up = (grid[b, c] - grid[a, c]) / (2.0 * spacing)
            up += 4.0 * ((grid[b, j] - grid[a, j]) / (2.0 * spacing))
            up = (up + (grid[b, d] - grid[a, d]) / (2.0 * spacing)) / 6.0
            out[i, j] = across * across + up * up


@_compiled
def mean_down(values, width, out):
    """Means of `width` (odd) neighbours along the first axis, edges repeated."""
    rows, columns = values.shape
    ahead = width // 2 + 1
    total = np.empty((rows + width, _STRIPE))
    for left in range(0, columns, _STRIPE):
        count = min(_STRIPE, columns - left)
        for j in range(count):
            total[0, j] = values[0, left + j]
        for i in range(1, rows + width):
            at = min(max(i - ahead, 0), rows - 1)
            for j in range(count):
                total[i, j] = total[i - 1, j] + values[at, left + j]
        for i in range(rows):
            for j in range(count):
                out[i, left + j] = (total[i + width, j] - total[i, j]) / width


@_compiled
def mean_across(values, width, out):
    """Means of `width` (odd) neighbours along the second axis, edges repeated."""
    rows, columns = values.shape
    ahead = width // 2 + 1
    total = np.empty((columns + width, _LANES))
    for top in range(0, rows, _LANES):
        count = min(_LANES, rows - top)
        for i in range(count):
            total[0, i] = values[top + i, 0]
        for j in range(1, columns + width):
            at = min(max(j - ahead, 0), columns - 1)
            for i in range(count):
                total[j, i] = total[j - 1, i] + values[top + i, at]
        for j in range(columns):
            for i in range(count):
                out[top + i, j] = (total[j + width, i] - total[j, i]) / width


@_compiled
def accumulate(values):
    """Each sample becomes the sum of its row up to it, in place; uint16 (rows, columns), modulo 65,536."""
    rows, columns = values.shape
    for top in range(0, rows, _LANES):
        bottom = min(top + _LANES, rows)
        for j in range(1, columns):
            for i in range(top, bottom):
                values[i, j] += values[i, j - 1]


def warm() -> None:
    """Compile all of them, or load what an earlier process compiled."""
    grid, line = np.zeros((4, 4)), np.zeros(4)
    filter_down(grid, 0.5)
    filter_across(grid, 0.5)
    evaluate(grid, line, line, line.copy())
    slope_square(grid, 1.0, grid.copy())
    mean_down(grid, 3, grid.copy())
    mean_across(grid, 3, grid.copy())
    accumulate(np.zeros((4, 4), np.uint16))
