"""What grows where: the kinds that can be drawn, and which of them each country feeds, by its ground.

`FLORA` maps a terrain's material (its country) to species. A species stands in a cell of its kind's lattice
with the probability that its ground gives it: `growth` times the cover's growth, plus `soil[name]` times the
share of each base material there. Heights of trees after the usual yield tables, albedos of leaves after
field spectra: conifers .03-.06, broad-leaved trees .04-.10, sage and heath .08-.14.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from . import cards, shapes
from .mesh import Mesh

Colour = tuple[float, float, float]


@dataclass(frozen=True)
class Kind:
    """A thing that is drawn: its meshes and its lattice.

    Attributes
    ----------
    mesh : level of detail (0, 1; 2 where there are no impostors) -> Mesh
    leaf : layer of the cards
    cell : m, width of a cell of the lattice
    reach : share of the trees' radius within which it is drawn
    tile : (width, height) of the impostor's pictures in texels; None: it has none
    leans : how much its stem follows the slope: 0 upright, 1 square to the ground
    """

    name: str
    mesh: Callable[[int], Mesh]
    leaf: int
    cell: float
    reach: float
    tile: tuple[int, int] | None
    leans: float = 0.0


KINDS = (
    Kind("conifer", shapes.conifer, cards.FROND, 5.5, 1.0, (64, 128)),
    Kind("broadleaf", shapes.broadleaf, cards.LEAVES, 7.0, 1.0, (112, 128)),
    Kind("juniper", shapes.juniper, cards.FROND, 7.0, 1.0, (112, 96)),
    Kind("shrub", shapes.shrub, cards.SPRAY, 3.0, 0.45, (96, 64), 0.4),
    Kind("rock", shapes.rock, cards.BARK, 4.0, 0.55, None, 0.8),
)


@dataclass(frozen=True)
class Species:
    """How a kind lives in a country.

    Attributes
    ----------
    heights : (lowest, highest), m
    rarity : exponent of the heights' distribution: 1 all alike, 4 few large ones
    tints : albedo of leaves or stone, from one to the other by chance
    of_ground : how much the colour is the ground's own
    growth, soil : density per growth and per share of base materials
    slope : rise over run on which nothing holds any more
    """

    heights: tuple[float, float]
    tints: tuple[Colour, Colour]
    growth: float = 0.0
    soil: dict[str, float] = field(default_factory=dict)
    rarity: float = 1.0
    of_ground: float = 0.0
    slope: float = 1.4


_SPRUCE = ((0.017, 0.031, 0.012), (0.031, 0.048, 0.018))
_STONES = {"scree": 0.5, "granite": 0.20, "limestone": 0.16, "sandstone": 0.14, "gravel": 0.12, "turf": 0.02,
           "basalt": 0.25}  # fmt: skip


def _rocks(soil: dict[str, float], heights: tuple[float, float] = (0.12, 2.2)) -> Species:
    grey = ((0.16, 0.15, 0.135), (0.22, 0.21, 0.19))
    return Species(heights, grey, soil=soil, rarity=4.0, of_ground=0.7, slope=1.1)


FLORA: dict[str, dict[str, Species]] = {
    "temperate": {
        "conifer": Species((7.0, 20.0), _SPRUCE, growth=0.10),
        # October: what has turned, and what is still green
        "broadleaf": Species((8.0, 19.0), ((0.044, 0.062, 0.018), (0.112, 0.068, 0.017)), growth=0.95,
                             of_ground=0.5),
        "shrub": Species((0.5, 2.0), ((0.045, 0.052, 0.020), (0.085, 0.070, 0.028)), growth=0.10,
                         soil={"forest_floor": 0.06, "shrubs": 0.6, "grass": 0.003}, rarity=1.5),
        "rock": _rocks(_STONES | {"forest_floor": 0.01}, (0.12, 1.6)),
    },
    "alpine": {
        "conifer": Species((5.0, 24.0), _SPRUCE, growth=1.0, of_ground=0.35, slope=1.3),
        "shrub": Species((0.3, 1.1), ((0.034, 0.044, 0.018), (0.060, 0.060, 0.024)), growth=0.05,
                         soil={"shrubs": 0.7, "turf": 0.05, "forest_floor": 0.04}, rarity=1.5),
        "rock": _rocks(_STONES, (0.15, 3.2)),
    },
    "coast": {
        # evergreen oaks, pines, maquis
        "conifer": Species((4.0, 14.0), _SPRUCE, growth=0.15, of_ground=0.3, slope=1.1),
        "broadleaf": Species((4.0, 10.0), ((0.034, 0.046, 0.020), (0.052, 0.060, 0.026)), growth=0.65,
                             of_ground=0.3, slope=1.1),
        "juniper": Species((1.2, 3.5), ((0.032, 0.042, 0.018), (0.060, 0.064, 0.030)), growth=0.4, slope=1.2),
        "shrub": Species((0.4, 1.6), ((0.045, 0.052, 0.020), (0.080, 0.075, 0.032)), growth=0.05,
                         soil={"shrubs": 0.6, "grass": 0.03}, rarity=1.5),
        "rock": _rocks(_STONES),
    },
    "canyon": {
        # junipers, and sage
        "juniper": Species((1.5, 5.0), ((0.030, 0.040, 0.018), (0.048, 0.056, 0.026)), growth=0.35,
                           slope=0.8),
        "shrub": Species((0.3, 1.1), ((0.085, 0.085, 0.055), (0.120, 0.110, 0.070)), growth=0.40,
                         soil={"shrubs": 0.6, "soil": 0.06, "sand": 0.05, "gravel": 0.05},
                         rarity=1.5, slope=0.9),
        "rock": _rocks(_STONES, (0.12, 3.0)),
    },
    "dunes": {
        "shrub": Species((0.3, 1.0), ((0.130, 0.115, 0.060), (0.200, 0.165, 0.085)), growth=0.4,
                         soil={"shrubs": 0.5, "grass": 0.08}, rarity=1.5, slope=0.5),
    },
    "mars": {"rock": _rocks(_STONES | {"dust": 0.02, "sand": 0.02, "mud": 0.05}, (0.10, 1.4))},
}  # fmt: skip
"""Country -> kind -> species; a country that is not here is bare."""


def affinity(species: Species, palette: tuple[str, ...]) -> list[float]:
    """Density per share of each of a palette's six materials."""
    return [species.soil.get(name, 0.0) for name in palette]
