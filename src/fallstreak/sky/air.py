"""What the air is made of: one declaration for the float64 model and for the shaders."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from fallstreak.gpu import Struct

from .spectrum import BANDS, GIVEN, SKY_RESPONSE, at_bands, ozone_at_bands

if TYPE_CHECKING:
    from fallstreak.world import World

Colour = tuple[float, float, float]

# Mars's dust (radius about 1.5 µm) sends half of what it meets into a diffraction peak whose half-width is
# about λ / 4r: 6.7°, 5.4° and 4.3° at 680, 550 and 440 nm. A Henyey-Greenstein lobe of asymmetry g falls to
# half at 0.766 (1 - g) / √g, which gives these; the rest is refracted and reflected into a wide lobe.
_MARS_FORWARD = (0.86, 0.885, 0.906)
_MARS_WIDE = 0.45

AIR = Struct(
    "Air",
    [
        ("rayleigh_scattering", "vec3f", "1/m at height 0"),
        ("planet_radius", "f32", "m"),
        ("mie_scattering", "vec3f", "1/m at height 0"),
        ("top_height", "f32", "m, no air above"),
        ("mie_extinction", "vec3f", "1/m at height 0"),
        ("rayleigh_falloff", "f32", "1/m, of the scale height"),
        ("ozone_absorption", "vec3f", "1/m at the layer's middle"),
        ("mie_falloff", "f32", "1/m, of the scale height"),
        ("mie_forward", "vec3f", "asymmetry of the aerosol's forward lobe"),
        ("ozone_centre", "f32", "m"),
        ("mie_wide", "vec3f", "asymmetry of the aerosol's wide lobe"),
        ("ozone_falloff", "f32", "1/m, from the middle to nothing"),
        ("mie_forward_share", "vec3f", "what the forward lobe holds of the scattered light"),
        ("cornette_shanks", "f32", "1: forward lobe after Cornette and Shanks, 0: Henyey-Greenstein"),
        ("ground_albedo", "vec3f", "mean reflectance of the planet"),
        ("horizon_of_top", "f32", "m, distance from the top of the air to its horizon"),
        ("sky_response", "vec3f", "luminance of scattered light over that of sunlight, see spectrum.py"),
    ],
)


@dataclass(frozen=True)
class Air:
    """An atmosphere at three wavelengths; lengths in m, coefficients in 1/m.

    The defaults are the clear air of Bruneton 2017 at 680, 550 and 440 nm; `mie_*` hold the turbidity.
    """

    planet_radius: float = 6.36e6
    top_height: float = 60e3
    rayleigh_scattering: Colour = (5.802e-6, 1.3558e-5, 3.310e-5)
    rayleigh_scale_height: float = 8e3
    mie_scattering: Colour = (3.996e-6, 3.996e-6, 3.996e-6)
    mie_extinction: Colour = (4.44e-6, 4.44e-6, 4.44e-6)
    mie_scale_height: float = 1.2e3
    mie_forward: Colour = (0.8, 0.8, 0.8)
    mie_wide: Colour = (0.0, 0.0, 0.0)
    mie_forward_share: Colour = (1.0, 1.0, 1.0)
    cornette_shanks: bool = False
    ozone_absorption: Colour = (6.497e-7, 1.8809e-6, 8.50e-8)
    ozone_centre: float = 25e3
    ozone_width: float = 15e3
    ground_albedo: Colour = (0.3, 0.3, 0.3)
    name: str = field(default="earth", compare=False)

    @classmethod
    def of(cls, world: World) -> Air:
        """The air of a world, carried to the wavelengths at which the sky is computed (see `spectrum`)."""
        sky, planet = world.sky, world.planet
        g = np.interp(BANDS, GIVEN[::-1], sky.mie_g[::-1])
        forward, wide, share = g, np.zeros(3), np.ones(3)
        if sky.phase == "mars":
            forward, wide = np.interp(BANDS, GIVEN[::-1], _MARS_FORWARD[::-1]), np.full(3, _MARS_WIDE)
            # the shares that give the mean cosine asked for, where two such lobes can
            share = np.clip((g - wide) / (forward - wide), 0.0, 1.0)
        return cls(
            planet_radius=planet.radius,
            top_height=sky.top_height,
            rayleigh_scattering=_colour(at_bands(sky.rayleigh_scattering)),
            rayleigh_scale_height=sky.rayleigh_scale_height,
            mie_scattering=_colour(at_bands(sky.mie_scattering) * sky.turbidity),
            mie_extinction=_colour(at_bands(sky.mie_extinction) * sky.turbidity),
            mie_scale_height=sky.mie_scale_height,
            mie_forward=_colour(forward),
            mie_wide=_colour(wide),
            mie_forward_share=_colour(share),
            cornette_shanks=sky.phase == "cornette_shanks",
            ozone_absorption=_colour(ozone_at_bands(sky.ozone_absorption)),
            ozone_centre=sky.ozone_centre,
            ozone_width=sky.ozone_width,
            ground_albedo=planet.ground_albedo,
            name=planet.preset,
        )

    def uniform(self) -> dict[str, object]:
        """The values of the shaders' `Air`."""
        derived = {
            "rayleigh_falloff": 1.0 / self.rayleigh_scale_height,
            "mie_falloff": 1.0 / self.mie_scale_height,
            "ozone_falloff": 1.0 / self.ozone_width,
            "horizon_of_top": (self.top_height * (2.0 * self.planet_radius + self.top_height)) ** 0.5,
            "sky_response": SKY_RESPONSE,
        }
        return {name: derived[name] if name in derived else getattr(self, name) for name, _, _ in AIR.fields}


def _colour(values: np.ndarray) -> Colour:
    r, g, b = (float(v) for v in values)
    return r, g, b
