"""How a field of the world is declared: once, with type, unit, range, default and a sentence."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import AllowInfNan, BaseModel, BeforeValidator, ConfigDict, Field, Strict

Number = Annotated[float, Strict(), AllowInfNan(False)]
Whole = Annotated[int, Strict()]
Flag = Annotated[bool, Strict()]


def _spread(value: Any) -> Any:
    """One number stands for three equal ones."""
    return (value,) * 3 if isinstance(value, (int, float)) and not isinstance(value, bool) else value


def _auto(value: Any) -> Any:
    return None if isinstance(value, str) and value == "auto" else value


_Share = Annotated[Number, Field(ge=0.0, le=1.0)]
_Cosine = Annotated[Number, Field(ge=-0.999, le=0.999)]
_Degrees = Annotated[Number, Field(ge=0.01, le=20.0)]

Colour = Annotated[
    tuple[_Share, _Share, _Share],
    BeforeValidator(_spread, json_schema_input_type=_Share | tuple[_Share, _Share, _Share]),
]
"""Linear Rec. 709 reflectance, three numbers in 0..1; one number stands for a grey."""

Spectrum = Colour
"""A coefficient in 1/m at 680, 550 and 440 nm, each in 0..1; one number stands for all three."""

Asymmetry = Annotated[
    tuple[_Cosine, _Cosine, _Cosine],
    BeforeValidator(_spread, json_schema_input_type=_Cosine | tuple[_Cosine, _Cosine, _Cosine]),
]
"""Mean cosine of a phase function at 680, 550 and 440 nm; one number stands for all three."""

AutoAngle = Annotated[
    _Degrees | None, BeforeValidator(_auto, json_schema_input_type=_Degrees | Literal["auto"])
]
"""An angle in degrees, or "auto" (``None`` in Python): it follows from the rest of the world."""


def quantity(default: Any = ..., *, doc: str, unit: str = "1", **limits: Any) -> Any:
    """Declare one field: its default, a sentence, its unit ("1": a pure number) and its range.

    ``limits`` are pydantic's (``ge``, ``le``, ``gt``, ``lt``, ``max_length``).
    """
    return Field(default, description=doc, json_schema_extra={"unit": unit}, validate_default=True, **limits)


def choice(default: Any = ..., *, doc: str, **more: Any) -> Any:
    """Declare a field that has no unit: a name, a flag, a list."""
    return Field(default, description=doc, **more)


def table(model: type[BaseModel], doc: str) -> Any:
    """Declare a table whose own defaults stand when it is left out."""
    return Field(default_factory=model, description=doc)


class Section(BaseModel):
    """A frozen table of the world that knows no other keys than its own."""

    # One build for the whole world, at its first use, instead of one per table at import.
    model_config = ConfigDict(extra="forbid", frozen=True, defer_build=True)

    def __eq__(self, other: object) -> bool:
        # Where a world came from (private attributes) does not make it another world.
        return type(self) is type(other) and self.__dict__ == other.__dict__
