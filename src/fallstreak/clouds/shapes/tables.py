"""What a cloud model's file may hold: keys, units, ranges."""

from __future__ import annotations

from itertools import pairwise
from typing import Annotated, Any

from pydantic import Field, field_validator, model_validator

from ...world.fields import Number, Section, Whole, choice, quantity, table

MOST_BOXES = 24
MOST_SPRITES = 32
TEXTURES = 16
GROUPS = 8

_Metres = Annotated[Number, Field(ge=-40_000.0, le=40_000.0)]
_Size = Annotated[Number, Field(ge=1.0, le=40_000.0)]
_Share = Annotated[Number, Field(ge=0.0, le=1.0)]
_Part = Annotated[Number, Field(ge=0.1, le=1.2)]
_Percent = Annotated[Number, Field(ge=0.0, le=400.0)]
_Texture = Annotated[Whole, Field(ge=0, le=TEXTURES - 1)]
_Textures = Annotated[tuple[_Texture, ...], Field(min_length=1, max_length=TEXTURES)]
Colour = tuple[_Share, _Share, _Share]


class Sprites(Section):
    """How boxes are filled with sprites, where they do not say so themselves."""

    per_box: Whole = quantity(
        5, doc="sprites of a box: one in its middle, the others near its surface", ge=0, le=MOST_SPRITES
    )
    size: tuple[_Part, _Part] = quantity((0.5, 0.7), doc="smallest and largest size, over the box's own")
    textures: _Textures = choice((0, 1, 2, 3), doc="which of the 16 textures they are drawn with, by chance")
    spacing: Number = quantity(
        0.0, doc="sprites closer to one before them are culled", unit="m", ge=0.0, le=1e4
    )

    @field_validator("size")
    @classmethod
    def _ascending(cls, value: Any) -> Any:
        if value[0] > value[1]:
            raise ValueError("the smallest size is larger than the largest")
        return value


class Box(Section):
    """A box: the ellipsoid in it is cloud."""

    centre: tuple[_Metres, _Metres, _Metres] = quantity(
        doc="east, north, and up from the cloud's base", unit="m"
    )
    size: tuple[_Size, _Size, _Size] = quantity(doc="full widths along its own axes", unit="m")
    turn: Number = quantity(
        0.0, doc="about the vertical, counter-clockwise from above", unit="deg", ge=-360.0, le=360.0
    )
    group: Whole = quantity(0, doc="shading group", ge=0, le=GROUPS - 1)
    density: Number = quantity(1.0, doc="of the layer's extinction", ge=0.0, le=1.0)
    sprites: Whole | None = quantity(None, doc="how many; else [sprites] per_box", ge=0, le=MOST_SPRITES)
    textures: _Textures | None = choice(None, doc="else those of [sprites]")
    spacing: Number | None = quantity(None, doc="else that of [sprites]", unit="m", ge=0.0, le=1e4)


class Hour(Section):
    """An hour's light, as artists gave it."""

    ambient: _Percent = quantity(100.0, doc="of the colour of the level", unit="%")
    directional: Colour = quantity((1.0, 1.0, 1.0), doc="largest directional colour, linear Rec. 709")
    least: _Percent = quantity(0.0, doc="of it, where a group's side is turned from the light", unit="%")
    most: _Percent = quantity(100.0, doc="of it, where it faces the light", unit="%")

    @model_validator(mode="after")
    def _ascending(self) -> Any:
        if self.least > self.most:
            raise ValueError("least is larger than most")
        return self


_Level = tuple[_Share, _Share, _Share, _Share, _Share]

LEVELS = (
    (0.0, 0.26, 0.29, 0.34, 1.0),
    (0.2, 0.34, 0.37, 0.42, 1.0),
    (0.45, 0.42, 0.45, 0.50, 1.0),
    (0.75, 0.48, 0.51, 0.55, 1.0),
    (1.0, 0.52, 0.55, 0.58, 1.0),
)


class Colours(Section):
    """Colours of ``colours = "artist"``: five levels by height, and what each hour makes of them."""

    levels: tuple[_Level, _Level, _Level, _Level, _Level] = quantity(
        LEVELS, doc="five rows [height 0…1, red, green, blue, opacity], lowest first"
    )
    dawn: Hour = table(Hour, "the sun at the horizon, rising")
    noon: Hour = table(Hour, "the sun at 40° or higher")
    sunset: Hour = table(Hour, "the sun at the horizon, setting")
    night: Hour = table(Hour, "the sun 10° or more below the horizon")

    @field_validator("levels")
    @classmethod
    def _rising(cls, value: Any) -> Any:
        heights = [level[0] for level in value]
        if any(b <= a for a, b in pairwise(heights)):
            raise ValueError("heights must rise from level to level")
        return value


class ModelFile(Section):
    """A cloud model's file."""

    title: str = choice(doc="what it is, in a few words", min_length=1, max_length=200)
    boxes: tuple[Box, ...] = choice(doc="what the cloud is made of", min_length=1, max_length=MOST_BOXES)
    sprites: Sprites = table(Sprites, "how boxes are filled with sprites")
    colours: Colours = table(Colours, "colours of artists")
