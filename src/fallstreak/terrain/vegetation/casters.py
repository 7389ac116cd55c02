"""The shadows of plants and stones, chosen all round the camera and drawn along the light.

Few things are drawn, and cheaply: a plant is one square with the picture of it that looks along the light,
leaning from its foot to behind its crown, which therefore does not shade itself. A compute pass works out all
that a square's corners need; squares near the light come first, so that they hide the others. Nothing sways:
what a map holds may be kept for many frames.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from ...gpu import FrameGraph, Struct
from ..frame import TERRAIN_FRAME
from .stands import IMPOSTOR, Stand, index_count

ROOM = 32768
"""Most casters of a kind in one map."""

LEAST, WHOLE = 1.5, 14.0
"""Texels: lower things throw no shadow, and of those lower than WHOLE a part stands for all."""

_WORDS = 12  # 32-bit words of a caster

EYE = Struct(
    "Eye", [("place", "vec3f", "m, camera-relative, world axes: plants are chosen as seen from there")]
)


def caster_rooms(stands: Sequence[Stand]) -> list[tuple[int, int]]:
    """First place and room of each kind's casters."""
    rooms, first = [], 0
    for stand in stands:
        room = min(stand.room[2], ROOM)
        rooms.append((first, room))
        first += room
    return rooms


def casters_struct(kinds: int) -> Struct:
    """The uniform `Casters` of so many kinds."""
    return Struct(
        "Casters",
        [
            ("least", "f32", "texels high that what throws a shadow must be"),
            ("whole", "f32", "texels; of what is lower only some are drawn, the wider"),
            ("counts", f"array<vec4u, {kinds}>", "indices; first place, room"),
            (
                "pictures",
                f"array<vec4f, {kinds}>",
                "an impostor's half width and height, rows; 0: a mesh",
            ),
        ],
    )


def add_casters(
    graph: FrameGraph,
    name: str,
    stands: Sequence[Stand],
    *,
    view: str,
    depth: str,
    when: Callable[[], bool],
    order: float,
    plants: Struct,
    squares: int,
    views: int,
    ground: dict[str, Any],
) -> None:
    """Declare the passes that draw plants and stones into a map seen along the light.

    Parameters
    ----------
    name : str
        First part of the names of the passes and buffers declared here, and of the uniform ``.eye``: from
        where plants are taken to be seen. Who keeps a map sets a place that does not follow the camera.
    view, depth : names
        As of `Vegetation.add_casters`.
    plants : Struct
        Of the uniform ``plants``.
    squares : int
        Most squares of cells within all kinds' radii.
    views : int
        Of an impostor, along a side.
    ground : dict
        ``module``, ``bind``, ``constants``, ``flags`` of the ground they stand on.
    """
    kinds = len(stands)
    rooms = caster_rooms(stands)
    struct = casters_struct(kinds)
    if "plants.casters" not in graph.uniforms:
        graph.uniform("plants.casters", struct).set(
            least=LEAST,
            whole=WHOLE,
            counts=[(_indices(s), *room, 0) for s, room in zip(stands, rooms, strict=True)],
            pictures=[_picture(graph, s) for s in stands],
        )
    graph.uniform(f"{name}.eye", EYE)
    own = {part: f"{name}.plants.{part}" for part in ("squares", "workgroups", "draws", "placed")}
    graph.buffer(own["squares"], 4 * squares, persistent=True)
    graph.buffer(own["workgroups"], 12, usage=("indirect",), persistent=True)
    graph.buffer(own["draws"], 20 * kinds, usage=("indirect",), persistent=True)
    graph.buffer(own["placed"], 4 * _WORDS * sum(room for _, room in rooms), persistent=True)
    options: dict[str, Any] = {
        "structs": [TERRAIN_FRAME, plants, struct, EYE],
        "flags": ground["flags"],
        "when": when,
        "order": order,
    }
    constants = {"KINDS": kinds, "VIEWS": views, "GROUND": ground["module"], **ground["constants"]}
    common = {
        "view": view,
        "terrain": "terrain.frame",
        "plants": "plants",
        "casters": "plants.casters",
        "eye": f"{name}.eye",
        "squares": own["squares"],
        "draws": own["draws"],
        **ground["bind"],
    }
    graph.compute(
        f"{name}.plants.select",
        "package::terrain::vegetation::caster_select",
        bind={**common, "workgroups": own["workgroups"]},
        groups=(1, 1, 1),
        constants=constants,
        **options,
    )
    graph.compute(
        f"{name}.plants.placement",
        "package::terrain::vegetation::caster_placement",
        bind={**common, "placed": own["placed"]},
        groups=own["workgroups"],
        constants=constants,
        **options,
    )
    for index, stand in enumerate(stands):
        kind = f"plants.{stand.kind.name}"
        drawn: dict[str, Any] = {
            "depth": depth,
            "indirect": own["draws"],
            "indirect_offset": 20 * index,
            "when": when,
            "order": order,
        }
        bind = {"view": view, "placed": own["placed"]}
        if stand.kind.tile is None:
            graph.render(
                f"{name}.{kind}",
                "package::terrain::vegetation::caster_stone",
                fragment=None,
                bind={**bind, "vertices": f"{kind}2.vertices"},
                index=f"{kind}2.index",
                constants={"FIRST": rooms[index][0]},
                **drawn,
            )
        else:
            graph.render(
                f"{name}.{kind}",
                "package::terrain::vegetation::caster_picture",
                bind={
                    **bind,
                    "impostor": f"{kind}.impostor",
                    "looks": f"{kind}.looks",
                },
                index="plants.square",
                structs=[IMPOSTOR],
                constants={"VIEWS": views},
                **drawn,
            )


def _indices(stand: Stand) -> int:
    return index_count(stand.kind, 2)


def _picture(graph: FrameGraph, stand: Stand) -> tuple[float, float, float, float]:
    if stand.kind.tile is None:
        return (0.0, 0.0, 0.0, 0.0)
    record = graph.uniforms[f"plants.{stand.kind.name}.impostor"].record
    return (float(record["half_width"]), float(record["half_height"]), float(record["tile_height"]), 0.0)
