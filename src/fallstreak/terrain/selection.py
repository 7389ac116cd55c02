"""CPU twin (float64) of ``selection.wesl`` and of the morph in ``mesh.wesl``: the tests' measure."""

from __future__ import annotations

from typing import Any

import numpy as np

from .projection import map_from_world, world_from_map
from .pyramid import BOUND_LEVELS, Pyramid

MORPH_START = 0.83


def select_nodes(
    pyramid: Pyramid, frame: dict[str, Any], clip_from_world: np.ndarray, camera: np.ndarray, radius: float
):
    """Nodes that are drawn for a camera.

    Parameters
    ----------
    pyramid : Pyramid
    frame : dict
        Of `Terrain.frame_values`.
    clip_from_world : (4, 4), of camera-relative positions
    camera : (3,) world position, m
    radius : planet radius, m

    Returns
    -------
    (count, 3) int: x, y, level
    """
    out, queue = [], [(0, 0)]
    for level in range(frame["depth"] + 1):
        size = 2.0 * pyramid.extent / 2**level
        following = []
        for x, y in queue:
            corner = np.array([x, y]) * size - pyramid.extent
            if not _is_visible(
                pyramid,
                frame,
                corner,
                size,
                _bounds(pyramid, frame, x, y, level),
                clip_from_world,
                camera,
                radius,
            ):
                continue
            offset = corner - frame["camera_map"]
            d = np.maximum(np.maximum(offset, -(offset + size)), 0.0)
            nearest = np.sqrt(d @ d + frame["camera_above"] ** 2)
            if level == frame["depth"] or nearest >= 0.5 * frame["range"] * size:
                out.append((x, y, level))
            else:
                following += [(2 * x + i, 2 * y + j) for j in (0, 1) for i in (0, 1)]
        queue = following
    return np.array(out, int).reshape(-1, 3)


def _bounds(pyramid: Pyramid, frame: dict[str, Any], x: int, y: int, level: int) -> np.ndarray:
    q = min(level, BOUND_LEVELS - 1)
    low, high = pyramid.bounds[q][y >> (level - q), x >> (level - q)]
    return np.array([low - frame["bump_bound"], high + frame["bump_bound"]], float)


def _is_visible(pyramid, frame, corner, size, heights, clip_from_world, camera, radius) -> bool:
    d = np.maximum(np.maximum(corner, -(corner + size)), 0.0)
    if d @ d > pyramid.extent**2:
        return False
    places = corner + size * np.array([[0, 0], [1, 0], [0, 1], [1, 1], [0.5, 0.5]])
    points = world_from_map(places[:, :1], places[:, 1:], heights[None, :], radius).reshape(-1, 3) - camera
    bend = size * size / (4.0 * radius)
    low, high = points.min(0) - bend, points.max(0) + bend
    centre, half = 0.5 * (low + high), 0.5 * (high - low)
    m = clip_from_world
    for plane in (m[3] + m[0], m[3] - m[0], m[3] + m[1], m[3] - m[1], m[3]):
        if plane[:3] @ centre + plane[3] + np.abs(plane[:3]) @ half < 0.0:
            return False
    base = radius + frame["lowest"]
    eye = max(float(map_from_world(camera, radius)[2]) - frame["lowest"], 0.0)
    top = max(heights[1] - frame["lowest"], 0.0)
    away = np.maximum(np.maximum(low, -high), 0.0)
    return bool(np.linalg.norm(away) <= np.sqrt(eye * (2 * base + eye)) + np.sqrt(top * (2 * base + top)))


def morphed(frame: dict[str, Any], node: np.ndarray, grid: int) -> np.ndarray:
    """Vertices of a node as `mesh.wesl` moves them.

    Returns
    -------
    ((grid + 1)², 3) float64: offset east and north from the camera, and the distance between vertices there,
    m
    """
    x, y, level = (int(v) for v in node)
    size = frame["leaf"] * 2 ** (frame["depth"] - level)
    corner = np.array([x, y]) * size - frame["extent"] - np.array(frame["camera_map"])
    unit = size / grid
    index = np.arange((grid + 1) ** 2)
    out = np.empty((len(index), 3))
    for i, at in enumerate(np.stack([index % (grid + 1), index // (grid + 1)], 1)):
        bit, step, shift, offset = 1, unit, frame["depth"] - level, corner + at * unit
        for _ in range(4):
            distance = np.sqrt(offset @ offset + frame["camera_above"] ** 2)
            reach = frame["range"] * step * grid
            part = float(np.clip((distance / reach - MORPH_START) / (1.0 - MORPH_START), 0.0, 1.0))
            odd = (np.array([x, y]) * grid + at) & bit
            offset = corner + (at - odd * part) * unit
            if part < 1.0 or shift == frame["depth"]:
                step *= 1.0 + part
                break
            at, bit, step, shift = at - odd, bit * 2, step * 2.0, shift + 1
        out[i] = (*offset, step)
    return out
