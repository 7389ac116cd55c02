"""Light on cloud matter: float64 twin of ``light.wesl``, with where it comes from and how far it errs.

What a piece of cloud sends to the eye, seen as if it were opaque, is the source of light there: radiance over
E / π, so that laying pieces over one another by their opacity integrates it along the ray. Three parts:

- light scattered once, ``exp(-τ) HG(0.85)``: the silver lining;
- light that was scattered forward before and still goes about straight, ``exp(-0.3 τ) - exp(-τ)``, by a wider
  lobe: the glow around it;
- light that has lost its direction: Eddington's mean intensity and flow in a slab that absorbs nothing
  (Joseph, Wiscombe and Weinman 1976), which is closed form. The slab lies across the line to the light where
  the cloud faces it, and is tilted where the light grazes (`facing`).

The constants were fitted to discrete ordinates (48 streams, Henyey-Greenstein g = 0.85, nothing absorbed,
overhead light: they give the reflectances of the project's table within 0.001), to delta-Eddington's
reflectance under slanting light and to the energy that spheres send out. Errors, of light that enters:

- slab, overhead, τ 0.5 to 50: reflectance within 0.008, all light together within 0.04;
- slab, cosine 0.5: reflectance within 0.04, all light together within 0.1 (0.05 from τ 5 on);
- spheres of optical radius 1 to 25: all light together within 0.13.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

G = 0.85
"""Asymmetry of droplets at 550 nm."""
STRAIGHT, AGAIN, WIDER, LEANING = 0.3, 1.65, 0.79, 0.33
"""Fitted: see light.wesl."""
REACH, MEAN = 1.15, 0.78
"""Ellipsoid of a box over the box; mean density in it over that in the middle of a cloud."""


def key_light(
    depth_to_key: ArrayLike, depth_behind: ArrayLike, facing: ArrayLike, cos_angle: ArrayLike
) -> Array:
    """Light of sun or moon that a piece of cloud sends to the eye, over E / π.

    Parameters
    ----------
    depth_to_key : array-like
        Optical depth between the piece and the light.
    depth_behind : array-like
        On the same line, from the piece away from the light to the far side of the cloud.
    facing : array-like
        Absolute cosine between the light and the cloud's outward normal there, 0..1.
    cos_angle : array-like
        Cosine between the ray from the eye and the direction to the light: 1 looks towards it.

    Returns
    -------
    ndarray
        1 is a white Lambert surface that faces the light.
    """
    ahead, behind, tilt, cosine = (
        np.asarray(x, float) for x in (depth_to_key, depth_behind, facing, cos_angle)
    )
    tilt = np.maximum(tilt, 0.1)
    first, straight = np.exp(-ahead), np.exp(-STRAIGHT * ahead)
    single = first * henyey_greenstein(cosine, G)
    again = AGAIN * (straight - first) * henyey_greenstein(cosine, WIDER)

    whole = ahead + behind
    passed = np.exp(-STRAIGHT * whole)
    flow = 0.75 * tilt * (1 + passed + tilt * (1 - passed)) / (2 + (1 - G) * tilt * whole)
    direct = 0.75 * tilt * straight
    mean = 0.75 * tilt * (1 + tilt) - flow - (1 - G) * tilt * flow * ahead - tilt * direct
    set_in = 1 - np.exp(-0.5 * whole**0.7)
    diffuse = set_in * np.maximum(np.maximum(mean, 0) + LEANING * (flow - direct) * cosine, 0)
    return np.pi * (single + again) + diffuse


def henyey_greenstein(cosine: ArrayLike, g: float) -> Array:
    """Phase function in 1/sr; `cosine` 1 goes straight on."""
    return (1 - g * g) / (4 * np.pi * (1 + g * g - 2 * g * np.asarray(cosine, float)) ** 1.5)


def layer_passes(depth: ArrayLike, cosine: ArrayLike) -> Array:
    """What passes a layer of light that comes at a cosine from the vertical; delta-Eddington.

    Parameters
    ----------
    depth : array-like
        Optical depth of the layer, straight up.
    cosine : array-like
        Of the light's zenith angle; below 0.02 it counts as that.

    Returns
    -------
    ndarray
        Straight and scattered light together; the rest went back up. Within 0.005 overhead.
    """
    t, c = np.asarray(depth, float), np.maximum(np.asarray(cosine, float), 0.02)
    straight = np.exp(-(1 - G * G) * t / c)
    return (2 / 3 + c + (2 / 3 - c) * straight) / (4 / 3 + (1 - G) * t)


def layer_passes_sky(depth: ArrayLike) -> Array:
    """The same of light that comes from all over the sky."""
    return 1 / (1 + 0.75 * (1 - G) * np.asarray(depth, float))


def facing_within(upright: ArrayLike, along: ArrayLike) -> Array:
    """`facing` of a place within a cloud, for `key_light`.

    Parameters
    ----------
    upright, along : array-like
        Optical depths of the whole lines through the cloud there, straight up and towards the light.

    Returns
    -------
    ndarray
        1 in a ball; in a wide layer the sine of the light's elevation, at least 0.1.
    """
    return np.clip(np.asarray(upright, float) / np.maximum(np.asarray(along, float), 1e-3), 0.1, 1.0)


def ambient_share(depth_above: ArrayLike, depth_below: ArrayLike) -> Array:
    """Share of the sky in a piece's ambient light, 0..1; the ground has the rest.

    Diffuse light from above and from below a slab that absorbs nothing crosses over linearly in depth.

    Parameters
    ----------
    depth_above, depth_below : array-like
        Optical depths straight up to the cloud's top and straight down to its base.
    """
    above, below = np.asarray(depth_above, float), np.asarray(depth_below, float)
    return (2 / 3 + (1 - G) * below) / (4 / 3 + (1 - G) * (above + below))


def ambient_share_of_three(depth_above: ArrayLike, depth_below: ArrayLike, depth_aside: ArrayLike) -> Array:
    """The same where the optical depth to the nearest side is known too.

    Each way out lets light in as it passes it, ``1 / (2/3 + (1 - g) τ)``; for two ways that is
    `ambient_share`. Half of what comes from aside is the sky's.
    """
    above, below, aside = (
        1 / (2 / 3 + (1 - G) * np.asarray(d, float)) for d in (depth_above, depth_below, depth_aside)
    )
    return (above + 0.5 * aside) / (above + below + aside)


def line_depths(
    boxes: np.ndarray, start: ArrayLike, direction: ArrayLike, extinction: float = 1.0
) -> tuple[Array, Array]:
    """Optical depths of straight lines through one cloud's boxes, ahead and behind.

    Each box counts as its ellipsoid cut off at the base. Where stretches overlap, together they are no longer
    than from the first's beginning to the last's end: for two boxes exact, for the shipped models as good as
    their true union. Against the integral of the field's density without noise: deeper by a fifth to a
    quarter (humilis, which is mostly soft edge, by nearly half), 0.4 of the mean root mean square (0.6).

    Parameters
    ----------
    boxes : (m,) of `shapes.BOX`
    start, direction : (n, 3), (3,)
        In the model's space; a step of `direction` is one unit of `extinction`'s length.
    extinction : float
        In the middle of the cloud.

    Returns
    -------
    ahead, behind : (n,)
    """
    p, d = np.atleast_2d(np.asarray(start, float)), np.asarray(direction, float)
    c, s = boxes["cosine"].astype(float), boxes["sine"].astype(float)
    size = REACH * boxes["half"].astype(float)

    def local(v: Array) -> Array:
        turned = c * v[..., 0] + s * v[..., 1], c * v[..., 1] - s * v[..., 0], v[..., 2] + 0 * c
        return np.stack(turned, -1) / size

    q, e = local(p[:, None] - boxes["centre"].astype(float)), local(d[None, None])
    ee = (e * e).sum(-1)
    middle = -(q * e).sum(-1) / ee
    room = 1 - (q * q).sum(-1) + middle**2 * ee
    reach = np.sqrt(np.maximum(room, 0) / ee)
    low, high = middle - reach, middle + reach
    base = (-p[:, 2] / d[2])[:, None] if abs(d[2]) > 1e-9 else None
    if base is not None:
        low, high = (np.maximum(low, base), high) if d[2] > 0 else (low, np.minimum(high, base))
    hit = (room > 0) & (high > low)
    density = boxes["density"].astype(float)

    def joined(a: Array, b: Array) -> Array:
        there = hit & (b > a)
        stretches = np.where(there, (b - a) * density, 0).sum(1)
        first, last = np.where(there, a, 1e9).min(1), np.where(there, b, 0).max(1)
        return MEAN * extinction * np.minimum(stretches, np.maximum(last - first, 0))

    return joined(np.maximum(low, 0), np.maximum(high, 0)), joined(np.maximum(-high, 0), np.maximum(-low, 0))
