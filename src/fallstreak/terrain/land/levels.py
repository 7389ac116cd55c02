"""Land from an elevation model or the fractal, sampled into nested levels: twin of ``levels.wesl``."""

from __future__ import annotations

import numpy as np

from .. import spline
from ..pyramid import SIZE, Pyramid
from .character import bound, detail, first_octave
from .shape import NO_WATER, LandShape

BORDER = (0.8, 0.95)  # heights.wesl


class Levels:
    """Heights from a pyramid of B-splines, with detail in its character below its resolution.

    Parameters
    ----------
    pyramid : Pyramid
    extent : m, half the width of the map
    seed : of the detail
    water_level : m
    """

    shift_bound = 0.0

    def __init__(self, pyramid: Pyramid, extent: float, seed: int, water_level: float = NO_WATER):
        self.pyramid, self.extent, self.seed, self.water_level = pyramid, extent, seed, water_level
        self.outside = pyramid.outside

    def bounds(self) -> tuple[float, float]:
        """Lowest and highest height anywhere, m."""
        room = bound(first_octave(self.pyramid.spacing))
        return self.pyramid.lowest - room, self.pyramid.highest + room

    def shape(self, east, north, step) -> LandShape:
        """The land as a mesh with `step` metres between vertices can carry it."""
        e, n, step = np.broadcast_arrays(
            np.asarray(east, np.float64), np.asarray(north, np.float64), np.asarray(step, np.float64)
        )
        height, across, up, lost = (
            x.reshape(e.shape)[()] for x in self._form(*(np.atleast_1d(a).ravel() for a in (e, n, step)))
        )
        e, n, step = e[()], n[()], step[()]  # one place is a number, for which noise is quick
        here = land_weight(self.extent, e, n)
        added = detail(e, n, across, up, first_octave(self.pyramid.spacing), step, self.seed)
        height = height + here * added.height
        lost = np.sqrt(lost * lost + here * here * added.lost)
        zero = np.zeros_like(height)
        return LandShape(height, zero + self.water_level, zero, zero, lost, zero + 1.0)

    def _form(self, e, n, step):
        """Height, its derivatives and the slope left out, without detail; flat arrays."""
        pyramid = self.pyramid
        wanted = np.log2(np.maximum(step, 1e-6) / pyramid.spacing)
        level = np.clip(np.maximum(covering_level(pyramid, e, n), wanted), 0.0, pyramid.levels - 1.0)
        out = np.zeros((4, len(e)))
        for k in range(pyramid.levels):
            weight = np.clip(1.0 - np.abs(level - k), 0.0, 1.0)
            here = weight > 0.0
            if here.any():
                spacing = pyramid.spacing * 2**k
                column, row = (x[here] / spacing + (SIZE / 2 - 0.5) for x in (e, n))
                value, dx, dy = spline.evaluate_with_slopes(pyramid.coefficients[k], column, row)
                lost = pyramid.lost_at(k, column, row)
                out[:, here] += weight[here] * np.stack([value, dx / spacing, dy / spacing, lost])
        return out


def covering_level(pyramid: Pyramid, east, north):
    """The finest level that covers a place, as a real number (twin of heights.wesl)."""
    reach = np.maximum(np.abs(east), np.abs(north)) / (0.5 * SIZE * pyramid.spacing * BORDER[1])
    level = np.maximum(np.ceil(np.log2(np.maximum(reach, 1e-6))), 0.0)
    t = np.clip((reach * 2.0**-level * BORDER[1] - BORDER[0]) / (BORDER[1] - BORDER[0]), 0.0, 1.0)
    return level + t * t * (3.0 - 2.0 * t)


def land_weight(extent: float, east, north):
    """1 on the land, 0 where it has sunk to the globe at the edge of the map."""
    return np.clip(10.0 - 10.0 * np.hypot(east, north) / (0.97 * extent), 0.0, 1.0)
