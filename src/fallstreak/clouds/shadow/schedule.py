"""Which of the shadow maps are drawn in a frame; where those lie that were drawn before."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

MAPS = 4
"""Three about the camera as the light sees them, one straight down."""

LONGEST = 2.0
"""s, simulated, after which a map is drawn in any case: clouds grow and winds differ."""
FARTHEST = 0.03
"""Of a map's half size, by which the camera may leave its middle: half of what lies beyond its border."""
TURN = 0.002
"""rad, by which the light may turn: 10 m for shadows that are thrown 5 km far."""
ENOUGH = 0.05
"""Texels by which a map may be behind: what drifts with the clouds anyway looks the same."""
CHANGE = 3.0
"""m/s, with which clouds change shape: what makes a map old under a camera that stands still."""


@dataclass(frozen=True)
class _Drawn:
    """How a map was drawn: place (middle, half sizes) as seen from that camera, basis, time."""

    place: np.ndarray
    camera: np.ndarray
    basis: np.ndarray
    time: float


class Schedule:
    """At most one map a frame, the one that is most texels behind, if that can be seen; all that must not
    wait; all in a first frame.

    A map that is not drawn drifts with the clouds: its shadows go on moving, and when it is drawn again
    nothing jumps.

    Parameters
    ----------
    wind : (2,)
        m/s, of the layer that counts most.

    Attributes
    ----------
    due : set of int
        The maps to draw in the frame of the last `lay`.
    """

    def __init__(self, wind: np.ndarray):
        self._wind = wind
        self._drawn: list[_Drawn | None] = [None] * MAPS
        self.due: set[int] = set(range(MAPS))

    def lay(
        self, values: Mapping[str, Any], camera: np.ndarray, time: float, texels: int, *, fresh: bool
    ) -> list[tuple[float, ...]]:
        """Choose `due` for a frame.

        Parameters
        ----------
        values : mapping
            From `model.shadow_values`: where maps that are drawn now lie.
        camera : (2,)
            On the map, m.
        time : float
            Simulated, s.
        texels : int
            Along a side of a map.
        fresh : bool
            Whether nothing that was drawn before counts.

        Returns
        -------
        list of 4 tuples
            The uniform's ``maps``.
        """
        basis = np.stack([values["across"], values["along"], values["key"]])
        places = [np.array(place) for place in values["maps"]]
        old = [np.inf] * MAPS
        for number, drawn in enumerate(self._drawn):
            if drawn is not None and not fresh:
                old[number] = self._behind(number, drawn, basis, camera, time, texels)
        self.due = {number for number in range(MAPS) if np.isinf(old[number])}
        waits = [number for number in range(MAPS) if self._waits(number, old[number], time)]
        if waits:
            self.due.add(max(waits, key=lambda number: old[number]))
        for number, drawn in enumerate(self._drawn):
            if number in self.due or drawn is None:
                self._drawn[number] = _Drawn(places[number], camera, basis, time)
            else:
                moved = drawn.camera - camera + self._wind * (time - drawn.time)
                axes = np.eye(2) if number == MAPS - 1 else basis[:2, :2]
                places[number] = np.concatenate([drawn.place[:2] + axes @ moved, drawn.place[2:]])
        return [tuple(place.tolist()) for place in places]

    def _waits(self, number: int, behind: float, time: float) -> bool:
        """Whether it is worth while to draw a map; before all have to be, in one frame."""
        drawn = self._drawn[number]
        return drawn is None or behind > ENOUGH or abs(time - drawn.time) > 0.5 * LONGEST

    def _behind(
        self, number: int, drawn: _Drawn, basis: np.ndarray, camera: np.ndarray, time: float, texels: int
    ) -> float:
        """Texels that a map is behind; infinite where it must be drawn."""
        reach, passed = float(drawn.place[2]), abs(time - drawn.time)
        drift = float(np.hypot(*(camera - drawn.camera - self._wind * (time - drawn.time))))
        turned = float(np.abs(basis - drawn.basis).max()) if number < MAPS - 1 else 0.0
        if passed > LONGEST or drift > FARTHEST * reach or turned > TURN:
            return np.inf
        return (drift + CHANGE * passed + turned * reach) * texels / (2.0 * reach)
