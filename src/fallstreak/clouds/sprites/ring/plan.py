"""When a ring is made anew, and how it takes the place of the one before: the CPU's part, once a frame."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from .parts import Step, at_once

ACROSS, UPWARD = 0.15, 0.02
"""Of the radius: so far from the ring's middle a new one is begun."""
LOST = 3.0
"""So many times these, and a ring shows clouds too far from where they are to be shown at all."""
SUN = np.radians(1.0)
"""So far the light may turn."""
FADE = 12
"""Frames in which a new ring comes in."""
AGE = 0.03
"""Of the clouds' lifetime, that a ring may be old."""
PAUSE = 24
"""Frames from one ring that was made at once to the next: who travels too fast for rings has none."""


@dataclass(frozen=True)
class Ring:
    """A ring: from where and when it is, and where its pictures are.

    Attributes
    ----------
    position : (3,) float64
        Its middle, world coordinates, m.
    place : (2,) float64
        The same on the map.
    height : float
        m above the sea.
    key : (3,) float64
        Towards the light.
    time : float
        s
    set : 0 or 1
        Pictures ``8 set`` to ``8 set + 7``.
    """

    position: np.ndarray
    place: np.ndarray
    height: float
    key: np.ndarray
    time: float
    set: int = 0


class Plan:
    """The ring in sight, the one that is being made, and what is to be drawn in a frame.

    Parameters
    ----------
    radius : float
        m
    winds : (n, 2) array
        Of the layers, m/s.
    lifetime : float
        Shortest of the layers', s; infinite where clouds do not age.
    steps : sequence of tuples of Part
        What is drawn of a ring in one frame, the next, ….

    Attributes
    ----------
    shown, next : Ring or None
    weight : float
        How much of `next` is to be seen, 0 to 1; the rest is `shown`.
    drawn : Ring or None
        Of which parts are drawn in this frame,
    parts : tuple of Part
        and which.
    """

    def __init__(self, radius: float, winds: np.ndarray, lifetime: float, steps: Sequence[Step]):
        self.radius, self.steps = radius, steps
        self._winds = np.asarray(winds, float).reshape(-1, 2)
        self._lifetime = lifetime
        self._pause = 0
        self._forget()

    def _forget(self) -> None:
        self.shown: Ring | None = None
        self.next: Ring | None = None
        self.drawn: Ring | None = None
        self.parts: Step = ()
        self.weight = 0.0
        self._done = 0

    def update(self, now: Ring, *, fresh: bool = False) -> None:
        """The next frame, with the camera, light and time of `now` (its `set` is of no account).

        Parameters
        ----------
        fresh : bool
            Whether it follows no other.
        """
        self._pause = 0 if fresh else max(self._pause - 1, 0)
        self.drawn, self.parts = None, ()
        if fresh or (self.shown is not None and self._gone(self.shown, now) > LOST):
            self._forget()
        if self.shown is None:
            if self._pause == 0:
                self._pause = PAUSE
                self.shown = self.drawn = replace(now, set=0)
                self.parts = at_once()
            return
        if self.next is None:
            if self._gone(self.shown, now) <= 1.0:
                return
            self.next = replace(now, set=1 - self.shown.set)
            self._done, self.weight = 0, 0.0
        if self._done < len(self.steps):
            self.drawn, self.parts = self.next, self.steps[self._done]
        else:
            self.weight = min((self._done - len(self.steps) + 1) / FADE, 1.0)
            if self.weight == 1.0:
                self.shown, self.next, self.weight = self.next, None, 0.0
                return
        self._done += 1

    def _gone(self, ring: Ring, now: Ring) -> float:
        """How far what a ring shows has changed: from 1 on it is to be made anew."""
        passed = now.time - ring.time
        if passed < 0.0:
            return np.inf
        # against the clouds, which drift
        across = now.place - ring.place - self._winds * passed
        turned = np.arccos(np.clip(ring.key @ now.key, -1.0, 1.0))
        return max(
            float(np.hypot(*across.T).max(initial=0.0)) / (ACROSS * self.radius),
            abs(now.height - ring.height) / (UPWARD * self.radius),
            float(turned) / SUN,
            passed / (AGE * self._lifetime),
        )
