"""When a ring is made anew, and how it takes the place of the one before: the CPU's part, once a frame."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from math import ceil

import numpy as np

SIDES = 8
ACROSS, UPWARD = 0.15, 0.02
"""Of the radius: so far from the ring's middle a new one is begun."""
SUN = np.cos(np.radians(1.0))
"""So far the light may turn."""
FADE = 12
"""Frames in which a new ring comes in."""
CUT = 0.5
"""Of the radius: who has gone so far in a frame has been put there."""
AGE = 0.03
"""Of the clouds' lifetime, that a ring may be old."""


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
    set: int


class Plan:
    """The ring in sight, the one that is being made, and what is to be done in a frame.

    Parameters
    ----------
    radius : float
        m
    winds : (n, 2) array
        Of the layers, m/s.
    lifetime : float
        Shortest of the layers', s; infinite where clouds do not age.
    steps : int
        In how many parts a side is drawn, one a frame.

    Attributes
    ----------
    shown, next : Ring or None
    weight : float
        How much of `next` is to be seen, 0 to 1; the rest is `shown`.
    side, step : int or None
        What of `next` is drawn in this frame.
    """

    def __init__(self, radius: float, winds: np.ndarray, lifetime: float, steps: int = 1):
        self.radius, self.steps = radius, steps
        self._winds = np.asarray(winds, float).reshape(-1, 2)
        self._lifetime = lifetime
        self._before: Ring | None = None
        self._forget()

    def _forget(self) -> None:
        self.shown: Ring | None = None
        self.next: Ring | None = None
        self.weight = 0.0
        self.side: int | None = None
        self.step: int | None = None
        self._done = 0

    def update(self, now: Ring) -> None:
        """The next frame, with the camera, light and time of `now` (its `set` is of no account)."""
        before, self._before = self._before, now
        if before is not None and self._is_cut(before, now):
            self._forget()
        total = SIDES * self.steps
        if self.next is None:
            self.side = self.step = None
            if self.shown is not None and not self._is_old(self.shown, now):
                return
            free = 0 if self.shown is None else 1 - self.shown.set
            self.next = Ring(now.position, now.place, now.height, now.key, now.time, free)
            self._done, self.weight = 0, 0.0
        if self._done < total:
            self.side, self.step = divmod(self._done, self.steps)
        else:
            self.side = self.step = None
            # the first one comes at once
            frames = FADE if self.shown is not None else 1
            self.weight = min((self._done - total + 1) / frames, 1.0)
            if self.weight == 1.0:
                self.shown, self.next, self.weight = self.next, None, 0.0
                return
        self._done += 1

    def _is_cut(self, before: Ring, now: Ring) -> bool:
        gone = np.linalg.norm(now.position - before.position)
        return bool(gone > CUT * self.radius or now.time < before.time or now.time - before.time > 60.0)

    def _is_old(self, ring: Ring, now: Ring) -> bool:
        # against the clouds, which drift
        gone = now.place - ring.place - self._winds * (now.time - ring.time)
        across = float(np.hypot(*gone.T).max(initial=0.0))
        return bool(
            across > ACROSS * self.radius
            or abs(now.height - ring.height) > UPWARD * self.radius
            or ring.key @ now.key < SUN
            or now.time - ring.time > AGE * self._lifetime
        )


def slices(radius: float, farthest: float, steps: int) -> list[tuple[float, float]]:
    """Distances of the blocks in each part of a side, the farthest part first: equal factors, m."""
    if steps == 1:
        return [(0.0, 1e9)]
    edges = np.geomspace(radius, max(farthest, 1.5 * radius), ceil(steps) + 1)
    edges[0], edges[-1] = 0.0, 1e9
    return [(float(a), float(b)) for a, b in itertools.pairwise(edges)][::-1]
