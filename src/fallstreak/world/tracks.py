"""One number that changes in time: a cubic Hermite curve through given points."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable, Sequence
from itertools import pairwise
from typing import Any, Literal

Kind = Literal["through", "monotone", "turn"]


class Track:
    """A smooth function through (time, value) points; constant before the first and after the last.

    Parameters
    ----------
    points
        Pairs in strictly rising order of time.
    kind
        "through": Catmull-Rom for uneven times (tangent = slope between the neighbours). "monotone":
        Fritsch-Butland tangents, never beyond the values it joins. "turn": monotone, for an angle in degrees
        that goes the shorter way from point to point; answers lie in 0..360.
    """

    def __init__(self, points: Sequence[tuple[float, float]], kind: Kind) -> None:
        self.kind = kind
        self.times = [float(t) for t, _ in points]
        self.values = [float(v) for _, v in points]
        if kind == "turn":
            for i in range(1, len(self.values)):
                step = (self.values[i] - self.values[i - 1] + 180.0) % 360.0 - 180.0
                self.values[i] = self.values[i - 1] + step
        self.slopes = self._tangents()

    def _tangents(self) -> list[float]:
        t, v = self.times, self.values
        steps = [(v[i + 1] - v[i]) / (t[i + 1] - t[i]) for i in range(len(t) - 1)]
        # The camera starts from rest and comes to rest, since before and after it does not move.
        slopes = [0.0] * len(t)
        for i in range(1, len(t) - 1):
            if self.kind == "through":
                slopes[i] = (v[i + 1] - v[i - 1]) / (t[i + 1] - t[i - 1])
            elif steps[i - 1] * steps[i] > 0.0:
                before, after = t[i] - t[i - 1], t[i + 1] - t[i]
                weight = before + 2.0 * after, 2.0 * before + after
                slopes[i] = sum(weight) / (weight[0] / steps[i - 1] + weight[1] / steps[i])
        return slopes

    def __call__(self, seconds: float) -> float:
        """The value at a time."""
        t, v, m = self.times, self.values, self.slopes
        i = bisect_right(t, seconds) - 1
        if i < 0:
            value = v[0]
        elif i >= len(t) - 1:
            value = v[-1]
        else:
            span = t[i + 1] - t[i]
            s = (seconds - t[i]) / span
            r = 1.0 - s
            bend = span * s * r * (m[i] * r - m[i + 1] * s)
            value = v[i] + (v[i + 1] - v[i]) * s * s * (3.0 - 2.0 * s) + bend
        return value % 360.0 if self.kind == "turn" else value


def tracks_of(keyframes: Sequence[Any], channels: Iterable[str]) -> dict[str, Track]:
    """The tracks of what keyframes state: east and north "through" them, heading by "turn", else "monotone".

    Raises
    ------
    ValueError
        When the keyframes are not in order of time.
    """
    for before, after in pairwise(keyframes):
        if after.at <= before.at:
            raise ValueError(
                f"keyframes must be in order of time, but at = {after.at:g} follows at = {before.at:g}"
            )
    found: dict[str, Track] = {}
    for name in channels:
        stated = [(k.at, getattr(k, name)) for k in keyframes if getattr(k, name) is not None]
        if stated:
            kind = "turn" if name == "heading" else "through" if name in ("east", "north") else "monotone"
            found[name] = Track(stated, kind)
    return found
