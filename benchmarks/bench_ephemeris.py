"""The heavens: the sun against NREL's SPA, Mars against Mars24's formula, and what a frame costs."""

import time
from datetime import UTC, datetime, timedelta
from math import asin, cos, degrees, radians, sin

import astronomy
import numpy as np

import fallstreak as fs
from fallstreak.sky.ephemeris import Ephemeris, days_since_j2000
from fallstreak.sky.light import light_values
from fallstreak.sky.mars import mars_time

CASES = 1000
START, DAYS = datetime(1950, 1, 1, tzinfo=UTC), 36524  # to the end of 2049


def run(report):
    rng = np.random.default_rng(2024)
    moments = [START + timedelta(days=float(d)) for d in rng.uniform(0, DAYS, CASES)]
    latitudes, longitudes = rng.uniform(-89.5, 89.5, CASES), rng.uniform(-180, 180, CASES)
    places = list(zip(moments, latitudes, longitudes, strict=True))
    how = f"{CASES} random times 1950-2050 and places, geometric direction of the sun's centre"
    report.add("sun direction against SPA, worst", _against_spa(places), "deg", goal="<= 0.02", how=how)
    worst = max(_moon_error(*place) for place in places[:300])
    how = "300 of the same; our interpolation, rotation and parallax against the library's own"
    report.add("moon direction against astronomy-engine, worst", worst, "deg", goal="<= 0.002", how=how)
    worst = max(_mars_error(*place) for place in places[:300])
    how = "300 of the same; IAU pole and VSOP87 against Allison and McEwen 2000"
    report.add("sun on Mars against Mars24's formula, worst", worst, "deg", goal="<= 0.03", how=how)
    report.add("light of a frame", _cost(), "ms", goal="<= 0.3", how="ephemeris and sky.light, median of 500")


def _direction(elevation, azimuth):
    return np.array([cos(elevation) * sin(azimuth), cos(elevation) * cos(azimuth), sin(elevation)])


def _separation(a, b):
    return degrees(2 * asin(min(float(np.linalg.norm(a - b)) / 2, 1.0)))


def _against_spa(places):
    import pandas
    import pvlib

    worst = 0.0
    for moment, latitude, longitude in places:
        index = pandas.DatetimeIndex([moment])
        spa = pvlib.solarposition.spa_python(index, latitude, longitude, delta_t=None).iloc[0]
        theirs = _direction(radians(spa["elevation"]), radians(spa["azimuth"]))
        sky = Ephemeris(radians(latitude), radians(longitude), refraction=False).at(moment)
        worst = max(worst, _separation(sky.sun_direction, theirs))
    return worst


def _moon_error(moment, latitude, longitude):
    when = astronomy.Time(days_since_j2000(moment))
    observer = astronomy.Observer(latitude, longitude, 0.0)
    equator = astronomy.Equator(astronomy.Body.Moon, when, observer, True, True)
    horizon = astronomy.Horizon(when, observer, equator.ra, equator.dec, astronomy.Refraction.Airless)
    sky = Ephemeris(radians(latitude), radians(longitude), refraction=False).at(moment)
    return _separation(sky.moon_direction, _direction(radians(horizon.altitude), radians(horizon.azimuth)))


def _mars_error(moment, latitude, longitude):
    place = radians(latitude), radians(longitude)
    formula = mars_time(moment, *place)
    sky = Ephemeris(*place, planet="mars").at(moment)
    return _separation(sky.sun_direction, _direction(formula.sun_elevation, formula.sun_azimuth))


def _cost():
    world = fs.World(place={"latitude": 33.2, "longitude": -98.1})
    ephemeris, start = Ephemeris.of(world), datetime(2024, 6, 1, tzinfo=UTC)
    taken = []
    for frame in range(500):
        before = time.perf_counter()
        light_values(world, ephemeris.at(start + timedelta(seconds=frame)), 100.0)
        taken.append(time.perf_counter() - before)
    return 1e3 * float(np.median(taken))
