"""The air and what shines through it, as Bruneton 2017 has it: three wavelengths, 680, 550 and 440 nm."""

from __future__ import annotations

from typing import Literal, Self

from pydantic import model_validator

from .fields import Asymmetry, AutoAngle, Flag, Number, Section, Spectrum, choice, quantity, table


class Sun(Section):
    """How the sun's disc is drawn."""

    disc: Flag = choice(True, doc="Whether the disc itself is seen (its light is there in any case).")
    limb_darkening: Flag = choice(True, doc="Whether the disc darkens and reddens towards its edge.")
    angular_diameter: AutoAngle = quantity(
        None,
        unit="deg",
        ge=0.01,
        le=20.0,
        doc='Apparent diameter of the disc; "auto" follows from the distance.',
    )


class Sky(Section):
    """Gas, aerosol and ozone by height, and sun, moon, stars and airglow."""

    turbidity: Number = quantity(
        1.0, ge=0.0, le=100.0, doc="Multiplies the aerosol: 0 none, 1 a clear day, 5 hazy, 20 thick haze."
    )
    rayleigh_scattering: Spectrum = quantity(
        (5.802e-6, 1.3558e-5, 3.310e-5),
        unit="1/m",
        doc="Scattering by the gas at height 0 (680, 550, 440 nm).",
    )
    rayleigh_scale_height: Number = quantity(
        8000.0, unit="m", ge=100.0, le=1e5, doc="Height over which the gas thins by a factor e."
    )
    mie_scattering: Spectrum = quantity(
        (3.996e-6, 3.996e-6, 3.996e-6),
        unit="1/m",
        doc="Scattering by aerosol at height 0 and turbidity 1 (680, 550, 440 nm).",
    )
    mie_extinction: Spectrum = quantity(
        (4.44e-6, 4.44e-6, 4.44e-6),
        unit="1/m",
        doc="Scattering plus absorption by aerosol at height 0 and turbidity 1; at least mie_scattering.",
    )
    mie_g: Asymmetry = quantity(
        (0.8, 0.8, 0.8), doc="Mean cosine of the aerosol's phase function: 0 even, towards 1 forward."
    )
    mie_scale_height: Number = quantity(
        1200.0, unit="m", ge=10.0, le=1e5, doc="Height over which the aerosol thins by a factor e."
    )
    phase: Literal["henyey_greenstein", "cornette_shanks", "mars"] = choice(
        "cornette_shanks", doc="Phase function of the aerosol; mars is dust whose forward peak is blue."
    )
    ozone_absorption: Spectrum = quantity(
        (6.497e-7, 1.8809e-6, 8.50e-8), unit="1/m", doc="Absorption at the middle of the ozone layer."
    )
    ozone_centre: Number = quantity(
        25e3, unit="m", ge=0.0, le=2e5, doc="Height of the middle of the ozone layer."
    )
    ozone_width: Number = quantity(
        15e3,
        unit="m",
        ge=1.0,
        le=2e5,
        doc="Ozone falls linearly to nothing this far above and below its middle.",
    )
    top_height: Number = quantity(
        100e3,
        unit="m",
        ge=1e3,
        le=1e6,
        doc="Height above which there is no air; take 8 scale heights or more.",
    )
    sun: Sun = table(Sun, "The sun's disc: whether it is drawn, and how.")
    moon: Flag = choice(True, doc="Whether the moon is drawn and shines.")
    stars: Flag = choice(True, doc="Whether the stars are drawn.")
    star_magnitude_limit: Number = quantity(
        6.5, unit="mag", ge=-2.0, le=8.0, doc="Faintest star drawn; the eye sees 6.5 under a dark sky."
    )
    night_glow: Number = quantity(
        1.5e-4, unit="cd/m²", ge=0.0, le=1.0, doc="Luminance of the airglow at the zenith."
    )

    @model_validator(mode="after")
    def _extinction_holds_scattering(self) -> Self:
        for scattered, lost in zip(self.mie_scattering, self.mie_extinction, strict=True):
            if scattered > lost * (1 + 1e-9):
                raise ValueError(
                    f"mie_scattering ({scattered:g}) is greater than mie_extinction ({lost:g}), "
                    "and extinction is scattering plus absorption"
                )
        return self
