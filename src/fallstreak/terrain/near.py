"""How far the camera is from the ground, walls beside it too: what the level of detail goes by."""

from __future__ import annotations

from math import floor

import numpy as np

from .model import TerrainModel

STEP, SQUARE, REACH = 16.0, 256.0, 128.0  # m: between samples, of the squares they are kept for, around those


class NearGround:
    """The ground about the camera in samples 16 m apart, worked out anew where it enters a square of 256 m.

    Parameters
    ----------
    model : TerrainModel
        With land.
    """

    def __init__(self, model: TerrainModel):
        self._model = model
        self._square: tuple[int, int] | None = None
        self._points = np.zeros((0, 0, 3))  # m from the square's corner, and above sea level
        self._edges = np.zeros((0, 2, 3))  # between neighbours: where they begin, and on to their end
        self._lengths = np.zeros(0)  # their squares

    def distance(self, east: float, north: float, height: float) -> float:
        """Metres to the nearest ground or water, about; a continuous function of the place alone.

        Parameters
        ----------
        east, north : m on the map
        height : m above sea level
        """
        square = floor(east / SQUARE), floor(north / SQUARE)
        if square != self._square:
            self._square = square
            self._sample(square)
        x, y = east - square[0] * SQUARE, north - square[1] * SQUARE
        u, v = (x + REACH) / STEP, (y + REACH) / STEP
        i, j = int(u), int(v)
        low = self._points[j : j + 2, i : i + 2, 2]
        south, north_ = low[:, 0] + (u - i) * (low[:, 1] - low[:, 0])
        below = max(height - float(south + (v - j) * (north_ - south)), 0.0)
        # what stands beside; its weight ends where the samples do
        start, along = self._edges[:, 0], self._edges[:, 1]
        d = np.array([x, y, height]) - start
        d -= np.clip((d * along).sum(1) / self._lengths, 0.0, 1.0)[:, None] * along
        beside = float(np.sqrt((d * d).sum(1).min()))
        return min(below, beside / (1.0 - (beside / REACH) ** 2)) if beside < REACH else below

    def _sample(self, square: tuple[int, int]) -> None:
        along = np.arange(-REACH, SQUARE + REACH + 1.0, STEP)
        x, y = np.meshgrid(along, along)
        found = self._model.shape(x + square[0] * SQUARE, y + square[1] * SQUARE, STEP)
        p = np.stack([x + found.shift_east, y + found.shift_north, np.maximum(found.height, found.water)], -1)
        pairs = ((p[:, :-1], p[:, 1:]), (p[:-1], p[1:]))
        self._points = p
        self._edges = np.concatenate(
            [np.stack([a.reshape(-1, 3), (b - a).reshape(-1, 3)], 1) for a, b in pairs]
        )
        self._lengths = np.maximum((self._edges[:, 1] ** 2).sum(1), 1e-6)
