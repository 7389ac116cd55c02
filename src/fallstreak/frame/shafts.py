"""Shadows of the land in the air, and shafts of light between them: the sweep says it, the sky's tables ask.

Each slice of each column of the tables of the air before the camera has a share of light, so that the light
scattered once is missing where the land is in its way. What was scattered before comes from all around.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from fallstreak.gpu import FrameGraph
from fallstreak.shadows.frame import SHADOWS
from fallstreak.sky.air import AIR

if TYPE_CHECKING:
    from fallstreak.shadows.sweep import Sweep
    from fallstreak.world import World


def land_shades(world: World) -> bool:
    """Whether the land of a world throws shadows into the air."""
    return world.shadows.technique == "stable" and world.terrain.source != "none"


def add_shafts(graph: FrameGraph, sweep: Sweep) -> None:
    """Write ``sky.shares``, which the sky has declared; after the shadows."""
    groups = [-(-n // 4) for n in graph.textures["sky.shares"].size]
    graph.compute(
        "frame.shafts",
        "package::frame::shafts",
        bind={
            "view": "view",
            "air": "sky.air",
            "shadows": "shadows.frame",
            "repeat": "sampler:linear-repeat",
            "output": "sky.shares",
            **sweep.bind,
        },
        groups=(groups[0], groups[1], groups[2]),
        structs=[AIR, SHADOWS],
        constants=sweep.constants,
    )
