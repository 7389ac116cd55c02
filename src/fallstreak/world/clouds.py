"""Clouds: layers of one field, and how they are drawn."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

from pydantic import Field, PrivateAttr, model_validator

from . import queries
from .errors import WorldError
from .fields import Flag, Number, Section, Whole, choice, quantity, table
from .terrain import is_path

if TYPE_CHECKING:
    from .world import World

Genus = Literal[
    "cumulus_humilis",
    "cumulus_mediocris",
    "cumulus_congestus",
    "cumulonimbus",
    "stratocumulus",
    "stratus",
    "nimbostratus",
    "altocumulus",
    "altostratus",
    "cirrus",
    "cirrocumulus",
    "cirrostratus",
]
"""The kinds of clouds, by the names of the International Cloud Atlas."""

ModelName = Annotated[str, Field(min_length=1, max_length=4096)]


class CloudLayer(Section):
    """One layer of the field. What is left out is what clouds of its genus usually have."""

    genus: Genus = choice(
        "cumulus_mediocris",
        doc="Kind of clouds: sets their shapes, and what is usual of base, thickness and extinction.",
    )
    coverage: Number = quantity(0.4, ge=0.0, le=1.0, doc="Part of the sky that they cover, seen from above.")
    oktas: Number | None = quantity(
        None, ge=0.0, le=8.0, doc="The same in eighths, as weather reports have it; counts before coverage."
    )
    coverage_map: str = choice(
        "",
        max_length=4096,
        doc="A grey PNG or an .npz beside the scene: coverage by place, multiplied by coverage.",
    )
    coverage_extent: Number = quantity(
        1e5, unit="m", ge=100.0, le=2e7, doc="Width of a map that does not say itself where it lies."
    )
    base: Number | None = quantity(None, unit="m", ge=0.0, le=3e4, doc="Height of the bases above the sea.")
    thickness: Number | None = quantity(
        None, unit="m", ge=20.0, le=2e4, doc="From the base to the top of a cloud of ordinary size."
    )
    extinction: Number | None = quantity(
        None, unit="1/m", ge=1e-6, le=1.0, doc="Extinction coefficient in the middle of a cloud."
    )
    size: Number = quantity(
        1.0, ge=0.1, le=10.0, doc="Horizontal size of clouds and of the gaps between them, 1 = usual."
    )
    wind_speed: Number | None = quantity(None, unit="m/s", ge=0.0, le=150.0, doc="How fast the layer drifts.")
    wind_from: Number = quantity(
        250.0, unit="deg", ge=-360.0, le=360.0, doc="Where its wind comes from, clockwise from north."
    )
    lifetime: Number | None = quantity(
        None,
        unit="s",
        ge=0.0,
        le=1e7,
        doc="From forming to dissolving, of one cloud; 0: clouds neither form nor dissolve.",
    )
    clustering: Number | None = quantity(
        None, ge=0.0, le=1.0, doc="How much coverage differs between regions of some ten clouds' width."
    )
    seed: Whole = quantity(0, ge=0, le=2**32 - 1, doc="Of this layer's clouds, beside the world's.")
    models: tuple[ModelName, ...] = choice(
        (),
        max_length=16,
        doc="Cloud models beside the scene (.toml) or names of shipped ones, of which the clouds are copies.",
    )

    @property
    def cover(self) -> float:
        """Coverage, 0 to 1, whichever way it was given."""
        return self.coverage if self.oktas is None else self.oktas / 8.0

    @property
    def paths(self) -> tuple[tuple[str, Path], ...]:
        """(key, file) of all files of the layer, absolute."""
        named = [("coverage_map", self.coverage_map)] if self.coverage_map else []
        named += [("models", name) for name in self.models if is_path(name)]
        return tuple((key, Path(name)) for key, name in named)


class Sprites(Section):
    """Clouds of sprites, far ones drawn into a ring of pictures around the camera (technique sprites)."""

    ring: Flag = choice(True, doc="Whether far clouds are drawn into the ring and not one by one.")
    ring_radius: Number = quantity(
        6500.0, unit="m", ge=1e3, le=1e5, doc="Clouds beyond this distance are in the ring."
    )
    ring_update: Literal["side", "block"] = choice(
        "side",
        doc="How a new ring is drawn: side by side, a quarter in each frame, or one block of 16 km² a frame.",
    )
    density: Number = quantity(1.0, ge=0.1, le=4.0, doc="Number of sprites in a cloud, 1 = its model's.")


class Puffs(Section):
    """Clouds of puffs in seven sizes from 1 m to 1,000 km (technique puffs)."""

    density: Number = quantity(
        1.0, ge=0.3, le=2.0, doc="Puffs along a side of a bucket, 1 = as the quality has it."
    )


class Spheres(Section):
    """Clouds of spheres with a definite surface (technique spheres)."""

    ragged: Number = quantity(1.0, ge=0.0, le=3.0, doc="Strength of the turbulence that frays their edges.")
    cotton: Number = quantity(1.0, ge=0.0, le=3.0, doc="Strength of the turbulence of their surface.")


class Clouds(Section):
    """The clouds: what there is (layers), and which technique draws it."""

    technique: Literal["sprites", "puffs", "spheres"] = choice(
        "sprites",
        doc="sprites (with a ring of impostors), puffs (in seven sizes, also from space), spheres (with a "
        "surface): the same clouds at the same places.",
    )
    visibility: Number = quantity(
        160e3, unit="m", ge=1e3, le=2e6, doc="How far from the camera clouds are drawn."
    )
    shadows: Flag = choice(True, doc="Whether clouds throw shadows on the ground and on each other.")
    colours: Literal["physical", "artist"] = choice(
        "physical",
        doc="physical: lit by sun, moon, sky and ground. artist: in the colours that the cloud models name "
        "for times of the day (technique sprites alone).",
    )
    sprites: Sprites = table(Sprites, "For technique sprites.")
    puffs: Puffs = table(Puffs, "For technique puffs.")
    spheres: Spheres = table(Spheres, "For technique spheres.")
    layers: tuple[CloudLayer, ...] = choice((), max_length=8, doc="One to eight layers; none: no clouds.")

    _world: World | None = PrivateAttr(default=None)

    @model_validator(mode="after")
    def _artists_painted_sprites(self) -> Self:
        if self.colours == "artist" and self.technique != "sprites":
            raise ValueError(
                f'colours is "artist", and only technique sprites has them, not {self.technique}'
            )
        return self

    def extinction(self, points: Any, time: Any = 0.0) -> Any:
        """Extinction coefficient of all clouds at places.

        Parameters
        ----------
        points : array-like (..., 3)
            Metres: east and north of the anchor along the map, height above the sea.
        time : float or datetime
            Seconds of scene time since ``world.time``, or a moment with zone.

        Returns
        -------
        numpy.ndarray
            (...) float64, 1/m; 0 outside of clouds.
        """
        return self._ask("extinction", points, time)

    def optical_depth(self, a: Any, b: Any, time: Any = 0.0) -> Any:
        """Optical depth of all clouds along straight lines from places to places.

        Parameters
        ----------
        a, b : array-like (..., 3)
            As `extinction` takes them, broadcast against each other; lines are straight on the map.
        time : float or datetime
            As for `extinction`.

        Returns
        -------
        numpy.ndarray
            (...) float64, without unit.
        """
        return self._ask("optical_depth", a, b, time)

    def inside(self, points: Any, time: Any = 0.0) -> Any:
        """Whether places are inside a cloud: where extinction is over a tenth of that in its middle.

        Parameters
        ----------
        points, time
            As for `extinction`.

        Returns
        -------
        numpy.ndarray
            (...) bool.
        """
        return self._ask("inside", points, time)

    def _ask(self, question: str, *values: Any) -> Any:
        if self._world is None:
            raise WorldError(f"these clouds belong to no world yet: ask world.clouds.{question}(…)")
        return queries.resolve(f"clouds.{question}")(self._world, *values)
