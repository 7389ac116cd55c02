"""Where things stand in the sky, against pvlib's SPA, astronomy-engine itself and what almanacs print."""

from datetime import UTC, datetime, timedelta
from math import asin, cos, degrees, hypot, radians, sin

import astronomy
import numpy as np
import pytest

from fallstreak.sky.ephemeris import (
    AU,
    J2000,
    NODE_DAYS,
    Ephemeris,
    _interpolate,
    _node,
    days_since_j2000,
    elevation_azimuth,
    refract,
)

START, DAYS = datetime(1950, 1, 1, tzinfo=UTC), 36524


def separation(a, b):
    return degrees(2 * asin(min(np.linalg.norm(np.asarray(a) - np.asarray(b)) / 2, 1.0)))


def direction(elevation, azimuth):
    return np.array(
        [cos(elevation) * sin(azimuth), cos(elevation) * cos(azimuth), sin(elevation)], dtype=np.float64
    )


def cases(count, seed):
    rng = np.random.default_rng(seed)
    for _ in range(count):
        moment = START + timedelta(days=float(rng.uniform(0, DAYS)))
        yield moment, float(rng.uniform(-89, 89)), float(rng.uniform(-180, 180))


def test_sun_agrees_with_spa():
    import pandas
    import pvlib

    worst = 0.0
    for moment, latitude, longitude in cases(60, 1):
        index = pandas.DatetimeIndex([moment])
        spa = pvlib.solarposition.spa_python(index, latitude, longitude, delta_t=None).iloc[0]
        theirs = direction(radians(spa["elevation"]), radians(spa["azimuth"]))
        ours = Ephemeris(radians(latitude), radians(longitude), refraction=False).at(moment).sun_direction
        worst = max(worst, separation(ours, theirs))
    assert worst < 0.002, "issue: 0.02 degrees"


@pytest.mark.parametrize("name", ["Sun", "Moon", "Venus", "Jupiter"])
def test_interpolation_and_topocentre_agree_with_the_library(name):
    for moment, latitude, longitude in cases(12, 2):
        time = astronomy.Time(days_since_j2000(moment))
        observer = astronomy.Observer(latitude, longitude, 0.0)
        equator = astronomy.Equator(getattr(astronomy.Body, name), time, observer, True, True)
        horizon = astronomy.Horizon(time, observer, equator.ra, equator.dec, astronomy.Refraction.Airless)
        sky = Ephemeris(radians(latitude), radians(longitude), refraction=False).at(moment)
        ours = {"Sun": sky.sun_direction, "Moon": sky.moon_direction}
        ours |= dict(zip(sky.planet_names, sky.planet_directions, strict=True))
        theirs = direction(radians(horizon.altitude), radians(horizon.azimuth))
        assert separation(ours[name], theirs) < 0.002


def test_the_grid_is_absolute_and_interpolation_is_exact_enough():
    for days in (-9000.101, 8765.4321, 12345.9):
        row = _interpolate("earth", days)
        true = astronomy.GeoMoon(astronomy.Time(days))
        moon = np.array([true.x, true.y, true.z])
        assert np.linalg.norm(row[13:16] - moon) / np.linalg.norm(moon) < radians(1e-4)
    index = 4321
    assert np.array_equal(_interpolate("earth", index * NODE_DAYS), _node("earth", index))


def test_answers_do_not_depend_on_what_was_asked_before():
    moment = datetime(2031, 7, 2, 3, 4, 5, tzinfo=UTC)
    place = Ephemeris(0.5, 1.0)
    first = place.at(moment)
    for hours in range(0, 4000, 7):
        place.at(moment + timedelta(hours=hours))
    again = place.at(moment)
    assert np.array_equal(first.moon_direction, again.moon_direction)
    assert np.array_equal(first.equatorial_from_local, again.equatorial_from_local)


def test_motion_across_nodes_is_smooth():
    node = J2000 + timedelta(days=9000 * NODE_DAYS)
    place = Ephemeris(0.6, -1.7)
    steps = [place.at(node + timedelta(seconds=60 * k)) for k in range(-3, 4)]
    for name in ("sun_direction", "moon_direction"):
        track = np.array([getattr(sky, name) for sky in steps])
        assert np.abs(np.diff(track, n=3, axis=0)).max() < 1e-6


def test_moon_phases_of_2024():
    place = Ephemeris(0.0, 0.0)
    full = place.at(datetime(2024, 3, 25, 7, 0, tzinfo=UTC))  # almanac: full moon 07:00 UT
    assert full.moon_fraction > 0.999
    new = place.at(datetime(2024, 4, 8, 18, 21, tzinfo=UTC))  # almanac: new moon 18:21 UT
    assert new.moon_fraction < 1e-3
    quarter = place.at(datetime(2024, 4, 15, 19, 13, tzinfo=UTC))  # almanac: first quarter 19:13 UT
    assert quarter.moon_fraction == pytest.approx(0.5, abs=0.01)


def test_bright_limb_points_to_the_sun():
    # Waxing crescent over the western horizon, 45 north in spring: the lit side looks down, right.
    sky = Ephemeris(radians(45), 0.0).at(datetime(2024, 4, 10, 19, 30, tzinfo=UTC))
    assert 90 < degrees(sky.moon_bright_limb) < 180
    assert sky.moon_from_local @ sky.moon_sun_direction @ np.array([0, 1, 0]) > 0  # east on the moon: waxing


def test_the_moon_shows_its_near_side():
    rng = np.random.default_rng(5)
    place = Ephemeris(radians(30), radians(20))
    worst = 0.0
    for _ in range(40):
        sky = place.at(START + timedelta(days=float(rng.uniform(0, DAYS))))
        axes = sky.moon_from_local
        assert np.allclose(axes @ axes.T, np.eye(3), atol=1e-5)
        facing = axes @ -sky.moon_direction
        worst = max(worst, degrees(np.arccos(facing[0])))
    assert 3 < worst < 11, "libration: at most 7.9 by 6.9 degrees, and a degree of parallax"


def test_polaris_stands_at_the_latitude():
    polaris = direction_equatorial(2.5303, 89.2641)
    for latitude in (20.0, 52.0, 70.0):
        for hour in range(0, 24, 5):
            sky = Ephemeris(radians(latitude), 0.3).at(datetime(2024, 1, 1, hour, tzinfo=UTC))
            elevation, azimuth = elevation_azimuth(sky.equatorial_from_local.T @ polaris)
            assert abs(degrees(elevation) - latitude) < 0.75
            assert min(azimuth, 2 * np.pi - azimuth) < radians(2.5)


def test_sirius_and_orion_in_a_winter_night():
    # Greenwich, 2024-01-15 22:00 UT, apparent places computed with the almanac's own steps for the day.
    time = astronomy.Time.Make(2024, 1, 15, 22, 0, 0.0)
    observer = astronomy.Observer(51.4769, 0.0, 0)
    sky = Ephemeris(radians(51.4769), 0.0, refraction=False).at(datetime(2024, 1, 15, 22, tzinfo=UTC))
    for hours, degree in ((6.75248, -16.7161), (5.91953, 7.4071), (5.24230, -8.2016)):
        star = direction_equatorial(hours, degree)
        turned = astronomy.RotateVector(astronomy.Rotation_EQJ_HOR(time, observer), vector(star, time))
        ours = sky.equatorial_from_local.T @ star
        assert separation(ours, [-turned.y, turned.x, turned.z]) < 0.001
    # On Greenwich's meridian at 22 h the sidereal time is 5 h 41 min: Sirius (6 h 45 min) stands 16 degrees
    # before it, and Orion's belt has just come to it.
    sirius = sky.equatorial_from_local.T @ direction_equatorial(6.75248, -16.7161)
    elevation, azimuth = (degrees(v) for v in elevation_azimuth(sirius))
    assert elevation == pytest.approx(20.2, abs=0.2) and azimuth == pytest.approx(163, abs=0.5)
    belt = sky.equatorial_from_local.T @ direction_equatorial(5.60356, -1.2019)
    assert degrees(elevation_azimuth(belt)[1]) == pytest.approx(180, abs=3)


def vector(xyz, time):
    return astronomy.Vector(*(float(c) for c in xyz), time)


def direction_equatorial(hours, degree):
    ascension, declination = radians(15 * hours), radians(degree)
    return np.array([cos(declination) * cos(ascension), cos(declination) * sin(ascension), sin(declination)])


def test_refraction():
    def lift(degree, strength=1.0):
        up = refract(direction(radians(degree), 1.0), strength)
        return degrees(asin(up[2])) - degree

    assert lift(0.0) * 60 == pytest.approx(29.0, abs=1.5)  # from true elevation 0
    assert lift(-0.5667) * 60 == pytest.approx(34.0, abs=2.0)  # the sun's centre on the horizon
    assert lift(45.0) * 60 == pytest.approx(1.0, abs=0.05)
    assert lift(90.0) == pytest.approx(0.0, abs=1e-6)
    assert lift(-6.0) == pytest.approx(0.0, abs=1e-12)
    assert lift(10.0, 0.0) == pytest.approx(0.0, abs=1e-12)
    elevations = np.arange(-10, 90, 0.05)
    lifted = [e + lift(e) for e in elevations]
    assert np.all(np.diff(lifted) > 0), "order of heights is kept"
    up = refract(direction(radians(3.0), 2.0))
    turned = refract(np.array([0.0, 0.0, 1.0]), 1.0, np.array([0.0, 1.0, 0.0]))  # z lies on that horizon
    assert degrees(asin(turned[1])) * 60 == pytest.approx(29.0, abs=1.5) and turned[0] == 0.0
    assert np.linalg.norm(up) == pytest.approx(1.0)


def test_refraction_ends_above_the_air():
    moment = datetime(2024, 6, 1, 4, tzinfo=UTC)
    ground, orbit = (Ephemeris(0.6, 0.1).at(moment, (0, 0, z)).refraction for z in (0.0, 400e3))
    assert ground == 1.0 and orbit < 1e-20


def test_sun_from_the_observer_and_its_size():
    near = Ephemeris(0.0, 0.0).at(datetime(2024, 1, 3, 0, 38, tzinfo=UTC))
    far = Ephemeris(0.0, 0.0).at(datetime(2024, 7, 5, 5, 6, tzinfo=UTC))
    assert near.sun_distance / AU == pytest.approx(0.98330, abs=1e-4)
    assert far.sun_distance / AU == pytest.approx(1.01672, abs=1e-4)
    assert degrees(near.sun_radius) * 3600 == pytest.approx(976, abs=1.5)


def test_a_time_without_zone_is_refused():
    with pytest.raises(ValueError, match="zone"):
        Ephemeris(0.0, 0.0).at(datetime(2024, 1, 1))


def test_horizontal_length():
    sky = Ephemeris(0.2, 0.4).at(datetime(2020, 5, 5, 5, tzinfo=UTC))
    assert hypot(*sky.sun_direction) == pytest.approx(1.0)
    assert np.allclose(np.linalg.norm(sky.planet_directions, axis=1), 1.0)
