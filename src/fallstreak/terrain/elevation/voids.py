"""Unknown samples, filled from around, and straight lines between samples."""

from __future__ import annotations

import numpy as np


def fill_voids(values: np.ndarray, unknown: np.ndarray) -> np.ndarray:
    """Fill unknown samples by means of ever coarser neighbourhoods (push-pull, Gortler et al. 1996).

    Parameters
    ----------
    values : (rows, columns)
        What stands at unknown places does not count.
    unknown : (rows, columns) bool

    Returns
    -------
    (rows, columns) float32; zeros if nothing is known
    """
    weight = (~unknown).astype(np.float32)
    total = np.where(unknown, 0.0, values).astype(np.float32)
    if min(values.shape) <= 1 or not unknown.any():
        return np.where(unknown, total.sum() / max(weight.sum(), 1.0), values).astype(np.float32)
    pad = [(0, n % 2) for n in values.shape]
    shape = tuple((n + 1) // 2 for n in values.shape)
    w = np.pad(weight, pad).reshape(shape[0], 2, shape[1], 2).sum((1, 3))
    v = np.pad(total, pad).reshape(shape[0], 2, shape[1], 2).sum((1, 3)) / np.maximum(w, 1.0)
    coarse = fill_voids(v, w == 0.0)
    rows, columns = ((np.arange(n) - 0.5) / 2.0 for n in values.shape)
    return np.where(unknown, bilinear(coarse, columns[None, :], rows[:, None]), values).astype(np.float32)


def bilinear(grid: np.ndarray, column, row) -> np.ndarray:
    """Bilinear samples of ``grid`` at fractional positions, the edge repeated outside."""
    column = np.clip(column, 0.0, grid.shape[1] - 1.0)
    row = np.clip(row, 0.0, grid.shape[0] - 1.0)
    j, i = (
        np.minimum(column.astype(int), max(grid.shape[1] - 2, 0)),
        np.minimum(row.astype(int), max(grid.shape[0] - 2, 0)),
    )
    fx, fy = column - j, row - i
    j1, i1 = np.minimum(j + 1, grid.shape[1] - 1), np.minimum(i + 1, grid.shape[0] - 1)
    top = grid[i, j] * (1.0 - fx) + grid[i, j1] * fx
    return top * (1.0 - fy) + (grid[i1, j] * (1.0 - fx) + grid[i1, j1] * fx) * fy
