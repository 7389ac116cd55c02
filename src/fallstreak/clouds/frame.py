"""What every pass of the clouds is told of a frame: worked out in float64, shaders get differences."""

from __future__ import annotations

from collections.abc import Sequence
from math import floor
from typing import TYPE_CHECKING, Any

import numpy as np

from ..gpu import Struct
from ..world.state import FrameState, map_coordinates

if TYPE_CHECKING:
    from .layers import Layer

NOISE_PERIOD = 64
"""Tiles of noise after which the origin of the noise's coordinates begins again."""


def cloud_frame(layers: int) -> Struct:
    """The uniform `CloudFrame` of so many layers."""
    count = f"{layers}>"
    return Struct(
        "CloudFrame",
        [
            ("camera_map", "vec2f", "m, camera on the map, east and north of the anchor"),
            ("camera_height", "f32", "m above sea level"),
            ("planet_radius", "f32", "m"),
            ("key", "vec3f", "unit, towards the light that counts: the sun, at night the moon; world axes"),
            ("visibility", "f32", "m"),
            ("cells", "u32", "along a side of each layer's window"),
            ("seed", "u32", "of the world"),
            ("time", "f32", "s of scene time, modulo 4096, for what swirls"),
            (
                "windows",
                f"array<vec4f, {count}",
                "m, camera to the low corner; m, a cell; life",
            ),
            (
                "origins",
                f"array<vec4i, {count}",
                "cell in the low corner; generation; 1: there are lives",
            ),
            ("slabs", f"array<vec4f, {count}", "m: lowest base, highest top, thickness; 1/m"),
            ("covers", f"array<vec4f, {count}", "coverage; need; clustering; how far from the cell's middle"),
            (
                "sizes",
                f"array<vec4f, {count}",
                "least and greatest; m, spread of bases; most growth",
            ),
            ("noises", f"array<vec4f, {count}", "m: the camera in the noise's coordinates; m, a tile"),
            (
                "looks",
                f"array<vec4f, {count}",
                "of the noise: strength, edge, m of base; stretch",
            ),
            ("winds", f"array<vec4f, {count}", "unit, whereto it blows; shear, m/m; share of fine noise"),
            ("kinds", f"array<vec4u, {count}", "first model, models, seed, 1 + layer of the coverage maps"),
        ],
    )


def key_light(light: np.ndarray, up: np.ndarray) -> np.ndarray:
    """Unit direction towards sun or moon, whichever lights the clouds.

    Clouds twelve kilometres up lose the sun when it stands some 3.5 degrees under the horizon; the moon takes
    over later, where neither shows.

    Parameters
    ----------
    light : record of ``sky.light``
    up : (3,), the vertical at the camera
    """
    sun = np.asarray(light["sun_direction"], np.float64)
    moon = np.asarray(light["moon_direction"], np.float64)
    moonlit = float(np.asarray(light["moon_illuminance"])[1]) > 0.0
    return moon if float(up @ sun) < np.sin(np.radians(-7.0)) and moonlit else sun


def frame_values(
    layers: Sequence[Layer], state: FrameState, *, cells: int, visibility: float, key: np.ndarray
) -> dict[str, Any]:
    """Every field of `cloud_frame` for a frame.

    Parameters
    ----------
    layers : the world's, resolved
    cells : along a side of each layer's window
    visibility : m
    key : (3,), see `key_light`
    """
    camera = np.array(map_coordinates(state.camera.position, state.planet_radius))
    windows, origins, noises = [], [], []
    for layer in layers:
        drifting = camera - layer.wind * state.time
        first = [floor(x / layer.cell) - cells // 2 for x in drifting]
        corner = [i * layer.cell - x for i, x in zip(first, drifting, strict=True)]
        generation, life = layer.lives(state.time)
        windows.append((*corner, layer.cell, life))
        origins.append((*first, generation, int(layer.lifetime > 0.0)))
        period = NOISE_PERIOD * layer.noise.tile
        noises.append((*(x % period for x in drifting), state.altitude % period, layer.noise.tile))
    return {
        "camera_map": camera,
        "camera_height": state.altitude,
        "planet_radius": state.planet_radius,
        "key": key,
        "visibility": visibility,
        "cells": cells,
        "seed": state.seed & 0xFFFFFFFF,
        "time": state.time % 4096.0,
        "windows": windows,
        "origins": origins,
        "noises": noises,
    }


def layer_values(layers: Sequence[Layer]) -> dict[str, Any]:
    """The fields of `cloud_frame` that do not change from frame to frame."""
    return {
        "slabs": [(*layer.bounds, layer.thickness, layer.extinction) for layer in layers],
        "covers": [(x.coverage, x.need, x.clustering, x.jitter) for x in layers],
        "sizes": [(*x.scales, x.base_spread, x.growth) for x in layers],
        "looks": [(x.noise.strength, x.noise.edge, x.noise.base, x.noise.stretch) for x in layers],
        "winds": [(*x.wind_direction, x.noise.shear, x.noise.fine) for x in layers],
        "kinds": [(x.first_model, x.model_count, x.seed, 0 if x.map is None else 1 + x.map) for x in layers],
    }
