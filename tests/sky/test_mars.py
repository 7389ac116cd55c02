"""The sky of Mars: the published solar time against the vectors from which the sky is drawn."""

from datetime import UTC, datetime, timedelta
from math import cos, degrees, radians, sin

import numpy as np
import pytest

from fallstreak.sky.ephemeris import AU, Ephemeris
from fallstreak.sky.mars import mars_time


def test_worked_example():
    # NASA GISS, Mars24 "Algorithm and worked examples": 2000-01-06 00:00:00 UTC.
    time = mars_time(datetime(2000, 1, 6, tzinfo=UTC), 0.0, 0.0)
    assert degrees(time.solar_longitude) == pytest.approx(277.18758, abs=1e-3)
    assert time.mean_time == pytest.approx(23.99425, abs=3e-4)
    assert time.sun_distance == pytest.approx(1.39358, abs=2e-4)


def test_formula_and_vectors_agree():
    rng = np.random.default_rng(3)
    worst = far = 0.0
    for _ in range(60):
        moment = datetime(1970, 1, 1, tzinfo=UTC) + timedelta(days=float(rng.uniform(0, 365.25 * 70)))
        latitude, longitude = float(rng.uniform(-1.5, 1.5)), float(rng.uniform(-3.1, 3.1))
        time = mars_time(moment, latitude, longitude)
        e, a = time.sun_elevation, time.sun_azimuth
        sky = Ephemeris(latitude, longitude, planet="mars").at(moment)
        formula = np.array([cos(e) * sin(a), cos(e) * cos(a), sin(e)])
        worst = max(worst, degrees(np.linalg.norm(formula - sky.sun_direction)))
        far = max(far, abs(time.sun_distance - sky.sun_distance / AU))
    assert worst < 0.03
    assert far < 1e-3


def test_mars_has_no_moon_and_sees_the_earth():
    sky = Ephemeris(0.1, 0.2, planet="mars").at(datetime(2021, 2, 18, 20, 55, tzinfo=UTC))
    assert sky.moon_radius == 0.0
    assert sky.refraction == 0.0
    assert "Earth" in sky.planet_names and "Mars" not in sky.planet_names
    earth = sky.planet_magnitudes[sky.planet_names.index("Earth")]
    assert -3.5 < earth < 2.0


def test_the_pole_star_of_mars():
    # The north pole of Mars stands near Deneb and Alderamin: right ascension 317.68, declination 52.89 (IAU).
    ascension, declination = radians(317.68), radians(52.89)
    pole = [cos(declination) * cos(ascension), cos(declination) * sin(ascension), sin(declination)]
    sky = Ephemeris(radians(70), 0.0, planet="mars").at(datetime(2024, 1, 1, tzinfo=UTC))
    local = sky.equatorial_from_local.T @ np.array(pole)
    assert degrees(np.arcsin(local[2])) == pytest.approx(70, abs=0.1)
