"""Extinction of one layer at places: float64 twin of ``density.wesl``.

The field F at a place is the sum over the boxes of the clouds around of ``(1 - x/2)^2``, x the squared
distance from the box's middle in units of its ellipsoid: 1/4 on the surface of a lone one. Noise shifts it,
and density rises from 0 to 1 between F = 1/4 and 1/4 + the width of the edge.
"""

from __future__ import annotations

import numpy as np

from ..shapes import SWELL
from . import volume
from .layers import FINER, SURFACE, Layer

_CHUNK = 1 << 20  # pairs of places and boxes at a time


def gathered(
    layer: Layer, boxes: np.ndarray, models: np.ndarray, clouds: np.ndarray, pairs: np.ndarray,
    points: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:  # fmt: skip
    """The field at places, and the same weighted by extinction.

    Parameters
    ----------
    boxes, models : arrays of `shapes.BOX` and `shapes.MODEL`
    clouds : (m,) of `CLOUD`
    pairs : (n, 9) integers
        Rows of `clouds` that each place may be in.
    points : (n, 3)
        East, north, height, m.

    Returns
    -------
    field, water : (n,)
        Without unit; 1/m.
    """
    field, water = np.zeros(len(points)), np.zeros(len(points))
    for column in pairs.T:
        cloud = clouds[column]
        way = points[:, :2] - cloud["place"]
        up = points[:, 2] - cloud["base"]
        near = (way * way).sum(1) < cloud["radius"] ** 2
        near &= (cloud["formation"] > 0.0) & (up > 0.0) & (points[:, 2] < cloud["top"])
        at = np.flatnonzero(near)
        if not len(at):
            continue
        cloud, way, up = cloud[at], way[at], up[at]
        c, s = np.cos(cloud["yaw"]), np.sin(cloud["yaw"])
        turned = np.stack([c * way[:, 0] + s * way[:, 1], c * way[:, 1] - s * way[:, 0]], 1)
        place = np.column_stack([turned / cloud["scale"][:, :1], up / cloud["scale"][:, 1]])
        t = np.clip(up / layer.soft, 0.0, 1.0)
        weight = cloud["formation"] * t * t * (3.0 - 2.0 * t)
        thick = 0.6 + 0.4 * up / (cloud["top"] - cloud["base"])
        for model in np.unique(cloud["model"]):
            of_model = np.flatnonzero(cloud["model"] == model)
            first, count = models[model]["first"][:2]
            k = _boxes(boxes[first : first + count], place[of_model], cloud["swell"][of_model])
            where = at[of_model]
            field[where] += k.sum(1) * weight[of_model]
            dense = k @ boxes[first : first + count]["density"].astype(float)
            water[where] += dense * (weight * cloud["extinction"] * thick)[of_model]
    return field, water


def _boxes(boxes: np.ndarray, places: np.ndarray, swell: np.ndarray) -> np.ndarray:
    """The field of each box at places in the model's space, (n, boxes)."""
    out = np.empty((len(places), len(boxes)))
    rows = max(_CHUNK // max(len(boxes), 1), 1)
    c, s = boxes["cosine"].astype(float), boxes["sine"].astype(float)
    turn = np.stack([np.stack([c, s]), np.stack([-s, c])])
    centre = boxes["centre"].astype(float)
    middle = turn[:, 0] * centre[:, 0] + turn[:, 1] * centre[:, 1]
    size = SWELL * boxes["half"].T.astype(float)
    for start in range(0, len(places), rows):
        part = places[start : start + rows]
        wider = SWELL * swell[start : start + rows, None]
        x = (part[:, 2:] - centre[:, 2]) / size[2]
        x *= x
        for axis in (0, 1):
            y = part[:, :2] @ turn[axis]
            y -= middle[axis]
            y /= size[axis] + wider
            y *= y
            x += y
        x *= -0.5
        x += 1.0
        np.maximum(x, 0.0, out=x)
        np.multiply(x, x, out=out[start : start + rows])
    return out


def noise_at(layer: Layer, points: np.ndarray, time: float) -> np.ndarray:
    """Two sizes of the layer's mixture of noise, 0 to 1, carried by its wind."""
    along, across = noise_axes(layer)
    drifting = points[:, :2] - np.asarray(layer.wind) * time
    up = points[:, 2] - layer.base
    u = drifting @ along + layer.genus.shear * up * np.hypot(*along)
    p = np.stack([u, drifting @ across, up * np.hypot(*across)], 1)
    look = np.array(layer.genus.look)
    coarse = volume.sample(p)
    fine = volume.sample(FINER * p + np.array([0.0, 0.0, 0.37]))
    return (0.65 * coarse + 0.35 * fine) @ look


def noise_axes(layer: Layer) -> tuple[np.ndarray, np.ndarray]:
    """Repeats of the coarse noise per metre, along the wind and across."""
    way = np.array([np.cos(layer.towards), np.sin(layer.towards)])
    return way / (layer.tile * layer.genus.stretch), np.array([-way[1], way[0]]) / layer.tile


def eaten(layer: Layer, field: np.ndarray, noise: np.ndarray) -> np.ndarray:
    """Density, 0 to 1, of a field and the noise there."""
    genus = layer.genus
    value = field + genus.amplitude * (noise - 0.5) * np.minimum(4.0 * field, 1.0)
    t = np.clip((value - SURFACE) / genus.edge, 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t)
