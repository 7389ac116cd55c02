"""Shadows of triangles by rays, float64: what maps are compared with."""

from __future__ import annotations

import numpy as np


def shaded(points: np.ndarray, key: np.ndarray, triangles: np.ndarray, clear: float = 1e-6) -> np.ndarray:
    """Which points have a triangle between them and a parallel light.

    Parameters
    ----------
    points : (n, 3)
    key : (3,)
        Unit, towards the light.
    triangles : (m, 3, 3)
        Corners.
    clear : float
        m, along the ray, that count as the point's own surface.

    Returns
    -------
    (n,) bool
    """
    # In the plane across the light a ray is a point: inside of a triangle there, below it along the light.
    z = np.asarray(key, np.float64)
    x = np.cross(z, np.eye(3)[np.argmin(np.abs(z))])
    x /= np.linalg.norm(x)
    basis = np.stack([x, np.cross(z, x), z])
    at, corners = points @ basis.T, triangles @ basis.T
    low, high = corners[..., :2].min(1), corners[..., :2].max(1)
    found = np.zeros(len(points), bool)
    for (a, b, c), first, last in zip(corners, low, high, strict=True):
        area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        if area == 0.0:
            continue
        near = np.flatnonzero(((at[:, :2] >= first) & (at[:, :2] <= last)).all(1) & ~found)
        if not len(near):
            continue
        p = at[near]
        v = ((p[:, 0] - a[0]) * (c[1] - a[1]) - (p[:, 1] - a[1]) * (c[0] - a[0])) / area
        w = ((b[0] - a[0]) * (p[:, 1] - a[1]) - (b[1] - a[1]) * (p[:, 0] - a[0])) / area
        above = a[2] + v * (b[2] - a[2]) + w * (c[2] - a[2]) - p[:, 2]
        found[near] = (v >= 0.0) & (w >= 0.0) & (v + w <= 1.0) & (above > clear)
    return found
