"""Which levels of the land are swept in a frame."""

from __future__ import annotations

from math import radians

import numpy as np

LEFT = 1.0 / 16.0
"""Of its width that a window may be left behind by, and half a tile: then its level is due."""
LOST = 1.0 / 8.0
"""The same, where what is asked for would soon lie outside: such a level does not wait for its turn."""
TURNED = radians(0.02)
"""By which the light may turn when it stands on the horizon: 10 m for shadows thrown 30 km far."""
PATIENCE = 12.0
"""Times `TURNED` by which a level may be behind while it waits for its turn."""


class Schedule:
    """One level a frame, the one that is behind the most; all that cannot wait; all in a first frame.

    Parameters
    ----------
    levels : int
    width : int
        Of a window, samples.

    Attributes
    ----------
    known : (levels,) bool
        Levels that have been swept.
    firsts : (levels, 2)
        First sample of each level's window, east and north, when it was swept.
    """

    def __init__(self, levels: int, width: int):
        self._width = width
        self.known = np.zeros(levels, bool)
        self.firsts = np.zeros((levels, 2))
        self._keys = np.zeros((levels, 3))  # the light as it was then

    def swept(self, level: int, first: np.ndarray, key: np.ndarray) -> None:
        """A level is swept with this first sample of its window, this light."""
        self.known[level], self.firsts[level], self._keys[level] = True, first, key

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
        left = np.abs(middles - self.firsts - 0.5 * self._width).max(1) / self._width
        may_turn = TURNED * (1.0 + 10.0 * abs(float(key[2])))
        turned = np.sqrt(((key - self._keys) ** 2).sum(1)) / may_turn
        # half a tile is what a window always is beside its camera
        behind = np.maximum((left - 16.0 / self._width) / LEFT, turned)
        lost = ~self.known | (left > LOST) | (turned > PATIENCE) | fresh
        lost[:finest], behind[:finest] = False, 0.0
        behind[lost] = 0.0
        worst = int(behind.argmax())
        lost[worst] |= behind[worst] > 1.0
        return np.flatnonzero(lost)[::-1].tolist()
