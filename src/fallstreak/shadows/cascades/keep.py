"""Which maps of still things are drawn in a frame.

Where a map lies depends on camera and light alone, not on the way that led there: pictures after a lost GPU,
or of a sequence that goes on elsewhere, are the same.
"""

from __future__ import annotations

from math import radians

import numpy as np

from .window import MARGIN, Window, basis

TURNED = radians(0.02)
"""By which the light turns between two drawings: a texel of the finest map for a shadow 250 m long."""

STEP = 24.0
"""m by which a window moves at most: it is drawn with the plants that stand about its middle."""


def axes_near(key: np.ndarray, number: int) -> np.ndarray:
    """`basis` of a light next to `key`, on a lattice of `TURNED`; maps have their own and take turns."""
    phase = 0.137 + 0.25 * number
    near = (np.round(np.asarray(key, np.float64) / TURNED + phase) - phase) * TURNED
    return basis(near / np.linalg.norm(near))


def around(axes: np.ndarray, camera: np.ndarray, reach: float, texels: int) -> Window:
    """The window that holds `reach` metres about a camera; it moves by margins or `STEP`, in whole texels."""
    half = reach * (1.0 + MARGIN)
    texel = 2.0 * half / texels
    step = texel * np.floor(min(2.0 * MARGIN * reach, STEP) / texel)
    middle = np.round(axes @ camera / step) * step
    return Window(axes, middle, np.array([half, half, 1.2 * half + 100.0]))


class Keep:
    """Windows about the camera, and whether what they hold is still true.

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

    def change(self) -> None:
        """Something that throws shadows is no longer where it was, or nothing from before counts."""
        self.windows = [None] * len(self.reaches)

    def due(self, key: np.ndarray, camera: np.ndarray) -> list[int]:
        """Maps to draw in a frame; their windows are laid anew.

        Parameters
        ----------
        key : (3,)
            Towards the light, world axes.
        camera : (3,)
            World coordinates, m.
        """
        due = []
        for number, reach in enumerate(self.reaches):
            window = around(axes_near(key, number), camera, reach, self._texels)
            if window != self.windows[number]:
                self.windows[number] = window
                due.append(number)
        return due
