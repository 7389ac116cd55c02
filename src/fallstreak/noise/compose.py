"""What is made from several noises: curls, which have no sources, and sums of octaves at displaced points.

Both work in blocks of points that stay in the second-level cache.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from .tiles import launch, octaves_of

BLOCK = 1 << 16
APART = 256  # octaves between the seeds of the parts, more than a sum can have


def curl(axes: Sequence[np.ndarray], out: np.ndarray, *, threads: int = 1, **series: Any) -> None:
    """Fill `out` with the curl of Perlin noise (Bridson, Houriham, Nordenstam 2007: "Curl-noise").

    Parameters
    ----------
    axes : sequence of 2 or 3 flat arrays
        As for `tiles.fbm`. In 2-D the potential is the noise itself, in 3-D it has three components, of
        which the first is the noise itself.
    out : float32 array (n, D)
        Derivatives are by the points' coordinates.
    **series
        As for `tiles.fbm`.
    """
    count = len(axes)
    parts = [octaves_of(**series, offset=APART * k) for k in range(1 if count == 2 else 3)]
    for block in _blocks(len(out)):
        here, flow = [axis[block] for axis in axes], out[block]
        slopes = np.empty((len(parts), 1 + count, len(flow)), np.float32)
        for part, outputs in zip(parts, slopes, strict=True):
            launch(here, list(outputs), part, kind="perlin", derivatives=True, threads=threads)
        if count == 2:
            flow[:, 0] = slopes[0, 2]
            np.negative(slopes[0, 1], out=flow[:, 1])
        else:
            for axis in range(3):
                after, last = (axis + 1) % 3, (axis + 2) % 3
                np.subtract(slopes[last, 1 + after], slopes[after, 1 + last], out=flow[:, axis])


def warp(
    axes: Sequence[np.ndarray], out: np.ndarray, amount: float, *, kind: str, threads: int = 1, **series: Any
) -> None:
    """Fill `out` with a sum of octaves at points that D others of its sort displace (I. Quilez, 2002).

    Parameters
    ----------
    axes, kind, threads, **series
        As for `tiles.fbm`.
    out : flat float32 array
    amount : float
        What a displacement of 1 is worth in the units of the points.
    """
    parts = [octaves_of(**series, offset=APART * k) for k in range(len(axes) + 1)]
    for block in _blocks(len(out)):
        here, value = [axis[block] for axis in axes], out[block]
        moved = []
        for axis, part in zip(here, parts[1:], strict=True):
            launch(here, [value], part, kind=kind, threads=threads)
            moved.append(axis + value * axis.dtype.type(amount))
        launch(moved, [value], parts[0], kind=kind, threads=threads)


def _blocks(count: int):
    return (slice(start, start + BLOCK) for start in range(0, count, BLOCK))
