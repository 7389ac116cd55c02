"""In what parts a ring is drawn: whole sides, sides by distance, or block by block; far ones first."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass
from math import asin, atan2, cos, hypot, inf, pi, sqrt

import numpy as np

from ..scope import BLOCK

SIDES = 8
SLICES = 4
"""In how many parts a side is drawn, by distance."""
WIDEST = 1.0
"""Blocks are taken together to squares as wide as they are far away, times that."""


@dataclass(frozen=True)
class Part:
    """What is drawn into one side at a time: clouds of the blocks between two distances and in a square.

    Attributes
    ----------
    side : int
        0 is north, 1 north-east.
    distances : (float, float)
        m, of the blocks' middles from the ring's, from the first up to the second.
    square : (float, float, float, float)
        m, west, south, east and north border, from the ring's middle.
    first : bool
        Whether it is the first of its side: the others are laid over those before them.
    """

    side: int
    distances: tuple[float, float] = (0.0, inf)
    square: tuple[float, float, float, float] = (-inf, -inf, inf, inf)
    first: bool = True


Step = tuple[Part, ...]
"""The parts that one frame draws."""


def at_once() -> Step:
    """All of a ring."""
    return tuple(Part(side) for side in range(SIDES))


def by_side(radius: float, farthest: float) -> list[Step]:
    """One side after the other, each in `SLICES` frames, the farthest blocks first.

    Parameters
    ----------
    radius, farthest : m, of the ring, and of clouds
    """
    # as many sprites in each: so their number grows with distance
    edges = np.linspace(radius**1.5, max(farthest, 1.5 * radius) ** 1.5, SLICES + 1) ** (1.0 / 1.5)
    edges[0], edges[-1] = 0.0, inf
    slices = [(float(a), float(b)) for a, b in itertools.pairwise(edges)][::-1]
    return [(Part(side, slices[k], first=k == 0),) for side in range(SIDES) for k in range(SLICES)]


def by_block(radius: float, farthest: float, widest_cloud: float) -> list[Step]:
    """One block after the other, a frame each, into the sides that it is on; what is behind first.

    Blocks that seem smaller than those at the radius are taken together: four, sixteen, as many as make a
    square no wider than `WIDEST` times its distance.

    Parameters
    ----------
    radius, farthest : m, as for `by_side`
    widest_cloud : m, radius of the widest cloud; it may reach into sides that its block is not on
    """
    begun: set[int] = set()
    steps = []
    for west, south, width in _squares(radius, farthest):
        square = (west, south, west + width, south + width)
        sides = _touched(west + 0.5 * width, south + 0.5 * width, width / sqrt(2.0) + widest_cloud)
        steps.append(tuple(Part(side, square=square, first=side not in begun) for side in sides))
        begun.update(sides)
    return steps


def _squares(radius: float, farthest: float) -> Iterator[tuple[float, float, float]]:
    """West and south border and width of squares of blocks about the middle, each before what it hides."""
    width = BLOCK
    while width < farthest:
        width *= 2.0
    for west, south in itertools.product((-width, 0.0), repeat=2):
        yield from _quartered(west, south, width, radius, farthest)


def _quartered(
    west: float, south: float, width: float, radius: float, farthest: float
) -> Iterator[tuple[float, float, float]]:
    # of a quadrant about the middle, which none of the squares lies across
    near = hypot(min(abs(west), abs(west + width)), min(abs(south), abs(south + width)))
    if near > farthest:
        return
    half = 0.5 * width
    if width == BLOCK:
        if hypot(west + half, south + half) > radius:
            yield west, south, width
    elif near >= radius and width <= WIDEST * near:
        yield west, south, width
    else:
        quarters = [(west + x, south + y) for x in (0.0, half) for y in (0.0, half)]
        # no ray from the middle meets both of those that are as far
        quarters.sort(key=lambda at: -(abs(at[0] + 0.5 * half) + abs(at[1] + 0.5 * half)))
        for x, y in quarters:
            yield from _quartered(x, y, half, radius, farthest)


def _touched(east: float, north: float, reach: float) -> list[int]:
    """Sides on which something may be seen that is as far as `reach` about a place."""
    distance = hypot(east, north)
    if reach >= distance:
        return list(range(SIDES))
    # a little more: pictures overlap at the seams
    half = asin(reach / distance) + 1.05 * pi / SIDES
    angle = atan2(east, north)
    return [side for side in range(SIDES) if cos(angle - 2.0 * pi * side / SIDES) >= cos(min(half, pi))]
