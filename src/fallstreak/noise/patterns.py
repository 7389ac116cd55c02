"""Perlin noise in the scale that looks are made in, standard deviation 0.25: twin of ``patterns.wesl``."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from .api import gradient, sample

SCALE = 0.7569  # 0.25 over the standard deviation of Perlin noise in 2-D


def value(x: ArrayLike, y: ArrayLike, seed: int) -> np.ndarray:
    """One octave of 2-D noise.

    Parameters
    ----------
    x, y : arrays, broadcast against each other
        In cells, taken as float64.
    seed : int
        Any; taken modulo 2^32.

    Returns
    -------
    float64 array
        Mean 0, standard deviation 0.25, at most about 0.77.
    """
    points, shape = _points(x, y)
    return SCALE * sample(points, seed=seed & 0xFFFFFFFF, threads=1).astype(np.float64).reshape(shape)


def slope(x: ArrayLike, y: ArrayLike, seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """As `value`, with the derivatives along x and y, per cell."""
    points, shape = _points(x, y)
    found, slopes = gradient(points, seed=seed & 0xFFFFFFFF, threads=1)
    dx, dy = SCALE * slopes.T.astype(np.float64)
    return SCALE * found.astype(np.float64).reshape(shape), dx.reshape(shape), dy.reshape(shape)


def _points(x: ArrayLike, y: ArrayLike):
    x, y = np.broadcast_arrays(np.asarray(x, np.float64), np.asarray(y, np.float64))
    return (x.ravel(), y.ravel()), x.shape
