"""Maps and the sphere: azimuthal equidistant about the anchor, and the inverse of UTM.

World space and the planet are spherical (radius ``planet.radius``); latitude and longitude of a file are
taken as directions on that sphere, whatever ellipsoid they were surveyed on (on Earth the shapes are off by
at most 0.34 %).
"""

from __future__ import annotations

import numpy as np

# WGS84, the ellipsoid of UTM
_A, _F = 6378137.0, 1.0 / 298.257223563


def map_from_geographic(latitude, longitude, place, radius: float):
    """Degrees on the planet → (east, north) metres on the azimuthal-equidistant map about the anchor.

    Parameters
    ----------
    latitude, longitude : arrays of one shape, degrees
    place : (latitude, longitude) of the anchor, degrees
    radius : planet radius, m
    """
    lat, lon = np.radians(latitude), np.radians(np.asarray(longitude) - place[1])
    lat0 = np.radians(place[0])
    east = np.cos(lat) * np.sin(lon)
    north = np.cos(lat0) * np.sin(lat) - np.sin(lat0) * np.cos(lat) * np.cos(lon)
    up = np.sin(lat0) * np.sin(lat) + np.cos(lat0) * np.cos(lat) * np.cos(lon)
    sine = np.hypot(east, north)
    angle = np.arctan2(sine, up)
    scale = radius * np.where(sine > 1e-12, angle / np.where(sine > 1e-12, sine, 1.0), 1.0)
    return east * scale, north * scale


def geographic_from_map(east, north, place, radius: float):
    """(east, north) metres on the map → latitude, longitude in degrees, within ±180 of the anchor's."""
    angle = np.hypot(east, north) / radius
    scale = np.sinc(angle / np.pi) / radius
    x, y, z = np.asarray(east) * scale, np.asarray(north) * scale, np.cos(angle)
    lat0 = np.radians(place[0])
    sine = np.clip(y * np.cos(lat0) + z * np.sin(lat0), -1.0, 1.0)
    longitude = np.arctan2(x, z * np.cos(lat0) - y * np.sin(lat0))
    return np.degrees(np.arcsin(sine)), place[1] + np.degrees(longitude)


def world_from_map(east, north, height, radius: float) -> np.ndarray:
    """(east, north) on the map and height above sea level → world position (..., 3), m."""
    east, north, height = np.broadcast_arrays(np.asarray(east, float), north, height)
    angle = np.hypot(east, north) / radius
    scale = (radius + height) * np.sinc(angle / np.pi) / radius
    # cos φ − 1 written as −2 sin²(φ/2): near the anchor the difference of two equals would lose everything
    drop = -2.0 * np.sin(0.5 * angle) ** 2
    return np.stack([east * scale, north * scale, height + (radius + height) * drop], axis=-1)


def map_from_world(position, radius: float):
    """World position (..., 3) → east, north on the map and height above sea level, m."""
    x, y, z = np.moveaxis(np.asarray(position, float), -1, 0)
    sine = np.hypot(x, y)
    distance = np.hypot(sine, radius + z)
    angle = np.arctan2(sine, radius + z)
    scale = radius * np.where(sine > 0.0, angle / np.where(sine > 0.0, sine, 1.0), 1.0 / radius)
    # sqrt((R+z)² + s²) − R without cancellation
    height = (z * (2.0 * radius + z) + sine**2) / (distance + radius)
    return x * scale, y * scale, height


def geographic_from_utm(easting, northing, zone: int, south: bool):
    """UTM coordinates (m, WGS84) → latitude, longitude in degrees.

    Krüger's series in the third flattening to n³ (C. F. F. Karney 2011, "Transverse Mercator with an accuracy
    of a few nanometers", eqs. 36 and 7-9): below a millimetre within a zone.
    """
    n = _F / (2.0 - _F)
    rectifying = _A / (1.0 + n) * (1.0 + n**2 / 4.0 + n**4 / 64.0)
    xi = (np.asarray(northing, float) - (1e7 if south else 0.0)) / (0.9996 * rectifying)
    eta = (np.asarray(easting, float) - 5e5) / (0.9996 * rectifying)
    beta = (
        n / 2.0 - 2.0 * n**2 / 3.0 + 37.0 * n**3 / 96.0,
        n**2 / 48.0 + n**3 / 15.0,
        17.0 * n**3 / 480.0,
    )
    xi_prime, eta_prime = xi, eta
    for j, b in enumerate(beta, 1):
        xi_prime = xi_prime - b * np.sin(2 * j * xi) * np.cosh(2 * j * eta)
        eta_prime = eta_prime - b * np.cos(2 * j * xi) * np.sinh(2 * j * eta)
    conformal = np.arcsin(np.sin(xi_prime) / np.cosh(eta_prime))
    delta = (
        2.0 * n - 2.0 * n**2 / 3.0 - 2.0 * n**3,
        7.0 * n**2 / 3.0 - 8.0 * n**3 / 5.0,
        56.0 * n**3 / 15.0,
    )
    latitude = conformal + sum(d * np.sin(2 * j * conformal) for j, d in enumerate(delta, 1))
    longitude = np.arctan2(np.sinh(eta_prime), np.cos(xi_prime))
    return np.degrees(latitude), 6.0 * zone - 183.0 + np.degrees(longitude)


def utm_from_geographic(latitude, longitude, zone: int, south: bool):
    """Latitude, longitude in degrees → UTM easting, northing (m, WGS84); inverts `geographic_from_utm`."""
    n = _F / (2.0 - _F)
    rectifying = _A / (1.0 + n) * (1.0 + n**2 / 4.0 + n**4 / 64.0)
    eccentricity = 2.0 * np.sqrt(n) / (1.0 + n)
    sine = np.sin(np.radians(latitude))
    difference = np.radians(np.asarray(longitude) - (6.0 * zone - 183.0))
    t = np.sinh(np.arctanh(sine) - eccentricity * np.arctanh(eccentricity * sine))
    xi = np.arctan2(t, np.cos(difference))
    eta = np.arctanh(np.sin(difference) / np.hypot(1.0, t))
    alpha = (
        n / 2.0 - 2.0 * n**2 / 3.0 + 5.0 * n**3 / 16.0,
        13.0 * n**2 / 48.0 - 3.0 * n**3 / 5.0,
        61.0 * n**3 / 240.0,
    )
    east = eta + sum(a * np.cos(2 * j * xi) * np.sinh(2 * j * eta) for j, a in enumerate(alpha, 1))
    north = xi + sum(a * np.sin(2 * j * xi) * np.cosh(2 * j * eta) for j, a in enumerate(alpha, 1))
    scale = 0.9996 * rectifying
    return 5e5 + scale * east, (1e7 if south else 0.0) + scale * north


def geographic_from_mercator(y):
    """Spherical Mercator's distance from the equator, in degrees of longitude there → latitude, degrees."""
    return np.degrees(np.arctan(np.sinh(np.radians(y))))


def mercator_from_geographic(latitude):
    """Latitude in degrees → distance from the equator as on a web map, in degrees of longitude there."""
    return np.degrees(np.arcsinh(np.tan(np.radians(np.clip(latitude, -89.9, 89.9)))))
