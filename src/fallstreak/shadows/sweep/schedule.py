"""Which levels of the land are swept in a frame."""

from __future__ import annotations

from dataclasses import dataclass
from math import radians, sin

import numpy as np

LEFT = 1.0 / 16.0
"""Of its width that a window may be left behind by, and half a tile: then its level is due."""
LOST = 1.0 / 8.0
"""The same, where what is asked for would soon lie outside: such a level does not wait for its turn."""
TURNED = radians(0.02)
"""By which the light may turn when it stands on the horizon: 10 m for shadows thrown 30 km far."""
PATIENCE = 12.0
"""Times `TURNED` by which a level may be behind while it waits for its turn."""


@dataclass(frozen=True)
class Swept:
    """How a level was swept.

    Attributes
    ----------
    first : (2,) int
        First sample of its window, east and north.
    key : (3,)
        Towards the light, east, north and up at that camera.
    """

    first: np.ndarray
    key: np.ndarray


class Schedule:
    """One level a frame, the one that is behind the most; all that cannot wait; all in a first frame.

    Parameters
    ----------
    levels : int
    width : int
        Of a window, samples.

    Attributes
    ----------
    swept : list
        `Swept` of each level, None before its first time.
    """

    def __init__(self, levels: int, width: int):
        self._width = width
        self.swept: list[Swept | None] = [None] * levels

    def due(self, middles: np.ndarray, key: np.ndarray, finest: int, *, fresh: bool) -> list[int]:
        """Levels to sweep in a frame, coarse ones first: finer ones go on from them.

        Parameters
        ----------
        middles : (levels, 2)
            The camera on the map, in samples of each level.
        key : (3,)
            Towards the light, in the camera's axes.
        finest : int
            Levels finer than this are not held.
        fresh : bool
            Nothing from before counts.
        """
        behind = np.full(len(self.swept), np.inf)
        for level, swept in enumerate(self.swept):
            if level < finest:
                behind[level] = 0.0
            elif swept is not None and not fresh:
                behind[level] = self._behind(swept, middles[level], key)
        due = set(np.flatnonzero(np.isinf(behind)).tolist())
        worst = int(np.argmax(behind))
        if behind[worst] > 1.0:
            due.add(worst)
        return sorted(due, reverse=True)

    def _behind(self, swept: Swept, middle: np.ndarray, key: np.ndarray) -> float:
        """How far a level is behind, in what it may be; infinite where it must not wait."""
        left = float(np.abs(middle - swept.first - 0.5 * self._width).max()) / self._width
        turned = float(np.linalg.norm(key - swept.key)) / (TURNED * (1.0 + 10.0 * sin(abs(key[2]))))
        if left > LOST or turned > PATIENCE:
            return np.inf
        # half a tile is what a window always is beside its camera
        return max((left - 16.0 / self._width) / LEFT, turned)
