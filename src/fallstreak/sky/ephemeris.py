"""Where the sun, the moon, the planets and the stars stand, seen from a place at a time.

The bodies' vectors come from astronomy-engine (VSOP87 and the NOVAS lunar theory, truncated; about one arc
minute at worst). That library is pure Python and takes some milliseconds for everything a frame needs, so
vectors are evaluated only at the nodes of an *absolute* six-hour grid of universal time and interpolated with
a cubic through the four nodes around the wanted moment. The grid belongs to the calendar and not to what was
asked before: the answer is a function of the time alone. Interpolation adds less than 1e-4 degrees to every
direction (tests/sky/test_ephemeris.py).

Frames: *equatorial* is the mean equator and equinox of J2000 (right-handed, z to the north pole), in which
the star table stands. *Local* is the world's frame: metres, x east, y north, z up at the anchor. Latitude and
longitude are geodetic on Earth, planetocentric east-positive on Mars (IAU pole and prime meridian).

Limits: universal time is taken as UTC (under 0.9 s, 0.004 degrees of rotation); diurnal aberration (0.3") and
the stars' annual aberration and parallax (under 21") are left out; polar motion is left out.
"""

from __future__ import annotations

from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from functools import lru_cache
from math import asin, atan2, cos, exp, hypot, pi, sin, sqrt
from typing import TYPE_CHECKING

import astronomy
import numpy as np

from .mars import MARS_RADIUS

if TYPE_CHECKING:
    from fallstreak.world import World

AU = 1.495978707e11
SUN_RADIUS = 6.957e8
MOON_RADIUS = 1.7374e6
EARTH_RADIUS = 6.378137e6
EARTH_FLATTENING = 1 / 298.257223563
J2000 = datetime(2000, 1, 1, 12, tzinfo=UTC)

NODE_DAYS = 0.25
_MARS_SPIN = 350.891982443297  # degrees per day, IAU 2015

_EARTH_PLANETS = ("Mercury", "Venus", "Mars", "Jupiter", "Saturn")
_MARS_PLANETS = ("Mercury", "Venus", "Earth", "Jupiter", "Saturn")
# Absolute magnitude V(1, 0) for the view from elsewhere than Earth (Astronomical Almanac, section E).
_V10 = {"Mercury": -0.36, "Venus": -4.29, "Earth": -3.99, "Jupiter": -9.40, "Saturn": -8.88}


@dataclass(frozen=True)
class Heavens:
    """The bodies over one place at one moment; directions are local unit vectors towards the body.

    Attributes
    ----------
    sun_direction, moon_direction : (3,) float64
        Apparent directions (with refraction where the ephemeris was asked for it).
    sun_distance : float
        Metres from the observer.
    sun_radius, moon_radius : float
        Angular radii, radians. ``moon_radius`` is 0 where there is no moon.
    moon_distance : float
        Metres from the observer.
    moon_phase : float
        Sun-moon-observer angle in radians: 0 is full, pi is new.
    moon_sun_direction : (3,) float64
        From the moon towards the sun: what lights the moon's face.
    moon_from_local : (3, 3) float64
        Rows are the moon's own axes (IAU mean-Earth pole and prime meridian) in the local frame, so libration
        is in it: x leaves the middle of the near side, z leaves the north pole.
    antisun_direction : (3,) float64
        Axis of Earth's shadow at the moon's distance, seen from the observer: lunar eclipses.
    equatorial_from_local : (3, 3) float64
        Turns a local direction (no refraction) into J2000 equatorial axes; its transpose turns stars.
    planet_names, planet_directions, planet_magnitudes : tuple of str, (n, 3), (n,)
        The naked-eye planets: apparent directions and visual magnitudes above the air.
    refraction : float
        Strength of refraction at the observer against sea level on Earth: 0 is none.
    """

    sun_direction: np.ndarray
    sun_distance: float
    sun_radius: float
    moon_direction: np.ndarray
    moon_distance: float
    moon_radius: float
    moon_phase: float
    moon_sun_direction: np.ndarray
    moon_from_local: np.ndarray
    antisun_direction: np.ndarray
    equatorial_from_local: np.ndarray
    planet_names: tuple[str, ...]
    planet_directions: np.ndarray
    planet_magnitudes: np.ndarray
    refraction: float

    @property
    def sun_elevation(self) -> float:
        """Elevation of the sun's centre above the local horizontal, radians."""
        return asin(float(self.sun_direction[2]))

    @property
    def moon_elevation(self) -> float:
        """Elevation of the moon's centre above the local horizontal, radians."""
        return asin(float(self.moon_direction[2]))

    @property
    def moon_fraction(self) -> float:
        """Lit fraction of the moon's disc, 0..1."""
        return (1 + cos(self.moon_phase)) / 2

    @property
    def moon_bright_limb(self) -> float:
        """Where the moon's bright limb points: radians from straight up, towards the right as seen."""
        right = np.cross(self.moon_direction, (0.0, 0.0, 1.0))
        upward = np.cross(right, self.moon_direction)
        return atan2(float(right @ self.moon_sun_direction), float(upward @ self.moon_sun_direction))


class Ephemeris:
    """The sky over one place.

    Parameters
    ----------
    latitude, longitude : float
        Of the anchor, radians, east positive.
    height : float
        Of the local frame's origin above the ellipsoid (sphere on Mars), metres.
    planet : {"earth", "mars"}
        Whose surface the place is on. A made-up planet keeps Earth's sky.
    refraction : bool
        Lift the bodies as Earth's air does. Ignored on Mars, whose air bends by under half an arc minute.

    Examples
    --------
    >>> from datetime import datetime, timezone
    >>> sky = Ephemeris(0.0, 0.0).at(datetime(2024, 3, 20, 12, 7, tzinfo=timezone.utc))
    >>> bool(sky.sun_direction[2] > 0.9999)
    True
    """

    def __init__(
        self,
        latitude: float,
        longitude: float,
        height: float = 0.0,
        planet: str = "earth",
        refraction: bool = True,
    ):
        self.planet = "mars" if planet == "mars" else "earth"
        self.latitude, self.longitude = latitude, longitude
        self.refraction = refraction and self.planet == "earth"
        # The anchor from the planet's centre, local axes. On the ellipsoid the vertical misses the centre.
        self._anchor = np.array([0.0, 0.0, MARS_RADIUS + height])
        self._height = height
        if self.planet == "earth":
            squeeze = (1 - EARTH_FLATTENING) ** 2
            prime = EARTH_RADIUS / sqrt(cos(latitude) ** 2 + squeeze * sin(latitude) ** 2)
            equatorial, polar = (prime + height) * cos(latitude), (squeeze * prime + height) * sin(latitude)
            self._anchor[1] = cos(latitude) * polar - sin(latitude) * equatorial
            self._anchor[2] = cos(latitude) * equatorial + sin(latitude) * polar

    @classmethod
    def of(cls, world: World) -> Ephemeris:
        """The sky over a world's anchor."""
        place = world.place
        return cls(place.latitude_radians, place.longitude_radians, planet=world.planet.preset)

    def at(self, utc: datetime, position=(0.0, 0.0, 0.0)) -> Heavens:
        """Everything over the observer at a moment.

        Parameters
        ----------
        utc : datetime
            Aware; any zone.
        position : (3,) array_like
            The observer in the local frame, metres from its origin: matters to the moon, and to refraction.
        """
        days = days_since_j2000(utc)
        nodes = _interpolate(self.planet, days)
        planets = _EARTH_PLANETS if self.planet == "earth" else _MARS_PLANETS
        count = len(planets)
        frame, spin_offset = nodes[0:9].reshape(3, 3), nodes[9]
        sun_centre, moon_centre = nodes[10:13], nodes[13:16]
        moon_pole, moon_spin_offset = nodes[16:19], nodes[19]
        planet_vectors = nodes[20 : 20 + 3 * count].reshape(count, 3)
        magnitudes = nodes[20 + 3 * count :]

        spin = spin_offset + (_earth_rotation(days) if self.planet == "earth" else _MARS_SPIN * days)
        local = _horizon(self.latitude, np.radians(spin % 360.0) + self.longitude) @ frame
        observer = self._anchor + position
        strength = 0.0
        if self.refraction:
            height = _length(observer) - _length(self._anchor) + self._height
            strength = min(exp(-height / 8000.0), 1.0)

        # Sun, moon, antisun at the moon's distance, planets: from the centre in au, then from the observer.
        shadow_centre = sun_centre * (-_length(moon_centre) / _length(sun_centre))
        bodies = np.vstack([sun_centre, moon_centre, shadow_centre, planet_vectors])
        bodies = bodies @ local.T * AU - observer
        to_sun = bodies[0] - bodies[1]
        distances = np.sqrt(np.einsum("ij,ij->i", bodies, bodies))
        directions = bodies / distances[:, None]
        # The anchor's own vertical is z; far from it the sphere's is good enough.
        up = _unit(np.array([0.0, 0.0, 6.36e6]) + position)
        apparent = refract(directions, strength, up)
        sun_distance, moon_distance = float(distances[0]), float(distances[1])
        has_moon = self.planet == "earth"
        return Heavens(
            sun_direction=apparent[0],
            sun_distance=sun_distance,
            sun_radius=asin(SUN_RADIUS / sun_distance),
            moon_direction=apparent[1],
            moon_distance=moon_distance,
            moon_radius=asin(MOON_RADIUS / moon_distance) if has_moon else 0.0,
            moon_phase=_angle(to_sun, -directions[1]),
            moon_sun_direction=_unit(to_sun),
            moon_from_local=_body_axes(moon_pole, moon_spin_offset + _MOON_SPIN * days) @ local.T,
            antisun_direction=apparent[2],
            equatorial_from_local=local.T,
            planet_names=planets,
            planet_directions=apparent[3:],
            planet_magnitudes=magnitudes,
            refraction=strength,
        )


def days_since_j2000(utc: datetime) -> float:
    """Days of universal time since 2000-01-01 12:00 (a naive time is refused)."""
    if utc.tzinfo is None:
        raise ValueError("the sky needs a time with a zone: add tzinfo, or Z at the end of the ISO text")
    return (utc - J2000) / timedelta(days=1)


def refract(direction: np.ndarray, strength: float = 1.0, up: np.ndarray | None = None) -> np.ndarray:
    """Lift directions as the air between them and the observer does.

    Saemundsson's formula (Sky & Telescope 72, 1986; 10 degrees C, 1010 hPa). Below -1 degree of true
    elevation no ray arrives and the formula ends: the lift fades to nothing at -5 degrees, so that
    twilight, which is told by the true elevation, keeps its times.

    Parameters
    ----------
    direction : (..., 3) array
        Unit vectors.
    strength : float
        Air density at the observer over that at sea level.
    up : (3,) array, optional
        The observer's vertical; z if left out.
    """
    if strength <= 0.0:
        return direction
    vertical = np.array([0.0, 0.0, 1.0]) if up is None else np.asarray(up, float)
    rise = np.clip(direction @ vertical, -1.0, 1.0)
    elevation = np.degrees(np.arcsin(rise))
    held = np.clip(elevation, -1.0, 90.0)
    lift = 1.02 / 60.0 / np.tan(np.radians(held + 10.3 / (held + 5.11)))
    fade = np.clip((elevation + 5.0) / 4.0, 0.0, 1.0)
    lift = strength * np.maximum(lift, 0.0) * fade * fade * (3.0 - 2.0 * fade)
    lifted = np.radians(np.minimum(elevation + lift, 90.0))
    scale = np.cos(lifted) / np.maximum(np.sqrt(np.maximum(1.0 - rise * rise, 0.0)), 1e-12)
    level = direction - rise[..., None] * vertical
    return level * scale[..., None] + np.sin(lifted)[..., None] * vertical


def elevation_azimuth(direction: np.ndarray) -> tuple[float, float]:
    """Elevation, and azimuth clockwise from north, of a local direction; radians."""
    x, y, z = (float(c) for c in direction)
    return atan2(z, hypot(x, y)), atan2(x, y) % (2 * pi)


# Nodes of the absolute grid

_MOON_SPIN = 13.17635815  # degrees per day


@lru_cache(maxsize=64)
def _node(planet: str, index: int) -> np.ndarray:
    """Everything that is interpolated, at the grid time ``index * NODE_DAYS``, as one flat row.

    Layout: 9 rotation to the equator of date | 1 spin angle less its linear part, degrees | 3 sun | 3 moon |
    3 the moon's pole | 1 its spin less the linear part | 3 per planet | 1 magnitude per planet. Vectors: au.
    """
    time = astronomy.Time(index * NODE_DAYS)
    moon_axis = astronomy.RotationAxis(astronomy.Body.Moon, time)
    if planet == "earth":
        frame = np.array(astronomy.Rotation_EQJ_EQD(time).rot).T
        spin = _wrapped(15.0 * astronomy.SiderealTime(time) - _earth_rotation(time.ut))
        names, viewer = _EARTH_PLANETS, None
        moon = _xyz(astronomy.GeoMoon(time))
    else:
        axis = astronomy.RotationAxis(astronomy.Body.Mars, time)
        frame = _body_axes(_xyz(axis.north), 0.0)
        spin = _wrapped(axis.spin - _MARS_SPIN * time.ut)
        names, viewer = _MARS_PLANETS, astronomy.Body.Mars
        moon = np.array([0.0, 0.0, -1.0])  # none: keeps the arithmetic whole, and its radius is zero
    row = [frame.ravel(), [spin], _apparent(viewer, "Sun", time), moon, _xyz(moon_axis.north)]
    row.append([_wrapped(moon_axis.spin - _MOON_SPIN * time.ut)])
    vectors = [_apparent(viewer, name, time) for name in names]
    magnitudes = [_magnitude(viewer, name, vector, time) for name, vector in zip(names, vectors, strict=True)]
    flat = np.concatenate([*row, *vectors, magnitudes])
    flat.setflags(write=False)
    return flat


def _interpolate(planet: str, days: float) -> np.ndarray:
    """Cubic through the two nodes before and the two after."""
    index = int(np.floor(days / NODE_DAYS))
    t = days / NODE_DAYS - index
    weights = (
        -t * (t - 1) * (t - 2) / 6,
        (t + 1) * (t - 1) * (t - 2) / 2,
        -(t + 1) * t * (t - 2) / 2,
        (t + 1) * t * (t - 1) / 6,
    )
    rows = [_node(planet, index + k) for k in (-1, 0, 1, 2)]
    return weights[0] * rows[0] + weights[1] * rows[1] + weights[2] * rows[2] + weights[3] * rows[3]


def _apparent(viewer, name: str, time) -> np.ndarray:
    """Apparent vector (light time and aberration) of a body, J2000 axes, au. ``viewer`` None is Earth."""
    body = getattr(astronomy.Body, name)
    if viewer is None:
        return _xyz(astronomy.GeoVector(body, time, True))
    return _xyz(astronomy.BackdatePosition(time, viewer, body, True))


def _magnitude(viewer, name: str, vector: np.ndarray, time) -> float:
    if viewer is None:
        return astronomy.Illumination(getattr(astronomy.Body, name), time).mag
    body = _xyz(astronomy.HelioVector(getattr(astronomy.Body, name), time))
    phase = _angle(body, vector)
    lambert = (sin(phase) + (pi - phase) * cos(phase)) / pi
    distances = float(np.linalg.norm(body) * np.linalg.norm(vector))
    return _V10[name] + 5 * np.log10(distances) - 2.5 * np.log10(max(lambert, 1e-3))


# Small geometry


def _earth_rotation(days: float) -> float:
    """Earth rotation angle in degrees (IAU 2000), its whole turns taken out before precision is lost."""
    return 360.0 * ((0.7790572732640 + 0.00273781191135448 * days + days % 1.0) % 1.0)


def _horizon(latitude: float, sidereal: float) -> np.ndarray:
    """Rows east, north, up on the axes of the rotating planet's equator."""
    sp, cp, st, ct = sin(latitude), cos(latitude), sin(sidereal), cos(sidereal)
    return np.array([[-st, ct, 0.0], [-sp * ct, -sp * st, cp], [cp * ct, cp * st, sp]])


def _body_axes(pole: np.ndarray, spin: float) -> np.ndarray:
    """Rows: a body's axes in J2000 from its pole and the angle of its prime meridian (degrees) along its
    equator from where that rises through Earth's (IAU WGCCRE)."""
    pole = _unit(pole)
    node = _unit(np.array([-pole[1], pole[0], 0.0]))
    third = _cross(pole, node)
    angle = np.radians(spin % 360.0)
    meridian = cos(angle) * node + sin(angle) * third
    return np.stack([meridian, _cross(pole, meridian), pole])


def _wrapped(angle: float) -> float:
    return (angle + 180.0) % 360.0 - 180.0


# numpy's own norm and cross cost ten times as much on three numbers, and a frame has 0.3 ms for all of this.


def _length(vector: np.ndarray) -> float:
    return sqrt(vector @ vector)


def _unit(vector: np.ndarray) -> np.ndarray:
    return vector / sqrt(vector @ vector)


def _cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    (ax, ay, az), (bx, by, bz) = a.tolist(), b.tolist()
    return np.array([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx])


def _angle(a: np.ndarray, b: np.ndarray) -> float:
    return atan2(_length(_cross(a, b)), float(a @ b))


def _xyz(vector) -> np.ndarray:
    return np.array([vector.x, vector.y, vector.z])
