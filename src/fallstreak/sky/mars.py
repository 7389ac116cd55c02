"""Solar time on Mars: season, local hour and the sun's place, by a closed formula.

M. Allison and M. McEwen, "A post-Pathfinder evaluation of areocentric solar coordinates", Planetary and Space
Science 48 (2000) 215-235, with the coefficients NASA GISS uses in Mars24. Good to about 0.01 degrees for a
century around 2000. The sky itself is drawn from astronomy-engine's vectors and the IAU pole (ephemeris.py),
which must know where the stars are too; this formula is what people on Mars set their clocks by, and the two
check each other in tests/sky/test_mars.py.
"""

from dataclasses import dataclass
from datetime import UTC, datetime
from math import asin, atan2, cos, degrees, pi, radians, sin

import astronomy

MARS_RADIUS = 3.3895e6

# Perturbers of the orbit: amplitude (degrees), period (Julian years), phase (degrees). Paper, equation 18.
_PERTURBERS = (
    (0.0071, 2.2353, 49.409),
    (0.0057, 2.7543, 168.173),
    (0.0039, 1.1177, 191.837),
    (0.0037, 15.7866, 21.736),
    (0.0021, 2.1354, 15.704),
    (0.0020, 2.4694, 95.528),
    (0.0018, 32.8493, 49.095),
)


@dataclass(frozen=True)
class MarsTime:
    """What time it is on Mars.

    Attributes
    ----------
    solar_longitude : float
        Season L_s, radians: 0 is the northern spring equinox.
    mean_time, true_time : float
        Local mean and local true solar time, hours of 24 to the sol.
    sun_elevation, sun_azimuth : float
        Radians; azimuth clockwise from north.
    sun_distance : float
        au.
    """

    solar_longitude: float
    mean_time: float
    true_time: float
    sun_elevation: float
    sun_azimuth: float
    sun_distance: float


def mars_time(utc: datetime, latitude: float, longitude: float) -> MarsTime:
    """Solar time and the sun at a place on Mars.

    Parameters
    ----------
    utc : datetime
        Aware.
    latitude, longitude : float
        Planetocentric, east positive, radians.
    """
    time = astronomy.Time.Parse(utc.astimezone(UTC).strftime("%Y-%m-%dT%H:%M:%S.%fZ"))
    days = time.tt
    anomaly = radians(19.3871 + 0.52402073 * days)
    mean_sun = 270.3871 + 0.524038496 * days
    pulls = sum(a * cos(radians(360.0 / 365.25 * days / period + phase)) for a, period, phase in _PERTURBERS)
    centre = (
        (10.691 + 3.0e-7 * days) * sin(anomaly)
        + 0.623 * sin(2 * anomaly)
        + 0.050 * sin(3 * anomaly)
        + 0.005 * sin(4 * anomaly)
        + 0.0005 * sin(5 * anomaly)
        + pulls
    )
    season = radians(mean_sun + centre)
    equation = 2.861 * sin(2 * season) - 0.071 * sin(4 * season) + 0.002 * sin(6 * season) - centre
    prime = 24.0 * ((days - 4.5) / 1.0274912517 + 44796.0 - 0.0009626)
    mean = (prime + degrees(longitude) / 15.0) % 24.0
    true = (mean + equation / 15.0) % 24.0
    declination = asin(0.42565 * sin(season))
    hour = (true - 12.0) * pi / 12.0
    east = -cos(declination) * sin(hour)
    north = cos(latitude) * sin(declination) - sin(latitude) * cos(declination) * cos(hour)
    up = sin(latitude) * sin(declination) + cos(latitude) * cos(declination) * cos(hour)
    distance = 1.52367934 * (
        1.00436
        - 0.09309 * cos(anomaly)
        - 0.004336 * cos(2 * anomaly)
        - 0.00031 * cos(3 * anomaly)
        - 0.00003 * cos(4 * anomaly)
    )
    return MarsTime(season % (2 * pi), mean, true, asin(up), atan2(east, north) % (2 * pi), distance)
