"""Shadows: what throws them, and how."""

from __future__ import annotations

from typing import Literal

from .fields import Flag, Number, Section, choice, quantity


class Shadows(Section):
    """Shadows of land, plants and models in the light of sun or moon. Clouds have their own switch."""

    technique: Literal["stable", "infinity2007", "none"] = choice(
        "stable",
        doc="stable: land by a swept shadow height, as far as there is land, things by maps that stand "
        "still; infinity2007: four maps of everything to 5.5 km, as the Infinity journal had them; none.",
    )
    near: Number = quantity(
        40.0,
        unit="m",
        ge=5.0,
        le=500.0,
        doc="How far from the camera the finest map of things reaches; three more, each four times as far.",
    )
    contact: Number = quantity(
        0.3, unit="m", ge=0.0, le=5.0, doc="Length of contact shadows in the picture near the eye; 0: none."
    )
    show: Flag = choice(
        False,
        doc="Whether the picture is tinted by the map that each shadow comes from, with its texels; "
        "paler where the map is kept from an earlier frame.",
    )
