"""The lights above the air, as every system's shaders see them: the uniform `sky.light`.

The sun is spectrum.py's 133 klx at 1 au. Magnitudes become lux by 2.54e-6 lx for magnitude 0 (one cd/m2 is
12.58 magnitudes per square arc second; the sun's -26.74 would be 126 klx). Moonlight follows Allen's law of
phase (Astrophysical Quantities, section 66; Krisciunas and Schaefer, PASP 103 (1991), equation 20): V =
-12.73 + 0.026 a + 4e-9 a^4 with the phase angle a in degrees, at mean distances; 0.31 lx above the air at
mean full moon, about 0.27 lx below it. Its colour is the sun's times a regolith whose reflectance rises by
a third from 440 to 680 nm.

Limits: the brightening of the full moon in its last degrees (the opposition effect) is left out. In a solar
eclipse the disc is covered without regard to limb darkening, the corona is not drawn, and totality gets its
few lux from the sun's direction instead of from the horizon all around.
"""

from __future__ import annotations

from math import acos, asin, atan2, cos, degrees, exp, log, pi, radians, sin, sqrt, tan
from typing import TYPE_CHECKING

import numpy as np

from fallstreak.gpu import Struct

from .ephemeris import AU, EARTH_RADIUS, SUN_RADIUS, Heavens
from .spectrum import LUMINANCE, SUN_ILLUMINANCE

if TYPE_CHECKING:
    from fallstreak.world import World

LIGHT = Struct(
    "Light",
    [
        ("sun_direction", "vec3f", "unit, towards the sun, with refraction"),
        ("sun_radius", "f32", "rad, angular radius of the disc"),
        ("sun_illuminance", "vec3f", "lux above the air at normal incidence, less what the moon covers"),
        ("table_scale", "f32", "the sky's half-float tables hold luminance times this"),
        ("sun_luminance", "vec3f", "cd/m2 in the middle of the disc above the air"),
        ("sun_limb", "vec3f", "luminance over the disc is middle * mu^this, mu the cosine on the sun's face"),
        ("refraction", "f32", "strength of refraction at the camera, 1 at sea level, 0 for none"),
        ("moon_direction", "vec3f", "unit, towards the moon, with refraction"),
        ("moon_radius", "f32", "rad, 0 if there is no moon"),
        ("moon_illuminance", "vec3f", "lux above the air"),
        ("moon_shadow", "f32", "rad, radius of the Earth's umbra at the moon"),
        ("moon_luminance", "vec3f", "cd/m2 of the face above the air before its shading, see moon.wesl"),
        ("moon_penumbra", "f32", "rad, radius of the Earth's penumbra at the moon"),
        ("moon_earthshine", "vec3f", "cd/m2 of the face by the Earth's light"),
        ("stars", "f32", "1 if stars and planets are drawn"),
        ("moon_sun_direction", "vec3f", "unit, from the moon to the sun"),
        ("antisun_direction", "vec3f", "unit, axis of the Earth's shadow at the moon"),
        ("airglow", "vec3f", "cd/m2 at the zenith above the air"),
        ("moon_from_world", "mat3x3f", "the moon's own axes: x middle of the near side, z north"),
        ("equatorial_from_world", "mat3x3f", "J2000 equatorial axes"),
    ],
)

MAGNITUDE_ZERO_LUX = 2.54e-6

# mu^a with a of Hestroffer and Magnan (A&A 333 (1998) 338) at 680, 550 and 440 nm.
_LIMB = np.array([0.397, 0.503, 0.652])

MOON_COLOUR = SUN_ILLUMINANCE * (1.10, 0.985, 0.82)  # regolith's reflectance over the three bands
MOON_COLOUR /= MOON_COLOUR @ LUMINANCE
_AIRGLOW_TINT = np.array([0.95, 1.03, 0.88])  # the green and red oxygen lines over a broad continuum
_EARTH_TINT = np.array([0.85, 1.02, 1.25])  # of oceans and clouds against the sun
_UMBRA_GLOW = 4e-4  # sunlight bent into the middle of the Earth's shadow, of full sunlight
_BEYOND_SHADOW = 5e-5  # of sunlight: what sunlit air outside the moon's shadow sends into it, some 6 lx
_MOON_MEAN_DISTANCE = 3.844e8

# log10 lux on level ground against the sun's true elevation in degrees (USNO Circular 171).
_GROUND_ELEVATION = (-90, -18, -15, -12, -9, -6, -5, -3, -0.8, 0, 2, 5, 10, 20, 40, 90)
_GROUND_LUX = (-5, -3.19, -2.89, -2.1, -0.82, 0.53, 0.95, 1.75, 2.66, 2.88, 3.26, 3.75, 4.13, 4.53, 4.85, 5)


def light_values(world: World, heavens: Heavens, altitude: float = 0.0) -> dict[str, object]:
    """Every field of `LIGHT` for a world under a given sky.

    Parameters
    ----------
    world : World
        Its planet and sky sections say how far the sun is and which lights are on.
    heavens : Heavens
        From `Ephemeris.at` for the world's place and the frame's time.
    altitude : float
        The camera's, metres above the sphere: what it sees of lit air decides the scale of the tables.

    Returns
    -------
    dict
        Ready for ``Uniform.set(**values)`` or ``LIGHT.pack(**values)``.
    """
    sky, planet = world.sky, world.planet
    # The world may move its sun; the ephemeris then still tells the seasons about that mean distance.
    mean = 1.523679 if planet.preset == "mars" else 1.0
    distance = heavens.sun_distance / AU * planet.sun_distance_au / mean
    radius = heavens.sun_radius * mean / planet.sun_distance_au
    if sky.sun.angular_diameter is not None:
        radius = radians(sky.sun.angular_diameter) / 2
    sun = SUN_ILLUMINANCE / distance**2
    limb = _LIMB if sky.sun.limb_darkening else np.zeros(3)
    sun_luminance = sun / (pi * sin(radius) ** 2) * (2 + limb) / 2

    moon_on = bool(sky.moon) and heavens.moon_radius > 0
    moon_radius = moon_lux = face = covered = shine = 0.0
    umbra, penumbra = earth_shadow(heavens.moon_distance, heavens.sun_distance)
    if moon_on:
        moon_radius = heavens.moon_radius
        covered = covered_fraction(_angle(heavens.sun_direction, heavens.moon_direction), radius, moon_radius)
        moon_lux = moon_illuminance(heavens.moon_phase, heavens.moon_distance, distance)
        # The face knows nothing of the eclipse: its shader draws the shadow point by point.
        face = moon_lux / (lommel_seeliger_phase(heavens.moon_phase) * pi * sin(moon_radius) ** 2)
        moon_lux *= eclipsed(
            _angle(heavens.antisun_direction, heavens.moon_direction), moon_radius, umbra, penumbra
        )
        full = moon_illuminance(0.0, heavens.moon_distance, distance) / (pi * sin(moon_radius) ** 2)
        shine = full * earthshine(heavens.moon_phase, heavens.moon_distance)
    elevation = asin(float(heavens.sun_direction[2]))
    floor = moon_lux * max(float(heavens.moon_direction[2]), 0.05) + pi * sky.night_glow
    return {
        "sun_direction": heavens.sun_direction,
        "sun_radius": radius,
        "sun_illuminance": sun * (1 - covered + _BEYOND_SHADOW * covered),
        "table_scale": table_scale(elevation, altitude, planet.radius, floor),
        "sun_luminance": sun_luminance if sky.sun.disc else np.zeros(3),
        "sun_limb": limb,
        "refraction": heavens.refraction,
        "moon_direction": heavens.moon_direction,
        "moon_radius": moon_radius,
        "moon_illuminance": moon_lux * MOON_COLOUR,
        "moon_earthshine": shine * MOON_COLOUR * _EARTH_TINT,
        "moon_luminance": face * MOON_COLOUR,
        "moon_shadow": umbra,
        "moon_sun_direction": heavens.moon_sun_direction,
        "moon_penumbra": penumbra,
        "antisun_direction": heavens.antisun_direction,
        "stars": float(sky.stars),
        "airglow": sky.night_glow * _AIRGLOW_TINT,
        "moon_from_world": heavens.moon_from_local,
        "equatorial_from_world": heavens.equatorial_from_local,
    }


def moon_illuminance(phase: float, distance: float, sun_au: float = 1.0) -> float:
    """Lux of the moon above the air, at normal incidence.

    Parameters
    ----------
    phase : float
        Sun-moon-observer angle, radians, 0 for full. Allen's law is drawn from 0 to 150 degrees.
    distance : float
        Of the moon, metres.
    sun_au : float
        Of the sun, au.
    """
    a = min(degrees(phase), 178.0)
    magnitude = -12.73 + 0.026 * a + 4e-9 * a**4
    return MAGNITUDE_ZERO_LUX * 10 ** (-0.4 * magnitude) * (_MOON_MEAN_DISTANCE / distance) ** 2 / sun_au**2


def lommel_seeliger_phase(phase: float) -> float:
    """What a Lommel-Seeliger sphere sends back at a phase angle (radians), over what it sends at 0."""
    a = min(max(phase, 1e-4), radians(178.0))
    return 1 - sin(a / 2) * tan(a / 2) * log(1 / tan(a / 4))


def earthshine(phase: float, distance: float) -> float:
    """Illuminance of the moon's near side by the Earth over that by the sun.

    A Lambert sphere of geometric albedo 0.37; its phase is the supplement of the moon's.
    """
    earth = pi - phase
    return 0.37 * (EARTH_RADIUS / distance) ** 2 * (sin(earth) + (pi - earth) * cos(earth)) / pi


def earth_shadow(moon_distance: float, sun_distance: float) -> tuple[float, float]:
    """Angular radii of umbra and penumbra at the moon, radians; the air adds 2 percent."""
    parallax = 1.02 * EARTH_RADIUS / moon_distance
    sun = SUN_RADIUS / sun_distance
    return parallax + EARTH_RADIUS / sun_distance - sun, parallax + EARTH_RADIUS / sun_distance + sun


def eclipsed(separation: float, radius: float, umbra: float, penumbra: float) -> float:
    """What the Earth's shadow leaves of moonlight, 1 outside: mean over the disc of the law in moon.wesl."""
    if separation > penumbra + radius:
        return 1.0
    chord = (np.arange(32) + 0.5) / 16 - 1
    lit = np.clip((np.abs(separation + chord * radius) - umbra) / (penumbra - umbra), 0.0, 1.0)
    lit = lit * lit * (3 - 2 * lit)
    weight = np.sqrt(1 - chord * chord)
    return float(np.sum(weight * (lit + _UMBRA_GLOW * (1 - lit))) / np.sum(weight))


def covered_fraction(separation: float, radius: float, cover: float) -> float:
    """Fraction of a disc's area behind another disc; angular radii and separation in radians."""
    if separation >= radius + cover:
        return 0.0
    if separation <= abs(radius - cover):
        return min((cover / radius) ** 2, 1.0)
    d2, r2, c2 = separation**2, radius**2, cover**2
    a = acos(max(min((d2 + r2 - c2) / (2 * separation * radius), 1.0), -1.0))
    b = acos(max(min((d2 + c2 - r2) / (2 * separation * cover), 1.0), -1.0))
    return (r2 * (a - sin(a) * cos(a)) + c2 * (b - sin(b) * cos(b))) / (pi * r2)


def twilight_lux(elevation: float) -> float:
    """Lux on level ground from a clear sky and the sun at an elevation (radians)."""
    return 10 ** float(np.interp(degrees(elevation), _GROUND_ELEVATION, _GROUND_LUX))


def table_scale(elevation: float, altitude: float, planet_radius: float, floor: float) -> float:
    """Scale under which the sky's luminance fits a half float, from noon to a moonless night.

    Five over the brightest ground in sight: the mean of the sky then stands near 1, four decades under the
    format's end and above its subnormal numbers. From a height one sees air that has more sun than the
    ground below: the horizon's dip, and beyond it the air that still stands in the light, count as if the
    sun stood higher.

    Parameters
    ----------
    elevation : float
        The sun's at the camera, radians.
    altitude, planet_radius : float
        Of the camera and of the sphere, metres.
    floor : float
        Lux on the ground from moon and airglow.
    """
    altitude = max(altitude, 0.0)
    dip = acos(planet_radius / (planet_radius + altitude))
    beyond = acos(planet_radius / (planet_radius + 6e4)) * (1 - exp(-altitude / 3e4))
    return 5.0 / (twilight_lux(min(elevation + dip + beyond, pi / 2)) + floor)


def _angle(a: np.ndarray, b: np.ndarray) -> float:
    (ax, ay, az), (bx, by, bz) = a.tolist(), b.tolist()
    cross = sqrt((ay * bz - az * by) ** 2 + (az * bx - ax * bz) ** 2 + (ax * by - ay * bx) ** 2)
    return atan2(cross, ax * bx + ay * by + az * bz)
