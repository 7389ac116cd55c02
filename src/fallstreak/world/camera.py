"""The camera: where it stands, where it looks, and its way through time."""

from __future__ import annotations

from dataclasses import dataclass
from math import radians
from typing import Literal, Self

from pydantic import PrivateAttr, model_validator

from .fields import Number, Section, choice, quantity
from .tracks import Track, tracks_of

_CHANNELS = ("east", "north", "height", "heading", "pitch", "roll", "fov")


@dataclass(frozen=True, slots=True)
class Pose:
    """A camera at one moment; metres and degrees as in the file."""

    east: float
    north: float
    height: float
    above: str
    heading: float
    pitch: float
    roll: float
    fov: float

    @property
    def angles(self) -> tuple[float, float, float, float]:
        """Heading, pitch, roll and vertical field of view in radians."""
        return radians(self.heading), radians(self.pitch), radians(self.roll), radians(self.fov)


class Keyframe(Section):
    """What the camera has reached ``at`` a time; what is left out passes this keyframe by."""

    at: Number = quantity(unit="s", ge=-1e7, le=1e7, doc="Seconds since the start of the scene.")
    east: Number | None = quantity(None, unit="m", ge=-1e6, le=1e6, doc="Metres east of the anchor.")
    north: Number | None = quantity(None, unit="m", ge=-1e6, le=1e6, doc="Metres north of the anchor.")
    height: Number | None = quantity(
        None, unit="m", ge=-1e4, le=1e8, doc="Height over what camera.above says."
    )
    heading: Number | None = quantity(None, unit="deg", ge=-360.0, le=720.0, doc="Clockwise from north.")
    pitch: Number | None = quantity(None, unit="deg", ge=-90.0, le=90.0, doc="Above the horizon.")
    roll: Number | None = quantity(None, unit="deg", ge=-360.0, le=360.0, doc="Clockwise tilt.")
    fov: Number | None = quantity(None, unit="deg", ge=0.1, le=150.0, doc="Vertical field of view.")


class Camera(Section):
    """A pinhole camera on the map, fixed or moving along keyframes."""

    east: Number = quantity(0.0, unit="m", ge=-1e6, le=1e6, doc="Metres east of the anchor along the map.")
    north: Number = quantity(0.0, unit="m", ge=-1e6, le=1e6, doc="Metres north of the anchor along the map.")
    height: Number = quantity(1.7, unit="m", ge=-1e4, le=1e8, doc="Height over what above says.")
    above: Literal["ground", "sea"] = choice(
        "ground", doc="Whether height counts from the ground or from height 0."
    )
    heading: Number = quantity(
        0.0, unit="deg", ge=-360.0, le=720.0, doc="Where it looks, clockwise from north."
    )
    pitch: Number = quantity(0.0, unit="deg", ge=-90.0, le=90.0, doc="How far above the horizon it looks.")
    roll: Number = quantity(
        0.0, unit="deg", ge=-360.0, le=360.0, doc="Tilt, clockwise as the camera sees it."
    )
    fov: Number = quantity(45.0, unit="deg", ge=0.1, le=150.0, doc="Vertical field of view.")
    keyframes: tuple[Keyframe, ...] = choice(
        (), max_length=10_000, doc="The camera's way: what it has reached at which second, in order of time."
    )

    _tracks: dict[str, Track] = PrivateAttr(default_factory=dict)

    @model_validator(mode="after")
    def _keyframes_in_order(self) -> Self:
        self._tracks.update(tracks_of(self.keyframes, _CHANNELS))
        return self

    def at(self, seconds: float) -> Pose:
        """The camera ``seconds`` after the scene's start.

        East and north follow a Catmull-Rom curve through the keyframes, the heading turns the shorter way,
        all else is interpolated monotonically (a camera above the ground stays above it). Before the first
        keyframe and after the last one the camera rests. What no keyframe states stays as the camera has it.
        """
        values = {
            name: self._tracks[name](seconds) if name in self._tracks else getattr(self, name)
            for name in _CHANNELS
        }
        return Pose(above=self.above, **values)
