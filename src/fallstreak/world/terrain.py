"""The ground: where its heights come from and what it is made of."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, Self

from pydantic import PrivateAttr, model_validator

from . import queries
from .errors import WorldError
from .fields import Number, Section, Whole, choice, quantity

if TYPE_CHECKING:
    from .world import World


class Terrain(Section):
    """Heights by map coordinates (metres east and north of the anchor)."""

    source: Literal["none", "file", "fractal"] = choice(
        "none",
        doc="none: the bare sphere; file: a digital elevation model; fractal: made from noise and the seed.",
    )
    file: str = choice(
        "",
        max_length=4096,
        doc="For source file: a .npz or .tif beside the scene, or the name of a shipped model (jacksboro).",
    )
    material: Literal["temperate", "mars"] = choice(
        "temperate", doc="What grows and lies on the ground, by height and slope."
    )
    extent: Number = quantity(
        160e3, unit="m", ge=1e3, le=1e6, doc="How far from the anchor the ground is drawn as terrain."
    )
    surroundings: Literal["continue", "flat", "sea"] = choice(
        "continue",
        doc="What lies outside the file: continue invents hills like those inside, flat keeps the mean "
        "height of the edge, sea is height 0.",
    )
    vertical_exaggeration: Number = quantity(
        1.0, ge=0.0, le=20.0, doc="Heights of the file or fractal are multiplied by this."
    )
    base_height: Number = quantity(
        300.0, unit="m", ge=-11e3, le=30e3, doc="For source fractal: mean height of the ground."
    )
    relief: Number = quantity(
        800.0, unit="m", ge=0.0, le=20e3, doc="For source fractal: height from valleys to summits."
    )
    feature_size: Number = quantity(
        12e3, unit="m", ge=100.0, le=2e5, doc="For source fractal: distance from one mountain to the next."
    )
    roughness: Number = quantity(
        0.5, ge=0.0, le=1.0, doc="For source fractal: 0 rolling hills, 1 jagged at every scale."
    )
    octaves: Whole = quantity(12, ge=1, le=20, doc="For source fractal: how many scales of noise are added.")

    _world: World | None = PrivateAttr(default=None)

    @model_validator(mode="after")
    def _file_is_named(self) -> Self:
        if self.source == "file" and not self.file:
            raise ValueError('source is "file" but file is empty: name a .npz, a .tif or a shipped model')
        return self

    @property
    def path(self) -> Path | None:
        """The elevation file (absolute), or None where ``file`` is empty or names a shipped model."""
        return Path(self.file) if is_path(self.file) else None

    def height(self, east: Any, north: Any) -> Any:
        """Height of the ground above sea level.

        Parameters
        ----------
        east, north
            Metres from the anchor along the map: numbers or arrays that broadcast together.

        Returns
        -------
        float or numpy.ndarray
            Metres, float64, in the broadcast shape; a float for two numbers.
        """
        if self._world is None:
            raise WorldError("this terrain belongs to no world yet: ask world.terrain.height(…)")
        return queries.resolve("terrain.height")(self._world, east, north)


def is_path(name: str) -> bool:
    """Whether ``terrain.file`` is a path (it has a folder or a suffix) and not a shipped model's name."""
    return "/" in name or "\\" in name or "." in name
