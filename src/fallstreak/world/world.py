"""The world: everything there is in a scene, as frozen data."""

from __future__ import annotations

import os
from collections.abc import Mapping
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Annotated, Any, Self

from pydantic import (
    AfterValidator,
    AwareDatetime,
    BeforeValidator,
    PrivateAttr,
    ValidationError,
    field_validator,
)

from .camera import Camera
from .clouds import Clouds
from .errors import WorldError
from .explain import Layer, explain
from .fields import Number, Section, Whole, choice, quantity, table
from .film import Film
from .models import Model, check_names
from .place import Place
from .planet import PRESETS, Planet
from .shadows import Shadows
from .sky import Sky
from .terrain import PRESETS as LANDS
from .terrain import Terrain, with_paths
from .trees import Tree, assign, files_in, merge, plain


def _moment(value: Any) -> Any:
    if isinstance(value, (str, datetime)):
        return value
    raise ValueError("it must be a date and time with its zone, such as 2025-10-18T18:28:00-04:00")


_FIRST_YEAR, _LAST_YEAR = 1700, 2200
_ALMANAC = f"the almanac of sun and moon holds for the years {_FIRST_YEAR} to {_LAST_YEAR}"


def _in_almanac(value: datetime) -> datetime:
    if not _FIRST_YEAR <= value.year <= _LAST_YEAR:
        raise ValueError(_ALMANAC)
    return value


Moment = Annotated[
    AwareDatetime,
    BeforeValidator(_moment, json_schema_input_type=AwareDatetime),
    AfterValidator(_in_almanac),
]


class World(Section):
    """What there is, where and when, by sections: ``world.sky.turbidity``, ``world.terrain.height(e, n)``.

    Raises `WorldError` with one sentence when a value is not allowed. Relative paths given here count from
    the current directory; those in a scene file from the file's folder.

    Examples
    --------
    >>> world = World(planet={"preset": "mars"}, camera={"height": 30, "pitch": 2})
    >>> world.planet.radius
    3389500.0
    """

    name: str = choice("untitled", max_length=200, doc="What the scene is called.")
    description: str = choice("", max_length=4000, doc="What is to be seen, in a sentence.")
    seed: Whole = quantity(0, ge=0, le=2**32 - 1, doc="Everything random follows from it.")
    time: Moment = choice(
        datetime(2025, 6, 21, 15, 0, tzinfo=UTC),
        doc="Date and time of the scene's start, with zone (ISO 8601).",
    )
    time_scale: Number = quantity(
        1.0, ge=-1e6, le=1e6, unit="s/s", doc="Seconds that pass in the scene per second of a sequence."
    )
    place: Place = table(Place, "Where on the planet the origin is.")
    planet: Planet = table(Planet, "The body under the scene and its presets.")
    sky: Sky = table(Sky, "Air, sun, moon and stars.")
    terrain: Terrain = table(Terrain, "The ground.")
    clouds: Clouds = table(Clouds, "Layers of clouds, and how they are drawn.")
    shadows: Shadows = table(Shadows, "Shadows of land and things.")
    camera: Camera = table(Camera, "Where the picture is taken from.")
    film: Film = table(Film, "Exposure and tone.")
    models: tuple[Model, ...] = choice((), max_length=256, doc="Things: glTF models that stand or move.")

    # What was given, before presets and defaults: the ground that changes are laid on.
    _given: Tree = PrivateAttr(default_factory=dict)
    _folder: Path | None = PrivateAttr(default=None)

    @field_validator("models")
    @classmethod
    def _names_differ(cls, models: tuple[Model, ...]) -> tuple[Model, ...]:
        check_names(models)
        return models

    def __init__(self, /, **given: Any) -> None:
        tree = plain(given)
        absolute(tree)
        self._fill(tree, None, None)

    def _fill(self, tree: Tree, folder: Path | None, layers: list[Layer] | None) -> None:
        try:
            super().__init__(**with_presets(tree))
        except ValidationError as error:
            raise explain(error, type(self), tree, layers) from None
        self._given = tree
        self._folder = folder
        self.terrain._world = self
        self.clouds._world = self

    @classmethod
    def from_layers(cls, layers: list[Layer], folder: Path | None) -> Self:
        """One world of several layers of values, the later over the earlier; see `load` for the usual way."""
        tree: Tree = {}
        for layer in layers:
            tree = merge(tree, layer.tree)
        world = cls.__new__(cls)
        world._fill(tree, folder, layers)
        return world

    @property
    def folder(self) -> Path | None:
        """The folder of the file the world came from; None for one made in Python."""
        return self._folder

    def time_at(self, seconds: float) -> datetime:
        """Date and time in the scene when a sequence has run for ``seconds``: ``time_scale`` counts.

        Raises
        ------
        WorldError
            When that is beyond the years for which the places of sun and moon are known.
        """
        try:
            return _in_almanac(self.time + timedelta(seconds=seconds * self.time_scale))
        except (OverflowError, ValueError):
            raise WorldError(
                f"{seconds:g} s of sequence at time_scale = {self.time_scale:g} lead from "
                f"{self.time.isoformat()} too far: {_ALMANAC}"
            ) from None

    def updated(self, changes: Mapping[str, Any]) -> World:
        """This world with changes: ``world.updated({"sky.turbidity": 4, "camera": {"fov": 30}})``.

        Keys are dotted; what was left to ``planet.preset`` follows a new preset.
        """
        change: Tree = {}
        for key, value in changes.items():
            assign(change, key, plain(value))
        absolute(change)
        layers = [Layer("the world", plain(self._given)), Layer("change", change)]
        return type(self).from_layers(layers, self._folder)

    def to_toml(self) -> str:
        """The world as a scene file: what differs from its preset's defaults. It loads to an equal world.

        An elevation file inside the world's folder is written relative to it. One elsewhere is written as an
        absolute path, which a scene file may not hold: move it beside the scene, or give it when loading by
        ``terrain.file=…``.
        """
        from .writing import to_toml

        return to_toml(self)


def with_presets(tree: Tree) -> Tree:
    """The tree over the defaults of its kind of land, over those of its planet."""
    land = _named(LANDS, tree.get("terrain"), "source")
    planet = _named(PRESETS, tree.get("planet"), "preset")
    defaults = merge({"terrain": plain(land)} if land else {}, plain(planet) if planet else {})
    return merge(defaults, tree) if defaults else tree


def _named(presets: Mapping[str, Any], section: Any, key: str) -> Any:
    name = section.get(key) if isinstance(section, dict) else None
    return presets.get(name) if isinstance(name, str) else None


def absolute(tree: Tree) -> None:
    """Resolve a path given in Python or on the command line against the current directory."""
    for named, key, _ in files_in(tree):
        named[key] = with_paths(
            named[key],
            lambda name: name if "\0" in name else os.path.abspath(os.path.expanduser(name)),
        )
