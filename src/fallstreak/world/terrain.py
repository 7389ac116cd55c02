"""The ground: where its heights come from and what it is made of."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

from pydantic import PlainValidator, PrivateAttr, model_validator

from . import queries
from .errors import WorldError
from .fields import Number, Section, Whole, choice, quantity
from .files import all_files, changed, sidecars

if TYPE_CHECKING:
    from .world import World


_LONGEST, _MOST_ENTRIES = 4096, 256


def _names(value: Any) -> str | tuple[str, ...]:
    entries = tuple(value) if isinstance(value, (list, tuple)) else (value,)
    if not all(isinstance(entry, str) and len(entry) <= _LONGEST for entry in entries):
        raise ValueError(f"it must be a path or a list of paths, each of at most {_LONGEST} characters")
    if isinstance(value, str):
        return value
    if not 1 <= len(entries) <= _MOST_ENTRIES or "" in entries:
        raise ValueError(f"a list must name 1 to {_MOST_ENTRIES} files, none of them by an empty name")
    return entries


Files = Annotated[str | tuple[str, ...], PlainValidator(_names, json_schema_input_type=str | list[str])]
"""One path or several."""


class Terrain(Section):
    """Heights by map coordinates (metres east and north of the anchor)."""

    source: Literal["none", "file", "fractal", "canyons", "alpine", "plains", "dunes"] = choice(
        "none",
        doc="none: the bare sphere; file: a digital elevation model. Made from noise and the seed: fractal "
        "(ranges and plains, on Mars craters), canyons (plateaus cut by gorges), alpine (eroded mountains), "
        "plains, dunes.",
    )
    file: Files = choice(
        "",
        doc="For source file: elevations beside the scene (.npz, .tif, .hgt, .png, tiles z/x/y.png), a "
        "folder of them, a pattern (dem/*.hgt) or a shipped model's name (jacksboro); several are joined.",
    )
    material: Literal["temperate", "mars", "canyon", "alpine", "coast", "dunes"] = choice(
        "temperate",
        doc="What grows and lies on the ground, by height and slope (default: what suits the source).",
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
        300.0, unit="m", ge=-11e3, le=30e3, doc="For land made from noise: mean height of the ground."
    )
    relief: Number = quantity(
        800.0,
        unit="m",
        ge=0.0,
        le=20e3,
        doc="For land made from noise: height from valleys to summits, from river to rim.",
    )
    feature_size: Number = quantity(
        12e3,
        unit="m",
        ge=100.0,
        le=2e5,
        doc="For land made from noise: distance from one mountain or gorge to the next.",
    )
    roughness: Number = quantity(
        0.5, ge=0.0, le=1.0, doc="For land made from noise: 0 rolling hills, 1 jagged at every scale."
    )
    octaves: Whole = quantity(12, ge=1, le=20, doc="For source fractal: how many scales of noise are added.")
    water_level: Number | None = quantity(
        None,
        unit="m",
        ge=-11e3,
        le=30e3,
        doc="Height of the sea and of lakes: ground below it lies under water (none: no water but rivers).",
    )
    vegetation: Number = quantity(
        1.0, ge=0.0, le=1.0, doc="How densely trees, shrubs and stones stand where the ground feeds them."
    )
    wind: Number = quantity(
        3.0, unit="m/s", ge=0.0, le=40.0, doc="Wind from the west-southwest that sways trees and shrubs."
    )
    _world: World | None = PrivateAttr(default=None)
    _found: tuple[tuple[Path, ...], ...] | None = PrivateAttr(default=None)
    _stamps: tuple[int, ...] | None = PrivateAttr(default=None)

    @model_validator(mode="after")
    def _file_is_named(self) -> Self:
        if self.source == "file" and not self.file:
            raise ValueError('source is "file" but file is empty: name elevations or a shipped model')
        return self

    @property
    def names(self) -> tuple[str, ...]:
        """What ``file`` holds: absolute paths, folders and patterns, and shipped models' names."""
        return (self.file,) if isinstance(self.file, str) else self.file

    @property
    def path(self) -> Path | None:
        """The elevation file (absolute); None where ``file`` is empty, a shipped model's name or a list."""
        return Path(self.file) if isinstance(self.file, str) and is_path(self.file) else None

    @property
    def found(self) -> tuple[tuple[Path, ...], ...]:
        """For each of the names its files, folders and patterns searched (none for a shipped model's name).

        Searched once: a world is a value, and the ground below a camera is asked for in every frame.

        Raises
        ------
        WorldError
            For a folder or a pattern without elevation files, and for too many files.
        """
        if self._found is None:
            self._found = all_files(tuple(name if is_path(name) else None for name in self.names))
        return self._found

    @property
    def paths(self) -> tuple[Path, ...]:
        """All elevation files, see `found`."""
        return tuple(path for files in self.found for path in files)

    @property
    def stamps(self) -> tuple[int, ...]:
        """When each of the files and what belongs to it was last changed, ns, as this world found them."""
        if self._stamps is None:
            self._stamps = tuple(changed(file) for path in self.paths for file in (path, *sidecars(path)))
        return self._stamps

    @property
    def has_water(self) -> bool:
        """Whether water may stand on this ground: sea, lakes or rivers."""
        if self.source == "none":
            return False
        island = self.source == "file" and self.surroundings == "sea"
        return island or self.source == "canyons" or self.water_level is not None

    def height(self, east: Any, north: Any) -> Any:
        """Height above sea level of what one stands or floats on: the highest ground, or water over it.

        Parameters
        ----------
        east, north
            Metres from the anchor along the map: numbers or arrays that broadcast together.

        Returns
        -------
        float or numpy.ndarray
            Metres, float64, in the broadcast shape; a float for two numbers.
        """
        return self._ask("height", east, north)

    def normal(self, east: Any, north: Any) -> Any:
        """Unit normals of ground or water, over about a metre.

        Parameters
        ----------
        east, north
            As for `height`.

        Returns
        -------
        numpy.ndarray
            (..., 3) float64 in world axes (east, north and up at the anchor).
        """
        return self._ask("normal", east, north)

    def slope(self, east: Any, north: Any) -> Any:
        """How steep ground or water is over about a metre: rise over run, as `height` returns it."""
        return self._ask("slope", east, north)

    def materials(self, east: Any, north: Any) -> dict[str, Any]:
        """What the ground is made of.

        Parameters
        ----------
        east, north
            As for `height`.

        Returns
        -------
        dict of numpy.ndarray
            For each of the country's base materials ("grass", "scree", …) its share, 0 to 1; they sum to 1.
        """
        return self._ask("materials", east, north)

    def ray(self, origin: Any, direction: Any, max_distance: float = math.inf) -> Any:
        """Where rays meet ground, water or the globe beyond: things and plants do not stop them.

        Parameters
        ----------
        origin, direction
            (3,) or (n, 3): world coordinates (east, north, up of the anchor) in metres, and any length.
        max_distance
            Metres; what lies farther does not count.

        Returns
        -------
        Hits
            ``distance`` (n,), ``position`` (n, 3), ``normal`` (n, 3), float64; inf and nan where none is met.
        """
        return self._ask("ray", origin, direction, max_distance)

    def _ask(self, question: str, *values: Any) -> Any:
        if self._world is None:
            raise WorldError(f"this terrain belongs to no world yet: ask world.terrain.{question}(…)")
        return queries.resolve(f"terrain.{question}")(self._world, *values)


def is_path(name: str) -> bool:
    """Whether ``terrain.file`` is a path (it has a folder or a suffix) and not a shipped model's name."""
    return "/" in name or "\\" in name or "." in name


def with_paths(file: Any, change: Callable[[str], str]) -> Any:
    """``terrain.file`` as it was given, each path in it changed; what is no path or no text stays."""
    if isinstance(file, str):
        return change(file) if is_path(file) else file
    if isinstance(file, (list, tuple)):
        return [with_paths(name, change) if isinstance(name, str) else name for name in file]
    return file


PRESETS: dict[str, dict[str, Any]] = {
    "canyons": {"material": "canyon", "base_height": 1600.0, "relief": 350.0, "feature_size": 3e3},
    "alpine": {"material": "alpine", "base_height": 1900.0, "relief": 2600.0, "feature_size": 16e3},
    "plains": {"material": "temperate", "base_height": 200.0, "relief": 90.0, "feature_size": 5e3},
    "dunes": {"material": "dunes", "base_height": 300.0, "relief": 110.0, "feature_size": 1100.0},
}
"""For each ``terrain.source``, the defaults of the section that differ from the rest."""
