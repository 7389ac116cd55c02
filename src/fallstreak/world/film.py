"""The film in the camera: exposure, tone map and what a lens adds."""

from __future__ import annotations

from typing import Literal

from .fields import Flag, Number, Section, choice, quantity


class Film(Section):
    """How luminance becomes a picture."""

    exposure: Literal["auto", "fixed"] = choice(
        "auto", doc="auto meters the picture and adapts in time; fixed takes ev100."
    )
    ev100: Number = quantity(
        14.0,
        unit="EV",
        ge=-12.0,
        le=24.0,
        doc="For exposure fixed: exposure value at ISO 100 (sunny 15, full moon -3).",
    )
    compensation: Number = quantity(
        0.0,
        unit="stops",
        ge=-10.0,
        le=10.0,
        doc="Brightens (positive) or darkens the picture, as on a camera.",
    )
    white_balance: Number = quantity(
        5500.0,
        unit="K",
        ge=4000.0,
        le=25000.0,
        doc="Which daylight is white: 5500 the sun and sky of a clear day; lower is bluer.",
    )
    tone_map: Literal["agx", "neutral", "none"] = choice(
        "agx", doc="agx: filmic, Blender's; neutral: Khronos PBR neutral, keeps colours; none: clips."
    )
    look: Literal["base", "medium", "punchy"] = choice(
        "medium", doc="Contrast and saturation of agx, from soft to strong; other tone maps have none."
    )
    bloom: Number = quantity(
        0.04, ge=0.0, le=1.0, doc="Share of the light that the lens spreads over the picture."
    )
    dither: Flag = choice(True, doc="Whether half a step of noise hides banding in 8-bit pictures.")
    night_vision: Flag = choice(
        True, doc="Whether the dark loses colour and turns blue, as it does for the eye (Purkinje)."
    )
