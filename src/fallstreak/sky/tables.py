"""How the sky's tables are laid out, in float64: the twin of tables.wesl, for reading tables on the CPU.

Coordinates run 0..1 from the first texel's centre to the last one's; tables.wesl says what each is for.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from .air import Air
from .model import Array, cos_horizon, span_in_air


def bilinear(table: ArrayLike, u: ArrayLike, v: ArrayLike) -> Array:
    """Texels of a (height, width, channels) table between their centres, shape (..., channels)."""
    table = np.asarray(table, float)
    height, width = table.shape[:2]
    x, y = np.clip(u, 0.0, 1.0) * (width - 1), np.clip(v, 0.0, 1.0) * (height - 1)
    i, j = np.minimum(x.astype(int), width - 2), np.minimum(y.astype(int), height - 2)
    fx, fy = (x - i)[..., None], (y - j)[..., None]
    low = table[j, i] * (1.0 - fx) + table[j, i + 1] * fx
    high = table[j + 1, i] * (1.0 - fx) + table[j + 1, i + 1] * fx
    return low * (1.0 - fy) + high * fy


def transmittance_from_place(air: Air, altitude: ArrayLike, mu: ArrayLike) -> tuple[Array, Array]:
    """Coordinates of the transmittance from an altitude (m) to the top of the air, along cosine `mu`."""
    h, mu = np.broadcast_arrays(np.asarray(altitude, float), np.asarray(mu, float))
    horizon = np.sqrt(h * (2.0 * air.planet_radius + h))
    far = np.sqrt(air.top_height * (2.0 * air.planet_radius + air.top_height))
    least = air.top_height - h
    distance = span_in_air(air, h, mu)[1]
    return (distance - least) / (horizon + far - least), horizon / far


def place_from_transmittance(air: Air, u: ArrayLike, v: ArrayLike) -> tuple[Array, Array]:
    """Altitude (m) and cosine of the zenith angle at coordinates of the transmittance."""
    radius = air.planet_radius
    far = np.sqrt(air.top_height * (2.0 * radius + air.top_height))
    horizon = np.asarray(v, float) * far
    h = horizon**2 / (np.sqrt(horizon**2 + radius**2) + radius)
    least = air.top_height - h
    distance = least + np.asarray(u, float) * (horizon + far - least)
    room = least * (2.0 * radius + air.top_height + h)
    mu = (room - distance**2) / (2.0 * (radius + h) * np.maximum(distance, 1e-3))
    return h, np.where(distance < 1e-3, 1.0, np.clip(mu, -1.0, 1.0))


def multiscattering_from_place(air: Air, altitude: ArrayLike, mu_sun: ArrayLike) -> tuple[Array, Array]:
    """Coordinates of the multiple scattering and of the skylight; both are stored as their fourth root."""
    mu_sun = np.asarray(mu_sun, float)
    u = 0.5 + 0.5 * np.sign(mu_sun) * np.sqrt(np.abs(mu_sun))
    return u, np.sqrt(np.clip(np.asarray(altitude, float) / air.top_height, 0.0, 1.0))


def place_from_multiscattering(air: Air, u: ArrayLike, v: ArrayLike) -> tuple[Array, Array]:
    """Altitude (m) and cosine of the sun's zenith angle at coordinates of the multiple scattering."""
    x = 2.0 * np.asarray(u, float) - 1.0
    return np.asarray(v, float) ** 2 * air.top_height, x * np.abs(x)


def view_stretch(air: Air, altitude: float) -> float:
    """How strongly the view's rows gather at the horizon, seen from an altitude (m)."""
    h = max(altitude, air.top_height)
    horizon = cos_horizon(air, h)
    below_top = (h - air.top_height) * (2.0 * air.planet_radius + h + air.top_height)
    top = -np.sqrt(below_top) / (air.planet_radius + h)
    at_horizon, at_top = np.sqrt(0.5 - 0.5 * horizon), np.sqrt(0.5 - 0.5 * top)
    share = 0.5 * (top - horizon) / ((at_horizon + at_top) * at_horizon)
    return float(0.3 / share * np.clip(altitude / air.top_height, 0.0, 1.0))


def direction_from_view(air: Air, altitude: float, size: tuple[int, int]) -> tuple[Array, Array]:
    """Cosines of zenith angle and azimuth from the light of every texel of a view of (width, height)."""
    width, height = size
    half = height // 2
    row = np.arange(height)
    up = row >= half
    x = np.where(up, row - half, half - 1 - row) / (half - 1)
    stretch = view_stretch(air, altitude)
    y = x * x / (stretch + 1.0 - stretch * x * x)
    side = np.where(up, 1.0, -1.0)
    horizon = cos_horizon(air, altitude)
    end = np.sqrt(0.5 - 0.5 * side * horizon)
    mu = np.clip(horizon + side * 2.0 * end * y * (end + end * (1.0 - y)), -1.0, 1.0)
    u = np.arange(width) / (width - 1)
    mu, cos_azimuth = np.meshgrid(mu, 1.0 - 2.0 * u * u, indexing="ij")
    return mu, cos_azimuth


def view_from_direction(
    air: Air, altitude: float, mu: ArrayLike, cos_azimuth: ArrayLike, rows: int
) -> tuple[Array, Array]:
    """Coordinates of the view in directions, for `bilinear` (the GPU never mixes ground with sky)."""
    mu = np.asarray(mu, float)
    horizon, stretch = cos_horizon(air, altitude), view_stretch(air, altitude)
    side = np.where(mu >= horizon, 1.0, -1.0)
    end, at = np.sqrt(0.5 - 0.5 * side * horizon), np.sqrt(np.maximum(0.5 - 0.5 * side * mu, 0.0))
    y = 0.5 * side * (mu - horizon) / ((end + at) * end)
    x = np.sqrt(np.clip(y * (stretch + 1.0) / (stretch * y + 1.0), 0.0, 1.0))
    half = rows / 2
    row = np.where(side > 0, half + x * (half - 1), half - 1 - x * (half - 1))
    return np.sqrt(np.clip(0.5 - 0.5 * np.asarray(cos_azimuth, float), 0.0, 1.0)), row / (rows - 1)
