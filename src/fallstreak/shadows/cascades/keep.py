"""Which maps of still things are drawn in a frame."""

from __future__ import annotations

from math import radians

import numpy as np

from .window import MARGIN, Window, around

TURNED = radians(0.02)
"""By which the light may turn: a texel of the finest map for a tree's shadow 250 m long."""
PATIENCE = 4.0
"""Times what a map may be behind, from which on it does not wait for its turn."""


class Keep:
    """Windows about the camera and what they were drawn for: one a frame, all in a first frame.

    Parameters
    ----------
    reaches : sequence of float
        m from the camera that each map holds.
    texels : int
        Along a side.

    Attributes
    ----------
    windows : list
        `Window` of each map as it was drawn last, None before.
    """

    def __init__(self, reaches: list[float], texels: int):
        self.reaches, self._texels = reaches, texels
        self.windows: list[Window | None] = [None] * len(reaches)
        self._stale = [True] * len(reaches)

    def change(self) -> None:
        """Something that throws shadows is no longer where it was."""
        self._stale = [True] * len(self.reaches)

    def due(self, axes: np.ndarray, camera: np.ndarray, *, fresh: bool) -> list[int]:
        """Maps to draw in a frame; their windows are laid anew.

        Parameters
        ----------
        axes : (3, 3)
            See `window.basis`.
        camera : (3,)
            World coordinates, m.
        fresh : bool
            Nothing from before counts.
        """
        behind = [
            np.inf if window is None or fresh else self._behind(number, window, axes, camera)
            for number, window in enumerate(self.windows)
        ]
        due = {number for number, b in enumerate(behind) if b > PATIENCE}
        worst = int(np.argmax(behind)) if behind else 0
        if behind and behind[worst] > 1.0:
            due.add(worst)
        for number in due:
            self.windows[number] = around(axes, camera, self.reaches[number], self._texels)
            self._stale[number] = False
        return sorted(due)

    def _behind(self, number: int, window: Window, axes: np.ndarray, camera: np.ndarray) -> float:
        """How far a map is behind, in what it may be."""
        left = np.abs(window.axes @ camera - window.middle).max() / (MARGIN * self.reaches[number])
        turned = float(np.linalg.norm(axes[2] - window.axes[2])) / TURNED
        return max(float(left), min(turned, PATIENCE), 2.0 if self._stale[number] else 0.0)
