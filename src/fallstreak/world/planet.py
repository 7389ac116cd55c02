"""The body the scene stands on, a sphere, and the presets that fill planet and sky."""

from __future__ import annotations

from typing import Any, Literal

from .fields import Colour, Number, Section, choice, quantity

PlanetName = Literal["earth", "mars", "custom"]


class Planet(Section):
    """A sphere with a sun at a distance; ``preset`` gives planet and sky their defaults."""

    preset: PlanetName = choice(
        "earth",
        doc="Whose planet and sky defaults to take; keys that are given win (custom: those of earth).",
    )
    radius: Number = quantity(
        6.36e6, unit="m", ge=1e5, le=1e8, doc="Radius of the sphere that is height 0 (sea level)."
    )
    sun_distance_au: Number = quantity(
        1.0, unit="au", ge=0.05, le=50.0, doc="Distance of the sun; sunlight falls with its square."
    )
    surface: Literal["ocean", "land", "mars"] = choice(
        "land", doc="What covers the sphere where there is no terrain."
    )
    ground_albedo: Colour = quantity(
        (0.3, 0.3, 0.3),
        doc="Mean reflectance of the ground, which lights the air from below (linear Rec. 709).",
    )


# Mars: mean radius; CO2 at 610 Pa and 210 K (2.1e23 molecules/m³) scatters 2.5 times as strongly as air
# per molecule; dust of optical depth 0.5 mixed over the pressure scale height of 11.1 km, its albedo (single
# scattering) falling from red to blue as Tomasko et al. 1999 (Pathfinder) found it: that makes the sky ochre.
_MARS_DUST_EXTINCTION = 4.5e-5
_MARS_DUST_ALBEDO = (0.965, 0.90, 0.76)

PRESETS: dict[str, dict[str, dict[str, Any]]] = {
    "earth": {},
    "custom": {},
    "mars": {
        "planet": {
            "radius": 3.3895e6,
            "sun_distance_au": 1.523679,
            "surface": "mars",
            "ground_albedo": (0.30, 0.17, 0.09),
        },
        "sky": {
            "rayleigh_scattering": (0.99e-7, 2.31e-7, 5.65e-7),
            "rayleigh_scale_height": 11.1e3,
            "mie_scattering": tuple(_MARS_DUST_EXTINCTION * a for a in _MARS_DUST_ALBEDO),
            "mie_extinction": (_MARS_DUST_EXTINCTION,) * 3,
            "mie_g": (0.70, 0.73, 0.78),
            "mie_scale_height": 11.1e3,
            "phase": "mars",
            "ozone_absorption": (0.0, 0.0, 0.0),
            "top_height": 100e3,
            "moon": False,
            "night_glow": 1e-5,
        },
        "terrain": {"material": "mars"},
    },
}
"""For each ``planet.preset``, the defaults that differ from Earth's, section by section."""
