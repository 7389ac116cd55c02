"""The lights above the air, against published magnitudes and illuminances."""

from datetime import UTC, datetime
from math import degrees, pi, radians

import numpy as np
import pytest

from fallstreak.sky.colour import star_temperature, temperature_colour
from fallstreak.sky.ephemeris import Ephemeris
from fallstreak.sky.light import (
    LIGHT,
    covered_fraction,
    eclipsed,
    light_values,
    lommel_seeliger_phase,
    moon_illuminance,
    table_scale,
    twilight_lux,
)
from fallstreak.sky.spectrum import LUMINANCE, SUN_ILLUMINANCE
from fallstreak.world import World

SUN_LUX = SUN_ILLUMINANCE @ LUMINANCE


def values(moment, latitude=33.2, longitude=-98.1, altitude=0.0, **changes):
    world = World(**changes)
    place = Ephemeris(radians(latitude), radians(longitude), planet=world.planet.preset)
    return light_values(world, place.at(moment), altitude)


def test_every_field_is_filled():
    assert len(LIGHT.pack(**values(datetime(2024, 6, 1, 17, tzinfo=UTC)))) == LIGHT.size


def test_sunlight_follows_the_distance():
    january = values(datetime(2024, 1, 3, 18, tzinfo=UTC))["sun_illuminance"] @ LUMINANCE
    july = values(datetime(2024, 7, 5, 18, tzinfo=UTC))["sun_illuminance"] @ LUMINANCE
    assert january / july == pytest.approx((1.0167 / 0.9833) ** 2, rel=1e-3)
    assert 128e3 < SUN_LUX < 134e3


def test_mars_has_less_than_half_the_light():
    mars = values(datetime(2024, 5, 8, 12, tzinfo=UTC), planet={"preset": "mars"})  # perihelion: 1.381 au
    assert mars["sun_illuminance"] @ LUMINANCE == pytest.approx(SUN_LUX / 1.3815**2, rel=3e-3)
    assert mars["moon_radius"] == 0.0 and not np.any(mars["moon_illuminance"])


def test_full_moon():
    assert moon_illuminance(0.0, 3.844e8) == pytest.approx(0.314, abs=0.01)  # above the air
    # Under clear air at the zenith (visual transmittance .84 to .88): the almanac's .25 to .3 lx.
    assert 0.25 < 0.86 * moon_illuminance(radians(2), 3.844e8) < 0.30
    # Half moon is about a tenth of full (Allen).
    assert moon_illuminance(pi / 2, 3.844e8) / moon_illuminance(0, 3.844e8) == pytest.approx(0.09, abs=0.015)


def test_the_moons_face_adds_up_to_its_illuminance():
    """Integrate moon.wesl's shading over a sphere at several phases."""
    n = 1200
    x, y = np.meshgrid((np.arange(n) + 0.5) / n * 2 - 1, (np.arange(n) + 0.5) / n * 2 - 1)
    inside = x * x + y * y < 1
    z = np.sqrt(np.maximum(1 - x * x - y * y, 0))
    for phase in np.radians([5, 40, 90, 130]):
        lit = np.maximum(x * np.sin(phase) + z * np.cos(phase), 0)
        shading = np.where(inside, 2 * lit / (lit + z + 1e-9), 0)
        mean = shading.sum() / inside.sum()
        assert mean == pytest.approx(lommel_seeliger_phase(phase), rel=5e-3)


def test_solar_eclipse():
    assert covered_fraction(0.02, 0.0046, 0.0046) == 0.0
    assert covered_fraction(0.0, 0.0046, 0.0047) == 1.0
    assert covered_fraction(0.0, 0.0046, 0.0043) == pytest.approx((43 / 46) ** 2)
    assert covered_fraction(0.0046, 0.0046, 0.0046) == pytest.approx(0.391, abs=0.001)  # lens of equal discs
    # Mazatlan, 2024-04-08: total from 18:07:24 to 18:11:44 UT.
    total = values(datetime(2024, 4, 8, 18, 9, 35, tzinfo=UTC), 23.25, -106.42)
    assert 1 < total["sun_illuminance"] @ LUMINANCE < 10  # lux of totality
    before = values(datetime(2024, 4, 8, 18, 5, 0, tzinfo=UTC), 23.25, -106.42)
    assert 0 < before["sun_illuminance"] @ LUMINANCE < 0.1 * SUN_LUX


def test_lunar_eclipse():
    total = values(datetime(2025, 3, 14, 6, 59, tzinfo=UTC))  # greatest eclipse 06:58:48 UT, umbral 1.178
    before = values(datetime(2025, 3, 14, 3, 30, tzinfo=UTC))
    ratio = (total["moon_illuminance"] @ LUMINANCE) / (before["moon_illuminance"] @ LUMINANCE)
    assert 1e-5 < ratio < 2e-3
    assert degrees(total["moon_shadow"]) == pytest.approx(0.65, abs=0.08)
    assert eclipsed(0.05, 0.0046, 0.012, 0.021) == 1.0


def test_twilight_table():
    # references/atmosphere.md: civil twilight ends with 3.5 to 2 lx, astronomical with about 6e-4 lx.
    assert 400 < twilight_lux(radians(-0.833)) < 600
    assert 2.0 < twilight_lux(radians(-6)) < 3.5
    assert twilight_lux(radians(-18)) == pytest.approx(6.5e-4, rel=0.05)
    elevations = np.radians(np.arange(-30, 90, 0.25))
    assert np.all(np.diff([twilight_lux(e) for e in elevations]) > 0)


def test_table_scale_is_smooth_and_keeps_half_floats_in_range():
    floor = pi * 1.5e-4
    elevations = np.radians(np.arange(-60, 91, 0.25))
    scales = np.array([table_scale(e, 0.0, 6.36e6, floor) for e in elevations])
    assert np.abs(np.diff(np.log(scales))).max() < 0.3
    # A clear noon: 3e3 cd/m2 of blue, 1e6 beside the sun. A moonless night: 1.5e-4.
    assert 3e3 * scales[-1] > 6e-2 and 1e6 * scales[-1] < 65504
    assert 6e-2 < 1.5e-4 * scales[0] < 100
    # From 400 km the lit limb is in sight long after sunset: the scale must not be the night's.
    assert table_scale(radians(-25), 400e3, 6.36e6, floor) < 1e-2


def test_colours():
    sun = temperature_colour(5772.0)
    assert sun @ LUMINANCE == pytest.approx(1.0, abs=1e-3)
    assert sun[0] > sun[1] > sun[2]
    white = temperature_colour(6504.0)
    assert np.abs(white - 1).max() < 0.06
    assert np.all(temperature_colour(np.linspace(1000, 40000, 50)) >= 0)
    assert star_temperature(0.65) == pytest.approx(5772, rel=0.02)  # the sun
    assert star_temperature(0.0) == pytest.approx(9600, rel=0.07)  # Vega
    assert star_temperature(1.85) == pytest.approx(3500, rel=0.07)  # Betelgeuse
