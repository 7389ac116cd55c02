"""Where the cloud-shadow map lies: float64, each frame."""

from __future__ import annotations

from math import hypot, sin, sqrt
from typing import TYPE_CHECKING, Any

import numpy as np

from ..field.uniform import KNOTS
from ..light import REACH

if TYPE_CHECKING:
    from ..field import Field

REACHES = (3e3, 12e3, 48e3)
"""m from the camera to the sides of the maps in one another."""
FAINTEST = 0.26
"""Clouds that have formed less have no matter yet."""
_PATCH = 24  # cells to each side by whose clouds `mean_density` goes
LOWEST = sin(np.radians(2.0))
"""The key light throws shadows as if it stood at least so high (sine of its elevation)."""


def lumps(boxes: np.ndarray, models: np.ndarray) -> np.ndarray:
    """One ellipsoid for each cloud model, with as much matter and the same spread: what distant shadows take.

    Parameters
    ----------
    boxes : array of `shapes.BOX`
    models : array of `shapes.MODEL`

    Returns
    -------
    ndarray (2 len(models), 4) float32
        Middle in the model's space, density; horizontal and vertical half size, -, -.
    """
    out = np.zeros((len(models), 2, 4), np.float32)
    for row, model in zip(out, models, strict=True):
        mine = boxes[model["first"][0] :][: model["first"][1]]
        half = REACH * mine["half"].astype(float)
        far = np.abs(mine["centre"]).max(0) + half.max()
        axes = [np.linspace(-f, f, 20) for f in far[:2]] + [np.linspace(0.0, far[2], 20)]
        points = np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(-1, 1, 3)
        v = points - mine["centre"].astype(float)
        c, s = mine["cosine"].astype(float), mine["sine"].astype(float)
        turned = np.stack([c * v[..., 0] + s * v[..., 1], c * v[..., 1] - s * v[..., 0], v[..., 2]], -1)
        density = (mine["density"] * (((turned / half) ** 2).sum(-1) < 1.0)).max(1)
        mass = density.sum()
        middle = (density[:, None] * points[:, 0]).sum(0) / mass
        spread = (density[:, None] * (points[:, 0] - middle) ** 2).sum(0) / mass
        # an even ellipsoid spreads by a fifth of its squared half size
        wide, high = sqrt(2.5 * (spread[0] + spread[1])), sqrt(5.0 * spread[2])
        volume = mass * float(np.prod([a[1] - a[0] for a in axes]))
        row[0] = *middle, volume / (4.0 / 3.0 * np.pi * wide * wide * high)
        row[1, :2] = wide, high
    return out.reshape(-1, 4)


def mean_density(field: Field, layer: int, lumps: np.ndarray) -> float:
    """Mean density of a layer's matter within the ellipsoids of its clouds' boxes.

    Soft edges take from it; noise takes and adds; where clouds overlap, their fields close the gaps between
    them. The layer's calibration knows what there is in the end.

    Parameters
    ----------
    field : Field
    layer : int
    lumps : array from `lumps`
    """
    mine = field.layers[layer]
    cells = np.stack(np.meshgrid(*[np.arange(-_PATCH, _PATCH)] * 2), -1).reshape(-1, 2)
    clouds = field.clouds(layer, cells, 0.0)
    clouds = clouds[clouds["formation"] > FAINTEST]
    table = lumps.reshape(-1, 2, 4)[clouds["model"]].astype(float)
    formed = (2.0 - clouds["formation"] ** -0.5) ** 1.5
    scale = clouds["scale"].astype(float)
    wide = table[:, 1, 0] + REACH * clouds["swell"]
    volumes = 4.0 / 3.0 * np.pi * table[:, 0, 3] * wide**2 * table[:, 1, 1]
    ellipsoids = float((formed * volumes * scale[:, 0] ** 2 * scale[:, 1]).sum()) / len(cells) / mine.cell**2
    filled = float(np.interp(mine.coverage, KNOTS, field.calibrations[layer].filled[:, -1]))
    # there is less water near the base: .6 + .4 of the height in the cloud
    return 0.78 * float(np.clip(filled / max(ellipsoids, 1e-6), 0.2, 4.0))


def main_wind(field: Field) -> np.ndarray:
    """Wind of the layer that throws most of the shadows, m/s east and north."""
    dark = [layer.coverage * layer.extinction * (layer.bounds[1] - layer.bounds[0]) for layer in field.layers]
    return np.array(field.layers[int(np.argmax(dark))].wind)


def local_key(key: np.ndarray, up: np.ndarray) -> np.ndarray:
    """The direction to the light in map space: east, north, up at the camera.

    Parameters
    ----------
    key, up : (3,)
        Unit, world axes; `up` is the vertical at the camera.

    Returns
    -------
    ndarray (3,)
        Unit, lifted to `LOWEST`.
    """
    tilt = float(up[:2] @ key[:2])
    across = key[:2] - up[:2] * (key[2] + tilt / (1.0 + up[2]))
    # the smallest turn that brings `up` to the vertical, as sphere.wesl has it
    flat = np.array([*across, up[2] * key[2] + tilt])
    if flat[2] >= LOWEST:
        return flat
    level = hypot(flat[0], flat[1]) or 1.0
    return np.array([*(flat[:2] / level * sqrt(1.0 - LOWEST**2)), LOWEST])


def shadow_values(
    key: np.ndarray, camera: np.ndarray, heights: tuple[float, float], texels: int
) -> dict[str, Any]:
    """Every field of `CLOUD_SHADOW` for a frame.

    Parameters
    ----------
    key : (3,)
        From `local_key`.
    camera : (2,)
        On the map, m.
    heights : (float, float)
        Between which all clouds are, m above the sea.
    texels : int
        Along a side of a map.
    """
    level = hypot(key[0], key[1])
    across = np.array([-key[1] / level, key[0] / level, 0.0]) if level > 1e-6 else np.array([1.0, 0.0, 0.0])
    along = np.cross(key, across)
    low, high = heights
    middle = 0.5 * high
    maps = []
    for reach in REACHES:
        sizes = reach, float(reach * key[2] + 0.5 * high * level)
        maps.append(_snapped((float(camera @ across[:2]), float(camera @ along[:2])), sizes, texels))
    maps.append(_snapped((float(camera[0]), float(camera[1])), (REACHES[-1], REACHES[-1]), texels))
    return {
        "key": key,
        "middle": middle,
        "across": across,
        "low": low,
        "along": along,
        "per_height": 1.0 / max(high - low, 1.0),
        "blur": 0.5 * (low + high),
        "maps": maps,
    }


def _snapped(
    camera: tuple[float, float], sizes: tuple[float, float], texels: int
) -> tuple[float, float, float, float]:
    """Middle of a map as seen from the camera, and its half sizes: texels stand still in the world."""
    texel = [2.0 * size / texels for size in sizes]
    middle = [round(c / t) * t - c for c, t in zip(camera, texel, strict=True)]
    return middle[0], middle[1], sizes[0], sizes[1]
