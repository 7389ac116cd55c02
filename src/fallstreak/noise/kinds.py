"""The kinds of noise and of fractal sums, as plain data, which API, command line and docs read."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Kind:
    """One kind of noise.

    `low` and `high` bound nearly all values of one octave; a gradient kind may leave them by a little.
    """

    name: str
    dimensions: tuple[int, ...]
    low: float
    high: float
    gradient: bool  # has analytic derivatives
    periodic: tuple[int, ...]  # the dimensions in which it can be made to repeat
    about: str


@dataclass(frozen=True)
class Fractal:
    """One way to add octaves up; `low` and `high` for a kind of −1…1."""

    name: str
    low: float
    high: float
    about: str


def _table(*rows):
    return {row.name: row for row in rows}


KINDS: dict[str, Kind] = _table(
    Kind("perlin", (2, 3, 4), -1.0, 1.0, True, (2, 3, 4), "gradients from a hash of the lattice: take this"),
    Kind("simplex", (2, 3, 4), -1.0, 1.0, True, (2, 3), "gradients on simplices: the same in all directions"),
    Kind("value", (2, 3), -1.0, 1.0, False, (2, 3), "a random number at every lattice point: cheap, blotchy"),
    Kind("cellular_f1", (2, 3), 0.0, 1.0, False, (2, 3), "distance to the nearest scattered point: cells"),
    Kind("cellular_f2", (2, 3), 0.0, 1.5, False, (2, 3), "distance to the second nearest: facets"),
    Kind("cellular_f2f1", (2, 3), 0.0, 1.0, False, (2, 3), "their difference: 0 on the walls between cells"),
    Kind("improved", (2, 3), -1.0, 1.0, False, (2, 3), "Ken Perlin's of 2002, bit for bit his permutation"),
    Kind("table", (2, 3), -0.7, 0.7, False, (2, 3), "the Infinity journal's: values for gradients"),
)

FRACTALS: dict[str, Fractal] = _table(
    Fractal("fbm", -1.0, 1.0, "octaves added up: clouds, relief"),
    Fractal("ridged", 0.0, 1.0, "sharp ridges that carry more detail than the valleys: mountains"),
    Fractal("billow", -1.0, 1.0, "rounded heaps with sharp creases between: cumulus, boulders"),
    Fractal("turbulence", 0.0, 1.0, "absolute values added up: marble, flames"),
    Fractal("hybrid", 0.0, 1.5, "smooth where low, rough where high: eroded land"),
)
