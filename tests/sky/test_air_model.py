"""The air on the CPU against closed forms and published numbers (references: Bruneton 2017's clear air)."""

from __future__ import annotations

import numpy as np
import pytest

from fallstreak.sky import model, spectrum
from fallstreak.sky.air import Air
from fallstreak.world import World

ZENITH = np.array([0, 30, 60, 75, 80, 85, 88, 90.0])
TRANSMITTANCE = np.array([
    [0.94038, 0.86767, 0.76242], [0.93152, 0.84891, 0.73118], [0.88483, 0.75395, 0.58245],
    [0.79249, 0.58510, 0.35671], [0.71303, 0.45951, 0.22177], [0.54373, 0.24956, 0.06368],
    [0.33086, 0.08531, 0.00616], [0.10644, 0.00958, 0.00005],
])  # fmt: skip
RAYLEIGH_PATH = np.array([7.996, 9.229, 15.932, 30.381, 44.382, 81.080, 149.24, 282.81])


def only(air: Air, part: str) -> Air:
    zero = (0.0, 0.0, 0.0)
    parts = {
        "rayleigh": {"mie_extinction": zero, "mie_scattering": zero, "ozone_absorption": zero},
        "mie": {"rayleigh_scattering": zero, "ozone_absorption": zero},
        "ozone": {"rayleigh_scattering": zero, "mie_extinction": zero, "mie_scattering": zero},
    }
    return Air(**{**air.__dict__, **parts[part]})


def test_transmittance_of_the_clear_air():
    found = model.transmittance(Air(), 0.0, np.cos(np.radians(ZENITH)))
    np.testing.assert_allclose(found, TRANSMITTANCE, rtol=2e-4, atol=6e-6)


def test_rayleigh_path_and_chapman():
    air = only(Air(), "rayleigh")
    depth = model.optical_depth(air, 0.0, np.cos(np.radians(ZENITH)))[:, 1] / air.rayleigh_scattering[1]
    np.testing.assert_allclose(depth / 1e3, RAYLEIGH_PATH, rtol=1e-4)
    # Chapman's grazing function for an endless exponential air: √(π x / 2) (1 + 3 / 8x)
    x = air.planet_radius / air.rayleigh_scale_height
    grazing = np.sqrt(np.pi * x / 2) * (1 + 3 / (8 * x)) * air.rayleigh_scale_height
    assert depth[-1] == pytest.approx(grazing, rel=1.5e-3)


@pytest.mark.parametrize(
    ("part", "expected"),
    [
        ("rayleigh", (0.04639, 0.10840, 0.26465)),
        ("mie", (0.005328,) * 3),
        ("ozone", (0.00975, 0.02821, 0.00128)),
    ],
)
def test_vertical_optical_depths(part, expected):
    np.testing.assert_allclose(
        model.optical_depth(only(Air(), part), 0.0, 1.0), expected, rtol=5e-4, atol=5e-6
    )


def test_vertical_column_in_closed_form():
    air, (low, high) = only(Air(), "rayleigh"), (1.2e3, 17e3)
    k = air.rayleigh_scale_height
    depth = model.optical_depth(air, low, 1.0, high - low)[1] / air.rayleigh_scattering[1]
    assert depth == pytest.approx(k * (np.exp(-low / k) - np.exp(-high / k)), rel=1e-6)


def test_geometry_holds_its_digits():
    air = Air()
    h = np.array([0.0, 1e-3, 1.7, 1e3, 59e3, 400e3, 36e6])
    t = 123.456
    # straight up altitude grows by the distance, and along the horizon by t² / 2r
    np.testing.assert_allclose(model.altitude_along(air, h, 1.0, t) - h, t, rtol=1e-9, atol=1e-7)
    rise = model.altitude_along(air, 1.7, 0.0, t) - 1.7
    assert rise == pytest.approx(t * t / (2 * (air.planet_radius + 1.7)), rel=1e-5)
    np.testing.assert_allclose(model.distance_to_ground(air, h[1:], -1.0), h[1:], rtol=1e-9)
    horizon = model.cos_horizon(air, h[1:])
    assert np.isfinite(model.distance_to_ground(air, h[1:], horizon - 1e-6)).all()
    assert np.isinf(model.distance_to_ground(air, h[1:], horizon + 1e-6)).all()
    enter, leave = model.span_in_air(air, 400e3, -1.0)
    assert (enter, leave - enter) == pytest.approx((340e3, 2 * (air.planet_radius + 60e3)))
    assert model.span_in_air(air, 400e3, 0.0) == (0.0, 0.0)


def sphere(count: int = 100_000):
    """Cosines and weights of an integral over the cosine, by the midpoint rule in the angle."""
    angle = (np.arange(count) + 0.5) * np.pi / count
    return np.cos(angle), np.sin(angle) * np.pi / count


@pytest.mark.parametrize("g", [0.0, 0.3, 0.8, 0.93])
def test_phase_functions_hold_all_light_and_their_mean_cosine(g):
    x, w = sphere()
    for phase, mean in (
        (model.phase_henyey_greenstein(x, g), g),
        (model.phase_cornette_shanks(x, g), 3 * g * (4 + g * g) / (5 * (2 + g * g))),
    ):
        assert 2 * np.pi * np.sum(w * phase) == pytest.approx(1.0, rel=1e-6)
        assert 2 * np.pi * np.sum(w * phase * x) == pytest.approx(mean, abs=1e-6)
    assert 2 * np.pi * np.sum(w * model.phase_rayleigh(x)) == pytest.approx(1.0)


def test_the_dust_of_mars_keeps_its_mean_cosine_and_shines_blue_ahead():
    world = World(planet={"preset": "mars"})
    air = Air.of(world)
    x, w = sphere()
    phase = model.phase_aerosol(air, x)
    np.testing.assert_allclose(2 * np.pi * w @ phase, 1.0, rtol=1e-6)
    given = np.interp(spectrum.BANDS, spectrum.GIVEN[::-1], world.sky.mie_g[::-1])
    np.testing.assert_allclose(2 * np.pi * (w * x) @ phase, given, atol=1e-6)
    ahead = model.phase_aerosol(air, 1.0)
    assert ahead[2] > 1.5 * ahead[0]


def test_transmittance_falls_with_distance_and_air_and_never_exceeds_one():
    air = Air()
    rng = np.random.default_rng(1)
    h, mu = rng.uniform(0, 60e3, 200), rng.uniform(-1, 1, 200)
    before = np.ones((200, 3))
    for distance in (1.0, 1e2, 1e4, 1e5, 5e5):
        now = model.transmittance(air, h, mu, distance)
        assert (now <= before + 1e-12).all() and (now >= 0).all()
        before = now
    up = model.transmittance(air, np.linspace(0, 60e3, 50), 0.2)
    assert (np.diff(up, axis=0) >= -1e-12).all()


def test_multiple_scattering_keeps_energy():
    """A white ground under a white, thick gas sends back all light: what a place gets cannot exceed that."""
    zero = (0.0, 0.0, 0.0)
    air = Air(ozone_absorption=zero, mie_scattering=zero, mie_extinction=zero, ground_albedo=(1.0,) * 3)
    spread = model.multiple_scattering(air, np.array([0.0, 5e3, 30e3]), 1.0)
    assert (spread > 0).all() and (spread < 1 / np.pi).all()
    darker = model.multiple_scattering(Air(), np.array([0.0, 5e3, 30e3]), 1.0)
    assert (darker < spread).all()


def test_three_bands_stand_for_the_spectrum():
    # Rayleigh's law is kept, ozone follows its own band, whose middle 680 and 550 nm both miss
    np.testing.assert_allclose(
        spectrum.at_bands(1e-5 * (spectrum.GIVEN / 550) ** -4), 1e-5 * (spectrum.BANDS / 550) ** -4, rtol=1e-9
    )
    ozone = spectrum.ozone_at_bands(Air().ozone_absorption)
    np.testing.assert_allclose(ozone / Air().ozone_absorption[1], (0.994, 0.883, 0.062), rtol=0.02)
    assert spectrum.at_bands((0.0, 0.0, 0.0)).tolist() == [0.0] * 3


def test_the_sun_above_the_air():
    """133 klx by the reference spectrum (128 in older tables), white a little warmer than D65."""
    lux = float(spectrum.SUN_ILLUMINANCE @ spectrum.LUMINANCE)
    assert lux == pytest.approx(133e3, rel=0.01)
    assert lux == pytest.approx(128e3, rel=0.05)
    r, g, b = spectrum.SUN_ILLUMINANCE
    assert r > g > b > 0.8 * r


def test_twilight_illuminance():
    """Level illuminance by the clear sky when the sun is down, within a factor of 2 of the almanac's."""
    air = Air.of(World())
    i = np.arange(64) + 0.5
    mu, azimuth = np.sqrt(i / 64), np.pi * (1 + 5**0.5) * i
    altitude = np.linspace(0, 1, 8) ** 2 * air.top_height
    for elevation, expected in ((-0.8, 500.0), (-3.0, 80.0)):
        mu_sun = np.sin(np.radians(elevation))
        across = np.sqrt((1 - mu**2) * (1 - mu_sun**2)) * np.cos(azimuth)
        grid = np.sin(np.radians(np.arange(-20, 15, 2.0)))
        table = model.multiple_scattering(air, altitude[:, None], grid[None], directions=32, steps=12)

        def spread(h, s, table=table, grid=grid):
            from scipy.interpolate import RegularGridInterpolator

            of = RegularGridInterpolator(
                (np.sqrt(altitude), grid), table, bounds_error=False, fill_value=None
            )
            return of((np.sqrt(np.clip(h, 0, None)), np.clip(s, grid[0], grid[-1])))

        seen, _ = model.radiance(
            air, np.full(64, 2.0), mu, mu_sun, mu * mu_sun + across, steps=40, multiple=spread
        )
        lux = (
            np.pi * seen.mean(axis=0) * spectrum.SUN_ILLUMINANCE * spectrum.SKY_RESPONSE @ spectrum.LUMINANCE
        )
        assert expected / 2 < lux < expected * 2, (elevation, lux)
