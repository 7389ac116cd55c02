"""How far a place is from where nothing is known: what is too wide to be filled from around."""

from __future__ import annotations

import numpy as np

_SIDE = 256  # samples across, at most: distances of holes need no more


def room_around_holes(known: np.ndarray, widest: float) -> tuple[np.ndarray, int] | None:
    """Distances to holes that a disc wider than `widest` fits into.

    Parameters
    ----------
    known : (rows, columns) bool
    widest : samples

    Returns
    -------
    None where there are no such holes, else the distances, in samples of `known` (0 in the hole), and how
    many of those a distance stands for in each direction.
    """
    step = -(-max(known.shape) // _SIDE)
    pad = [(0, -n % step) for n in known.shape]
    blocks = np.pad(known, pad, mode="edge")
    share = blocks.reshape(blocks.shape[0] // step, step, -1, step).mean((1, 3))
    hole = share < 0.5
    radius = 0.5 * widest / step
    core = hole & (distance(~hole) > max(radius, 1.0))
    if not core.any():
        return None
    wide = hole & (distance(core) <= radius + 1.0)
    return np.maximum(distance(wide) - 0.5, 0.0) * step, step


def distance(to: np.ndarray) -> np.ndarray:
    """Euclidean distance of every sample to the nearest one that is marked, in samples (inf without any)."""
    rows, columns = to.shape
    down = np.where(to, 0.0, np.inf)
    for i in range(1, rows):
        down[i] = np.minimum(down[i], down[i - 1] + 1.0)
    for i in range(rows - 2, -1, -1):
        down[i] = np.minimum(down[i], down[i + 1] + 1.0)
    square = down * down
    apart = (np.arange(columns)[:, None] - np.arange(columns)) ** 2
    return np.sqrt(np.stack([(row + apart).min(1) for row in square]))
