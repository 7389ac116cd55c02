"""Where the sections of the atlas lie: shelves of squares of four sizes."""

from __future__ import annotations

import numpy as np

TILE = 16
"""Texels along a side of what one workgroup draws; the smallest section."""


def sections(shelves: tuple[tuple[int, int], ...], width: int) -> tuple[np.ndarray, int]:
    """All sections of an atlas.

    Parameters
    ----------
    shelves : sequence of (size, count)
        Largest first; sizes are multiples of `TILE` and divide `width`.
    width : int
        Texels.

    Returns
    -------
    table : (n, 4) uint32
        x, y of the corner, size, number of the shelf.
    height : int
        Texels that they need.
    """
    rows, top = [], 0
    for shelf, (size, count) in enumerate(shelves):
        across = width // size
        number = np.arange(count)
        rows.append(
            np.stack([number % across * size, top + number // across * size,
                      np.full(count, size), np.full(count, shelf)], 1)
        )  # fmt: skip
        top += -(-count // across) * size
    return np.concatenate(rows).astype(np.uint32), top
