"""Which kinds of plants a country has, the room that their instances need, and what shaders are told."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, pi, sqrt
from typing import Any

from ...gpu import Struct
from .flora import FLORA, KINDS, Kind, Species

LEVELS = 3
"""Levels of detail: fine mesh, coarse mesh, impostor (of stones: a few triangles)."""


def plants_struct(kinds: int) -> Struct:
    """The uniform `Plants` of so many kinds."""
    return Struct(
        "Plants",
        [
            ("wind", "vec2f", "m/s, whereto it blows"),
            ("gust_rate", "f32", "gusts per second that pass a place"),
            ("density", "f32", "of all that grows, 0..1"),
            ("sun_shade", "f32", "of the sun that a dense wood keeps from its floor"),
            ("time", "f32", "s, modulo 64"),
            ("before", "f32", "the same of the frame before"),
            ("seed", "u32", "of what stands where"),
            ("windows", f"array<vec4i, {kinds}>", "cell in the middle, squares across, level of cover"),
            (
                "grids",
                f"array<vec4f, {kinds}>",
                "m from that cell to the camera; m, width of a cell; radius, m",
            ),
            ("sizes", f"array<vec4f, {kinds}>", "m, lowest and highest; rarity; how far it leans"),
            ("levels", f"array<vec4f, {kinds}>", "heights away where the coarser levels start; most m"),
            ("affinity_a", f"array<vec4f, {kinds}>", "density per share of the palette's materials 0 to 3"),
            ("affinity_b", f"array<vec4f, {kinds}>", "of 4 and 5, and of growth; steepest slope"),
            ("tint_a", f"array<vec4f, {kinds}>", "albedo, and how much of it is the ground's"),
            ("tint_b", f"array<vec4f, {kinds}>", "albedo at the other end"),
            ("counts", f"array<vec4u, {kinds * LEVELS}>", "indices; first place, room"),
        ],
    )


IMPOSTOR = Struct(
    "Impostor",
    [
        ("half_width", "f32", "of a picture, in heights of the plant"),
        ("half_height", "f32", "the same"),
        ("tile_height", "f32", "rows of a picture"),
        ("first", "u32", "place of the kind's first instance"),
        ("caster", "u32", "and of its first one that throws a shadow"),
        ("leaf_layer", "i32", "of the cards, that of its leaves"),
    ],
)
"""The uniform of a kind whose pictures stand for it far away."""


def tree_radius(world: Any, quality: Any) -> float:
    """How far trees stand about the camera, m; 0 where none ever grow."""
    country = FLORA.get(world.terrain.material, {})
    trees = any(kind.reach == 1.0 and kind.name in country for kind in KINDS)
    return float(quality.vegetation_radius) if trees and world.terrain.vegetation > 0.5 else 0.0


@dataclass(frozen=True)
class Stand:
    """A kind as a country has it, and the room for its instances."""

    kind: Kind
    species: Species
    radius: float
    farthest: tuple[float, float]  # m, where the coarse mesh and the impostor have taken over at the latest
    first: tuple[int, int, int]
    room: tuple[int, int, int]


def index_count(kind: Kind, level: int) -> int:
    """Indices of a level of detail."""
    return 6 if level == 2 and kind.tile else len(kind.mesh(level).indices)


def stands_of(country: dict[str, Species], radius: float) -> list[Stand]:
    """The kinds of a country with room for as many as can ever stand within each level's distance."""
    stands = []
    first = 0
    for kind in KINDS:
        if kind.name not in country:
            continue
        species = country[kind.name]
        own = radius * kind.reach
        fine = min(9.0 * species.heights[1], own)
        coarse = min(30.0 * species.heights[1], own)
        near, middle, far = (_room(r, kind.cell) for r in (fine, coarse, own))
        places = (first, first + near, first + near + middle)
        stands.append(Stand(kind, species, own, (fine, coarse), places, (near, middle, far)))
        first += near + middle + far
    return stands


def _room(radius: float, cell: float) -> int:
    """Cells of which a part may lie within a radius."""
    return ceil(pi * (radius + cell * sqrt(2.0)) ** 2 / cell**2)
