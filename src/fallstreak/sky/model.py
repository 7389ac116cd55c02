"""The air on the CPU, in float64: what every table of the GPU is tested against.

A place in the air is its altitude above the planet's sphere, a direction the cosine μ of its zenith angle.
Spheres are met by differences of height, never by r² - R²: 1.7 m above the ground is as good as 400 km.

Sources: E. Bruneton, "Precomputed Atmospheric Scattering: a New Implementation" (2017), for the media;
S. Hillaire, "A Scalable and Production Ready Sky and Atmosphere Rendering Technique", EGSR 2020, for the
multiple scattering (section 5.5) and the tables' roles. The tables' mappings are our own (see `tables`).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .air import Air

Array = NDArray[np.float64]


# Geometry


def altitude_along(air: Air, altitude: ArrayLike, mu: ArrayLike, distance: ArrayLike) -> Array:
    """Altitude (m) after `distance` (m) along a ray; exact differences, no cancellation."""
    h, mu, t = (np.asarray(v, float) for v in (altitude, mu, distance))
    r = air.planet_radius + h
    return h + (2.0 * r * mu * t + t * t) / (np.sqrt(r * r + 2.0 * r * mu * t + t * t) + r)


def cos_horizon(air: Air, altitude: ArrayLike) -> Array:
    """Cosine of the horizon's zenith angle seen from an altitude (m)."""
    h = np.maximum(np.asarray(altitude, float), 0.0)
    return -np.sqrt(h * (2.0 * air.planet_radius + h)) / (air.planet_radius + h)


def distance_to_ground(air: Air, altitude: ArrayLike, mu: ArrayLike) -> Array:
    """Distance (m) to the planet's sphere, or inf where the ray misses it."""
    h, mu = np.maximum(np.asarray(altitude, float), 0.0), np.asarray(mu, float)
    r = air.planet_radius + h
    legs = h * (2.0 * air.planet_radius + h)
    inside = (r * mu) ** 2 - legs
    hit = (mu < 0.0) & (inside >= 0.0)
    return np.where(hit, legs / np.maximum(-r * mu + np.sqrt(np.maximum(inside, 0.0)), 1e-3), np.inf)


def span_in_air(air: Air, altitude: ArrayLike, mu: ArrayLike) -> tuple[Array, Array]:
    """Where a ray enters and leaves the air (m), ignoring the planet; both 0 where it never does."""
    h, mu = np.asarray(altitude, float), np.asarray(mu, float)
    r, top = air.planet_radius + h, air.planet_radius + air.top_height
    above = (h - air.top_height) * (r + top)  # r² - top²
    inside = (r * mu) ** 2 - above
    root = np.sqrt(np.maximum(inside, 0.0))
    leave = np.where(mu > 0.0, -above / np.maximum(r * np.abs(mu) + root, 1e-3), -r * mu + root)
    enter = np.where(above > 0.0, above / np.maximum(-r * np.minimum(mu, 0.0) + root, 1e-3), 0.0)
    met = (inside > 0.0) & ((above <= 0.0) | (mu < 0.0))
    return np.where(met, enter, 0.0), np.where(met, np.maximum(leave, 0.0), 0.0)


def nodes_along(
    air: Air, altitude: ArrayLike, mu: ArrayLike, start: ArrayLike, end: ArrayLike, steps: int
) -> tuple[Array, Array]:
    """Sample distances and weights (m), shape (..., steps): dense where the ray is lowest.

    With x = ±√|t - t₀| about the lowest point t₀ of the stretch, samples are the middles of equal steps of x.
    """
    start, end = (np.asarray(v, float)[..., None] for v in (start, end))
    low = np.clip(-(air.planet_radius + np.asarray(altitude, float)) * np.asarray(mu, float), 0, None)[
        ..., None
    ]
    low = np.clip(low, start, end)
    a, b = -np.sqrt(low - start), np.sqrt(end - low)
    edge = a + (b - a) * np.arange(steps + 1) / steps
    t_edge = low + edge * np.abs(edge)
    middle = 0.5 * (edge[..., 1:] + edge[..., :-1])
    return low + middle * np.abs(middle), np.diff(t_edge, axis=-1)


# Media


def densities(air: Air, altitude: ArrayLike) -> tuple[Array, Array, Array]:
    """Relative density of gas, aerosol and ozone, each 1 where its coefficient is given."""
    h = np.maximum(np.asarray(altitude, float), 0.0)
    ozone = np.maximum(1.0 - np.abs(h - air.ozone_centre) / air.ozone_width, 0.0)
    return np.exp(-h / air.rayleigh_scale_height), np.exp(-h / air.mie_scale_height), ozone


def scattering(air: Air, altitude: ArrayLike) -> tuple[Array, Array]:
    """Scattering by gas and by aerosol (1/m), shape (..., 3)."""
    gas, aerosol, _ = densities(air, altitude)
    return gas[..., None] * np.array(air.rayleigh_scattering), aerosol[..., None] * np.array(
        air.mie_scattering
    )


def extinction(air: Air, altitude: ArrayLike) -> Array:
    """Extinction (1/m), shape (..., 3)."""
    gas, aerosol, ozone = (d[..., None] for d in densities(air, altitude))
    return (
        gas * np.array(air.rayleigh_scattering)
        + aerosol * np.array(air.mie_extinction)
        + ozone * np.array(air.ozone_absorption)
    )


def optical_depth(
    air: Air, altitude: ArrayLike, mu: ArrayLike, distance: ArrayLike | None = None, steps: int = 2000
) -> Array:
    """Optical depth, shape (..., 3), along a ray to the top of the air or over a distance (m).

    The ground is not in the way.
    """
    enter, leave = span_in_air(air, altitude, mu)
    if distance is not None:
        leave = np.minimum(leave, distance)
    t, dt = nodes_along(air, altitude, mu, np.minimum(enter, leave), leave, steps)
    h = altitude_along(air, np.asarray(altitude, float)[..., None], np.asarray(mu, float)[..., None], t)
    return np.sum(extinction(air, h) * dt[..., None], axis=-2)


def transmittance(air: Air, altitude: ArrayLike, mu: ArrayLike, distance: ArrayLike | None = None) -> Array:
    """What is left of light along a ray, shape (..., 3); ignores the ground."""
    return np.exp(-optical_depth(air, altitude, mu, distance))


def visible_fraction(air: Air, altitude: ArrayLike, mu: ArrayLike, angular_radius: float) -> Array:
    """How much of a disc at μ stands above the planet's horizon, 0 to 1 (a smooth step over its diameter)."""
    return _smoothstep((np.asarray(mu, float) - cos_horizon(air, altitude)) / (2.0 * angular_radius) + 0.5)


def _smoothstep(x: ArrayLike) -> Array:
    x = np.clip(x, 0.0, 1.0)
    return x * x * (3.0 - 2.0 * x)


# Phase functions, 1/sr


def phase_rayleigh(cosine: ArrayLike) -> Array:
    """Rayleigh's phase function."""
    return 3.0 / (16.0 * np.pi) * (1.0 + np.asarray(cosine, float) ** 2)


def phase_henyey_greenstein(cosine: ArrayLike, g: ArrayLike) -> Array:
    """Henyey and Greenstein 1941; mean cosine g."""
    g, cosine = np.asarray(g, float), np.asarray(cosine, float)
    return (1.0 - g * g) / (4.0 * np.pi * (1.0 + g * g - 2.0 * g * cosine) ** 1.5)


def phase_cornette_shanks(cosine: ArrayLike, g: ArrayLike) -> Array:
    """Cornette and Shanks 1992; tends to Rayleigh's for g = 0; mean cosine 3 g (4 + g²) / (5 (2 + g²))."""
    g, cosine = np.asarray(g, float), np.asarray(cosine, float)
    return phase_henyey_greenstein(cosine, g) * 1.5 * (1.0 + cosine * cosine) / (2.0 + g * g)


def phase_aerosol(air: Air, cosine: ArrayLike) -> Array:
    """The aerosol's phase function, shape (..., 3)."""
    cosine = np.asarray(cosine, float)[..., None]
    lobe = phase_cornette_shanks if air.cornette_shanks else phase_henyey_greenstein
    forward, wide = lobe(cosine, air.mie_forward), phase_henyey_greenstein(cosine, air.mie_wide)
    return wide + np.array(air.mie_forward_share) * (forward - wide)


# Scattering


def multiple_scattering(
    air: Air,
    altitude: ArrayLike,
    mu_sun: ArrayLike,
    directions: int = 64,
    steps: int = 20,
    sun_radius: float = 0.00465,
) -> Array:
    """Luminance that all orders of scattering beyond the first give, as if alike in all directions.

    Hillaire 2020, equations 5 to 10: second-order light and transfer at a point, summed as a series.
    The ground reflects too. Per unit of illuminance above the air; shape (..., 3).
    """
    altitude, mu_sun = np.broadcast_arrays(np.asarray(altitude, float), np.asarray(mu_sun, float))
    bands = len(air.rayleigh_scattering)
    second, transfer = np.zeros((*altitude.shape, bands)), np.zeros((*altitude.shape, bands))
    for z, x in sphere_directions(directions):
        nu = x * np.sqrt(np.maximum(1.0 - mu_sun**2, 0.0)) + z * mu_sun
        mu = np.full(altitude.shape, z)
        ground = distance_to_ground(air, altitude, mu)
        end = np.minimum(span_in_air(air, altitude, mu)[1], ground)
        t, dt = nodes_along(air, altitude, mu, np.zeros_like(end), end, steps)
        h = altitude_along(air, altitude[..., None], mu[..., None], t)
        sun = _mu_along(air, altitude, mu_sun, nu, t, h)
        gas, aerosol = scattering(air, h)
        lit = sunlight(air, h, sun, sun_radius)
        through, weight = _segments(extinction(air, h), dt)
        second += np.sum(weight * (gas + aerosol) * lit, axis=-2) / (4.0 * np.pi)
        transfer += np.sum(weight * (gas + aerosol), axis=-2)
        hit = np.isfinite(ground)
        at = np.where(hit, ground, 0.0)
        below = (((air.planet_radius + altitude) * mu_sun + at * nu) / air.planet_radius)[..., None]
        bounce = np.array(air.ground_albedo) / np.pi * np.maximum(below, 0.0)
        second += np.where(
            hit[..., None], through[..., -1, :] * bounce * sunlight(air, 0.0, below[..., 0], sun_radius), 0
        )
    second, transfer = second / directions, transfer / directions
    return second / (1.0 - transfer)


def sphere_directions(count: int) -> Array:
    """Vertical component and horizontal one towards the sun of `count` directions, shape (count, 2)."""
    i = np.arange(count) + 0.5
    z = 1.0 - 2.0 * i / count
    return np.stack([z, np.cos(np.pi * (1.0 + 5.0**0.5) * i) * np.sqrt(1.0 - z * z)], -1)


def sunlight(air: Air, altitude: ArrayLike, mu: ArrayLike, angular_radius: float) -> Array:
    """Share of a far light's illuminance above the air that arrives, shape (..., 3)."""
    seen = visible_fraction(air, altitude, mu, angular_radius)
    return transmittance_to_top(air, altitude, np.maximum(mu, cos_horizon(air, altitude))) * seen[..., None]


def transmittance_to_top(air: Air, altitude: ArrayLike, mu: ArrayLike, steps: int = 160) -> Array:
    """`transmittance` with a quadrature short enough for nested use (relative error below 1e-4)."""
    return np.exp(-optical_depth(air, altitude, mu, steps=steps))


def _mu_along(air: Air, altitude: Array, mu_sun: Array, nu: Array, t: Array, h: Array) -> Array:
    r = air.planet_radius + altitude
    return (r * mu_sun)[..., None] / (air.planet_radius + h) + t * nu[..., None] / (air.planet_radius + h)


def _segments(sigma: Array, dt: Array) -> tuple[Array, Array]:
    """Transmittance up to the end of each segment, and the weight of a constant source in it (m)."""
    depth = sigma * dt[..., None]
    through = np.exp(-np.cumsum(depth, axis=-2))
    before = np.concatenate([np.ones_like(through[..., :1, :]), through[..., :-1, :]], axis=-2)
    return through, before * -np.expm1(-depth) / np.maximum(sigma, 1e-30)


def radiance(
    air: Air,
    altitude: ArrayLike,
    mu: ArrayLike,
    mu_sun: ArrayLike,
    nu: ArrayLike,
    distance: ArrayLike = np.inf,
    steps: int = 400,
    multiple=None,
    sun_radius: float = 0.00465,
) -> tuple[Array, Array]:
    """In-scattered luminance per unit of illuminance above the air, and transmittance, along rays.

    Parameters
    ----------
    altitude, mu, mu_sun, nu : array_like
        Altitude (m), cosines of the zenith angles of ray and sun, cosine between ray and sun.
    distance : array_like
        Where the ray ends (m); it always ends at the planet and at the top of the air.
    multiple : callable, optional
        `(altitude, mu_sun) -> (..., 3)` for all higher orders; `None` leaves them out.

    Returns
    -------
    luminance, transmittance : (..., 3) arrays
        Without the light of the ground itself.
    """
    altitude, mu, mu_sun, nu = np.broadcast_arrays(
        *(np.asarray(v, float) for v in (altitude, mu, mu_sun, nu))
    )
    enter, leave = span_in_air(air, altitude, mu)
    end = np.minimum(np.minimum(leave, distance_to_ground(air, altitude, mu)), distance)
    t, dt = nodes_along(air, altitude, mu, np.minimum(enter, end), end, steps)
    h = altitude_along(air, altitude[..., None], mu[..., None], t)
    sun = _mu_along(air, altitude, mu_sun, nu, t, h)
    gas, aerosol = scattering(air, h)
    phased = gas * phase_rayleigh(nu)[..., None, None] + aerosol * phase_aerosol(air, nu)[..., None, :]
    source = phased * sunlight(air, h, sun, sun_radius)
    if multiple is not None:
        source = source + (gas + aerosol) * multiple(h, sun)
    through, weight = _segments(extinction(air, h), dt)
    return np.sum(weight * source, axis=-2), through[..., -1, :]
