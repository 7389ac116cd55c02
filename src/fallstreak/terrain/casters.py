"""The shadow of the ground's mesh: the nodes that a map seen along the light holds, drawn into it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ..gpu import FrameGraph
from .frame import TERRAIN_FRAME

MAX_NODES = 2048
"""Most nodes in a map."""


def add_casters(
    graph: FrameGraph,
    name: str,
    *,
    view: str,
    depth: str,
    when: Callable[[], bool],
    order: float,
    grid: int,
    constants: dict[str, Any],
    flags: dict[str, bool],
) -> None:
    """Declare the passes that draw the ground into a map; see `Terrain.add_casters`.

    Parameters
    ----------
    grid : int
        Quads along a node's side.
    constants, flags : dict
        Of the clipmap.
    """
    own = {part: f"{name}.terrain.{part}" for part in ("nodes", "draws", "workgroups", "heights")}
    graph.buffer(own["nodes"], 8 * MAX_NODES, persistent=True)
    graph.buffer(own["draws"], 20, usage=("indirect",), persistent=True)
    graph.buffer(own["workgroups"], 12, usage=("indirect",), persistent=True)
    graph.buffer(own["heights"], 8 * MAX_NODES * (grid + 1) ** 2, persistent=True)
    options: dict[str, Any] = {"structs": [TERRAIN_FRAME], "constants": constants, "when": when}
    options["order"] = order
    graph.compute(
        f"{name}.terrain.selection",
        "package::terrain::selection",
        bind={
            "view": view,
            "terrain": "terrain.frame",
            "bounds": "terrain.bounds",
            "nodes": own["nodes"],
            "draws": own["draws"],
            "workgroups": own["workgroups"],
        },
        groups=(1, 1, 1),
        flags={"ALL_ROUND": True},
        **options,
    )
    graph.compute(
        f"{name}.terrain.heights",
        "package::terrain::heights_pass",
        bind={
            "terrain": "terrain.frame",
            "shapes": "terrain.shape",
            "shifts": "terrain.shift",
            "nodes": own["nodes"],
            "heights": own["heights"],
        },
        groups=own["workgroups"],
        flags=flags,
        **options,
    )
    graph.render(
        f"{name}.terrain.mesh",
        "package::terrain::caster",
        fragment=None,
        depth=depth,
        bind={
            "view": view,
            "terrain": "terrain.frame",
            "heights": own["heights"],
            "nodes": own["nodes"],
        },
        indirect=own["draws"],
        index="terrain.index",
        indices=6 * grid**2,
        **options,
    )
