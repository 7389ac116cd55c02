"""Where the levels of the land are swept, and which of them in a frame.

That depends on camera and light alone, not on the way that led there: pictures after a lost GPU, or of a
sequence that goes on elsewhere, are the same. A level goes on from what the next coarser one says, so it is
swept again when that is.
"""

from __future__ import annotations

from math import radians

import numpy as np

TURNED = radians(0.02)
"""By which the light turns from one sweep to the next: 10 m for shadows that are thrown 30 km far."""


def key_near(key: np.ndarray) -> np.ndarray:
    """The light next to `key` on a lattice of `TURNED`."""
    near = (np.round(np.asarray(key, np.float64) / TURNED + 0.137) - 0.137) * TURNED
    return near / np.linalg.norm(near)


class Schedule:
    """What each level was swept for.

    Parameters
    ----------
    levels : int

    Attributes
    ----------
    firsts : (levels, 2) int
        First sample of each level's window when it was last swept.
    known : (levels,) bool
        Levels that are swept.
    """

    def __init__(self, levels: int):
        self.firsts = np.zeros((levels, 2), np.int64)
        self.known = np.zeros(levels, bool)
        self._key = np.zeros(3)

    def due(self, firsts: np.ndarray, key: np.ndarray, finest: int, *, fresh: bool) -> list[int]:
        """Levels to sweep in a frame, coarse ones first; from now on they count as swept.

        Parameters
        ----------
        firsts : (levels, 2) int
            First sample of each level's window, east and north.
        key : (3,)
            Towards the light, from `key_near`.
        finest : int
            Levels finer than this are not held.
        fresh : bool
            Nothing from before counts.
        """
        if fresh or not np.array_equal(key, self._key):
            self.known[:] = False
        moved = ~self.known | (firsts != self.firsts).any(1)
        moved[:finest] = False
        held = np.arange(len(moved)) >= finest
        coarsest = int(np.flatnonzero(moved)[-1]) if moved.any() else -1
        due = held & (np.arange(len(moved)) <= coarsest)
        # what is not held any more is to be swept when it comes back
        self.known = (self.known | due) & held
        self.firsts[due], self._key = firsts[due], np.array(key)
        return np.flatnonzero(due)[::-1].tolist()
