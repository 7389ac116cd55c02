"""Things in the world: glTF models that stand, fly along keyframes or are moved from Python."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path, PurePath
from typing import Literal, Self

from pydantic import PrivateAttr, field_validator, model_validator

from .fields import Number, Section, Whole, choice, quantity
from .terrain import is_path
from .tracks import Track, tracks_of

SHIPPED = ("glider", "ship")
"""Models that come with the package."""

_CHANNELS = ("east", "north", "height", "heading", "pitch", "roll", "scale")

_EAST = {"unit": "m", "ge": -1e7, "le": 1e7, "doc": "Metres east of the anchor along the map."}
_NORTH = {"unit": "m", "ge": -1e7, "le": 1e7, "doc": "Metres north of the anchor along the map."}
_HEIGHT = {"unit": "m", "ge": -1e5, "le": 1e9, "doc": "Height of the model's origin over what above says."}
_HEADING = {"unit": "deg", "ge": -360.0, "le": 720.0, "doc": "Where its nose points, clockwise from north."}
_PITCH = {"unit": "deg", "ge": -360.0, "le": 360.0, "doc": "How far above the horizon its nose points."}
_ROLL = {"unit": "deg", "ge": -720.0, "le": 720.0, "doc": "Bank: positive, its right wing is down."}
_SCALE = {"ge": 1e-4, "le": 1e4, "doc": "Its size, 1 = as in the file (glTF counts in metres)."}


@dataclass(frozen=True, slots=True)
class ModelPose:
    """Where a model is at one moment; metres and degrees as in the file."""

    east: float
    north: float
    height: float
    heading: float
    pitch: float
    roll: float
    scale: float


class ModelInstance(Section):
    """One of many copies of a model; what is left out is the model's own."""

    east: Number | None = quantity(None, **_EAST)
    north: Number | None = quantity(None, **_NORTH)
    height: Number | None = quantity(None, **_HEIGHT)
    heading: Number | None = quantity(None, **_HEADING)
    pitch: Number | None = quantity(None, **_PITCH)
    roll: Number | None = quantity(None, **_ROLL)
    scale: Number | None = quantity(None, **_SCALE)


class ModelKeyframe(ModelInstance):
    """What a model has reached ``at`` a time; what is left out passes this keyframe by."""

    at: Number = quantity(unit="s", ge=-1e7, le=1e7, doc="Seconds since the start of the scene.")


class Model(Section):
    """A model in the world: one, many copies of it, or one on its way along keyframes."""

    file: str = choice(
        max_length=4096,
        doc="A .glb or .gltf beside the scene, or the name of a shipped model (glider, ship).",
    )
    name: str = choice(
        "", max_length=60, doc="How Python calls it: renderer.models[name] (default: the file's name)."
    )
    east: Number = quantity(0.0, **_EAST)
    north: Number = quantity(0.0, **_NORTH)
    height: Number = quantity(0.0, **_HEIGHT)
    above: Literal["ground", "sea"] = choice(
        "ground", doc="Whether height counts from the ground below or from height 0."
    )
    heading: Number = quantity(0.0, **_HEADING)
    pitch: Number = quantity(0.0, **_PITCH)
    roll: Number = quantity(0.0, **_ROLL)
    scale: Number = quantity(1.0, **_SCALE)
    instances: tuple[ModelInstance, ...] = choice(
        (), max_length=100_000, doc="Many copies of the model, each with what differs from the rest."
    )
    keyframes: tuple[ModelKeyframe, ...] = choice(
        (), max_length=10_000, doc="The model's way: what it has reached at which second, in order of time."
    )
    capacity: Whole = quantity(
        1000, ge=1, le=1_000_000, doc="How many copies Python may make of it (never fewer than instances)."
    )

    _tracks: dict[str, Track] = PrivateAttr(default_factory=dict)

    @field_validator("file")
    @classmethod
    def _names_a_file(cls, file: str) -> str:
        if not is_path(file) and file not in SHIPPED:
            raise ValueError(f"shipped models are {', '.join(SHIPPED)}, and a file ends in .glb or .gltf")
        return file

    @field_validator("name")
    @classmethod
    def _is_plain(cls, name: str) -> str:
        if not all(c.isalnum() or c in "_- " for c in name):
            raise ValueError("it must consist of letters, digits, spaces, - and _")
        return name

    @model_validator(mode="after")
    def _one_way_to_move(self) -> Self:
        if self.instances and self.keyframes:
            raise ValueError("it has instances and keyframes: a model that moves along keyframes is one")
        self._tracks.update(tracks_of(self.keyframes, _CHANNELS))
        return self

    @property
    def called(self) -> str:
        """Its name, or its file's where it has none."""
        stem = PurePath(self.file).stem if is_path(self.file) else self.file
        return self.name or "".join(c if c.isalnum() or c in "_- " else "_" for c in stem)[:60]

    @property
    def path(self) -> Path | None:
        """Its file (absolute), or None for a shipped model."""
        return Path(self.file) if is_path(self.file) else None

    def at(self, seconds: float) -> ModelPose:
        """The model ``seconds`` after the scene's start; interpolated as the camera is (`Camera.at`)."""
        return ModelPose(
            **{n: self._tracks[n](seconds) if n in self._tracks else getattr(self, n) for n in _CHANNELS}
        )

    def poses(self) -> list[ModelPose]:
        """Of all its instances, or the one of a model without."""
        if not self.instances:
            return [self.at(0.0)]
        own = {name: getattr(self, name) for name in _CHANNELS}
        given = (i.model_dump(exclude_none=True) for i in self.instances)
        return [ModelPose(**(own | stated)) for stated in given]


def check_names(models: Iterable[Model]) -> None:
    """Every model of a world has a name of its own.

    Raises
    ------
    ValueError
        When two are called the same.
    """
    seen: set[str] = set()
    for model in models:
        if model.called in seen:
            raise ValueError(f'two models are called "{model.called}": give one of them another name')
        seen.add(model.called)
