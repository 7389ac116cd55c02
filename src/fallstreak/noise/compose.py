"""What is made from several noises: curls, which have no sources, and sums of octaves at displaced points."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from .tiles import launch, octaves_of

BLOCK = 1 << 16  # points whose displacements stay in the cache
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
    parts = [octaves_of(**series, offset=APART * k) for k in range(1 if len(axes) == 2 else 3)]
    frequencies, amplitudes, _, periods = parts[0]
    octaves = frequencies, amplitudes, np.concatenate([part[2] for part in parts], 1), periods
    potential = np.empty(len(out), np.float32)
    launch(axes, [potential, *out.T], octaves, kind="curl", derivatives=True, threads=threads)


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
    for start in range(0, len(out), BLOCK):
        here, value = [axis[start : start + BLOCK] for axis in axes], out[start : start + BLOCK]
        moved = []
        for axis, part in zip(here, parts[1:], strict=True):
            launch(here, [value], part, kind=kind, threads=threads)
            moved.append(axis + value * axis.dtype.type(amount))
        launch(moved, [value], parts[0], kind=kind, threads=threads)
