"""Base materials: what the ground is made of when one stands on it.

Fifteen materials, each a square picture that repeats: colour, height, slopes, roughness and the sky that its
hollows see, baked from noise by ``script/build_materials.py``. A place of the ground is a mixture of six of
them, its palette (as in the Infinity journal, which combines textures by what a place is like);
``ground.wesl`` mixes them in the pixel, by height, so that grass stands in the joints of rock and not half
over it.

Cost: 2 × 21 MB of texture with mips; loading takes some 0.25 s.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from ...gpu import FrameGraph
from .library import MATERIALS, SIDE, Material

__all__ = ["MATERIALS", "SIDE", "Material", "add_materials", "ground_constants", "load_materials"]

_DATA = Path(__file__).parent / "data"
_LINEAR = np.round((np.arange(256) / 255.0) ** 2 * 255.0).astype(np.uint8)  # the pictures hold square roots
_ROUGHER = 0.08  # hollows are rougher than what sticks out


@lru_cache(maxsize=1)
def load_materials() -> tuple[np.ndarray, np.ndarray]:
    """The texture arrays.

    Returns
    -------
    color : (layers, SIDE, SIDE, 4) uint8
        rgb: detail, mean 1/2 in each channel: albedo = mean albedo · 2 · texel. a: height by rank: each value
        is as frequent as any other, mean 1/2.
    shape : (layers, SIDE, SIDE, 4) uint8
        rg: slopes towards +u and +v, (code − 128)/127 · steepest. b: roughness. a: share of the sky in view.
        Rows run towards +v (north, or up on walls).
    """
    from PIL import Image

    color = np.empty((len(MATERIALS), SIDE, SIDE, 4), np.uint8)
    shape = np.empty_like(color)
    for name, material in MATERIALS.items():
        with Image.open(_DATA / f"{name}.jpg") as picture:
            color[material.layer, ..., :3] = _LINEAR[np.asarray(picture)]
        with Image.open(_DATA / f"{name}.shape.jpg") as picture:
            planes = np.asarray(picture).reshape(4, SIDE, SIDE)
        color[material.layer, ..., 3] = planes[0]
        rough = material.roughness + _ROUGHER * (0.5 - np.arange(256) / 255.0)
        shape[material.layer, ..., 0] = planes[1]
        shape[material.layer, ..., 1] = planes[2]
        shape[material.layer, ..., 2] = np.round(255.0 * np.clip(rough, 0.0, 1.0)).astype(np.uint8)[planes[0]]
        shape[material.layer, ..., 3] = planes[3]
    return color, shape


def add_materials(graph: FrameGraph) -> None:
    """Declare ``terrain.material_color`` and ``terrain.material_shape``, with mips."""
    color, shape = load_materials()
    graph.texture_data("terrain.material_color", color, "rgba8unorm", dimension="2d-array", mips=True)
    graph.texture_data("terrain.material_shape", shape, "rgba8unorm", dimension="2d-array", mips=True)


def ground_constants(palette: Sequence[str], bare_radius: float = 0.0) -> dict[str, Any]:
    """The compile-time constants of ``ground.wesl``.

    Parameters
    ----------
    palette : six names of `MATERIALS`
    bare_radius : float
        m: nearer to the eye than this, `canopy` is what lies under it, because there trees stand. 0: nowhere.

    Raises
    ------
    ValueError
        When `palette` is not six known names.
    """
    unknown = [name for name in palette if name not in MATERIALS]
    if unknown or len(palette) != 6:
        wrong = f"{unknown[0]!r} is none" if unknown else f"{len(palette)} are given"
        raise ValueError(f"a palette is six of {', '.join(MATERIALS)}; {wrong}")
    chosen = [MATERIALS[name] for name in palette]
    floor = next((name for name in _FLOORS if name in palette), "")
    if "canopy" not in palette or not floor:
        bare_radius = 0.0
    under, litter = (MATERIALS[name].albedo for name in (floor or "forest_floor", "forest_floor"))
    return {
        "SEEN": [(*m.albedo, 1.0 / m.tile) for m in chosen],
        "MADE": [
            (m.steepest, float(m.layer), m.grows, _kind(name) + _ALIKE.get(name, 0.0) / 8.0)
            for name, m in zip(palette, chosen, strict=True)
        ],
        "TURNS": [_BEDDED if name in ("sandstone", "limestone") else _TURNED for name in palette],
        **_slots("CANOPY", "canopy", palette),
        **_slots("FLOOR", floor or "forest_floor", palette),
        # needles and leaves lie on whatever it is, much of it in the trees' shade, which nothing else draws
        "FLOOR_ALBEDO": tuple(0.45 * a + 0.25 * b for a, b in zip(under, litter, strict=True)),
        "BARE_RADIUS": float(bare_radius),
        "TEXELS": float(SIDE),
    }


# (5 cos, 5 sin) of the angle that a second copy of a tile is turned by; how far, in tiles, long waves push
# the copies along u and v: beds must stay level.
_TURNED, _BEDDED = (3.0, 4.0, 0.35, 0.35), (5.0, 0.0, 0.5, 0.08)


_FLOORS = ("forest_floor", "soil", "turf", "grass")
"""What may lie under trees: the first that a palette has."""

_ALIKE = {"sandstone": 1.0, "limestone": 1.0, "granite": 3.0, "basalt": 1.0}
"""Rock that looks the same many times larger, because cliffs have beds and joints as blocks do, and how much
bolder its slopes are then (below 8): granite's blocks are smooth, its faces are not."""


def _slots(constant: str, name: str, palette: Sequence[str]) -> dict[str, Any]:
    """Which of the six shares is that of a material."""
    places = tuple(1.0 if other == name else 0.0 for other in palette)
    return {f"{constant}_A": places[:4], f"{constant}_B": places[4:]}


def _kind(name: str) -> int:
    """The G-buffer's material id (gbuffer.wesl): rock 4, plants 3, other ground 0."""
    rock = ("sandstone", "limestone", "granite", "scree", "basalt")
    return 4 if name in rock else 3 if name in ("canopy", "shrubs", "grass", "turf") else 0
