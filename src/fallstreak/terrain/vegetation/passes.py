"""The GPU passes of plants and rocks: squares in sight, what stands in them, a draw per kind and level.

Python's share of a frame is one uniform: cells, instances and draw arguments are made on the GPU.
"""

from __future__ import annotations

from collections.abc import Callable
from math import ceil, cos, exp, floor, log2, radians, sin
from typing import Any

import numpy as np

from ...gpu import FrameGraph
from ...gpu.mips import MipMaker
from ...world.state import FrameState, map_coordinates
from ..cover import palette as cover_palette
from ..frame import TERRAIN_FRAME
from . import cards
from .casters import add_casters, caster_rooms
from .flora import FLORA, affinity
from .stands import IMPOSTOR, LEVELS, Stand, index_count, plants_struct, stands_of

VIEWS = 8
"""An impostor has VIEWS × VIEWS pictures over the upper half of all directions."""

PERIOD = 64.0
"""s; every sway repeats itself after this time, see plant.wesl."""

START, AHEAD = 4.0, 2.0
"""So many times as high over the ground as plants are drawn from, their impostors' pictures are made in the
first frame, and in later ones."""

_SQUARE = 8  # cells along a side of what one workgroup looks at
_COLOR = ("gbuffer.albedo", "gbuffer.normal", "gbuffer.surface", "gbuffer.motion")
_LAST_MIP = 4


class Vegetation:
    """Declares plants and rocks in a graph.

    Parameters
    ----------
    graph : FrameGraph
        Must already hold the G-buffer, `view`, `terrain.frame` and what `ground` binds.
    world : World
        ``terrain.material``, ``terrain.vegetation`` and ``terrain.wind``.
    quality : Quality
        ``vegetation_radius`` (m) and ``vegetation_pixels`` (heights on the screen below which the coarse
        mesh, and the impostor, take over).
    palette : names of the six base materials that the cover's shares belong to
    ground : WESL module with `ground_at` and `height_near`
    bind : what the ground's module binds, resource by variable
    constants, flags : of the ground's module
    cover_level : callable, m -> level of the clipmap that covers such a radius

    Attributes
    ----------
    stands : what may stand here, in the order of the draws' arguments
    capacity : how many instances there is room for
    """

    def __init__(
        self,
        graph: FrameGraph,
        world: Any,
        quality: Any,
        palette: tuple[str, ...],
        *,
        ground: str = "package::terrain::vegetation::ground",
        bind: dict[str, str] | None = None,
        constants: dict[str, Any] | None = None,
        flags: dict[str, bool] | None = None,
        cover_level: Any = None,
    ):
        country = FLORA.get(world.terrain.material, {}) if world.terrain.vegetation > 0.0 else {}
        self._pixels = quality.vegetation_pixels
        self.stands = stands_of(country, float(quality.vegetation_radius))
        self.capacity = sum(sum(s.room) for s in self.stands)
        if not self.stands:
            return
        self._struct = plants_struct(len(self.stands))
        self._plants = graph.uniform("plants", self._struct)
        self._near, self._above = True, 0.0
        self._first, self._has_shadows = True, False
        # kinds whose impostors have no pictures yet, and those that get them in this frame
        self._unmade = [i for i, s in enumerate(self.stands) if s.kind.tile is not None]
        self._making: list[int] = []
        self._reach = [[0.0] * LEVELS for _ in self.stands]
        self._light = graph.uniforms.get("sky.light")
        self._cover_level = cover_level or (lambda radius: 0)
        self._across = [2 * ceil((s.radius + 20.0) / (_SQUARE * s.kind.cell)) + 2 for s in self.stands]
        self._plants.set(**self._fixed(world, palette))
        drawn = cards.cards({cards.BARK, *(s.kind.leaf for s in self.stands)})
        graph.texture_data("plants.cards", drawn, "rgba8unorm", dimension="2d-array", mips=True)
        graph.buffer_data("plants.square", np.array([0, 1, 2, 2, 1, 3], np.uint32), usage=("index",))
        self._ground = {
            "module": ground,
            "bind": bind or {},
            "constants": constants or {},
            "flags": flags or {},
        }
        self._add_placement(graph, ground, bind or {}, constants or {}, flags or {})
        for index, stand in enumerate(self.stands):
            self._add_draws(graph, index, stand)

    @property
    def casts(self) -> bool:
        """Whether anything may throw a shadow in this frame."""
        return bool(self.stands) and self._near

    def add_casters(
        self,
        graph: FrameGraph,
        name: str,
        *,
        view: str,
        depth: str,
        when: Callable[[], bool],
        order: float = 0.0,
    ) -> None:
        """Declare passes that draw plants and stones into a map seen along the light.

        Parameters
        ----------
        name : str
            First part of the names of the passes and buffers declared here.
        view : str
            A `VIEW` uniform: the camera's values but for ``clip_from_world``, the light's orthographic
            matrix of positions relative to the camera, depth 1 nearest to the light and 0 farthest, and
            ``size``, the map's. What stands before the near side is put on it.
        depth : str
            The map.
        when : callable
            Whether the map is due; asked every frame.
        """
        if not self.stands:
            return
        self._has_shadows = True
        add_casters(
            graph,
            name,
            self.stands,
            view=view,
            depth=depth,
            when=lambda: self.casts and when(),
            order=order,
            plants=self._struct,
            squares=sum(a * a for a in self._across),
            views=VIEWS,
            ground=self._ground,
        )

    @classmethod
    def on_clipmap(cls, graph: FrameGraph, world: Any, quality: Any, clip: Any) -> Vegetation:
        """Plants on the ground that a `ClipmapPasses` keeps."""
        names = ("surface", "cover_a", "cover_b", "tint")
        bind = {name: f"terrain.{name}" for name in names}
        narrowest = (16 * clip.clip.tiles - 48) * clip.spacing * 0.97

        def level(radius: float) -> int:
            return min(max(ceil(log2((radius + 20.0) / narrowest)), 0), clip.levels - 1)

        return cls(
            graph,
            world,
            quality,
            cover_palette(world.terrain.material),
            bind={
                **bind,
                "shapes": "terrain.shape",
                "shifts": "terrain.shift",
                "repeat": "sampler:linear-repeat",
            },
            constants={"GRID": int(quality.terrain_grid), **clip.constants},
            flags=clip.flags,
            cover_level=level,
        )

    def _fixed(self, world: Any, palette: tuple[str, ...]) -> dict[str, Any]:
        stands, speed = self.stands, float(world.terrain.wind)
        whereto = radians(70.0)  # a wind from west-southwest
        shares = np.zeros((len(stands), 6))
        for i, s in enumerate(stands):
            shares[i, : len(palette)] = affinity(s.species, palette)
        return {
            "wind": (speed * sin(whereto), speed * cos(whereto)),
            "gust_rate": round(PERIOD * speed / 80.0) / PERIOD,
            "density": float(world.terrain.vegetation),
            "seed": (world.seed * 2654435761 + 977) & 0xFFFFFFFF,
            "sizes": [(*s.species.heights, s.species.rarity, s.kind.leans) for s in stands],
            "affinity_a": shares[:, :4],
            "affinity_b": [
                (*row[4:], s.species.growth, s.species.slope) for row, s in zip(shares, stands, strict=True)
            ],
            "tint_a": [(*s.species.tints[0], s.species.of_ground) for s in stands],
            "tint_b": [(*s.species.tints[1], 0.0) for s in stands],
            "counts": [
                (index_count(s.kind, level), s.first[level], s.room[level], 0)
                for s in stands
                for level in range(LEVELS)
            ],
        }

    def _add_placement(
        self,
        graph: FrameGraph,
        ground: str,
        bind: dict[str, str],
        constants: dict[str, Any],
        flags: dict[str, bool],
    ) -> None:
        graph.buffer("plants.squares", 4 * sum(a * a for a in self._across), persistent=True)
        graph.buffer("plants.workgroups", 12, usage=("indirect",), persistent=True)
        graph.buffer("plants.draws", 20 * LEVELS * len(self.stands), usage=("indirect",), persistent=True)
        graph.buffer("plants.placed", 32 * self.capacity, persistent=True)
        common = {"view": "view", "terrain": "terrain.frame", "plants": "plants", **bind}
        constants = {"KINDS": len(self.stands), "LEVELS": LEVELS, "GROUND": ground, **constants}
        structs = [TERRAIN_FRAME, self._struct]
        graph.compute(
            "plants.select",
            "package::terrain::vegetation::select",
            bind={
                **common,
                "squares": "plants.squares",
                "workgroups": "plants.workgroups",
                "draws": "plants.draws",
            },
            groups=(1, 1, 1),
            structs=structs,
            constants=constants,
            flags=flags,
            when=self._is_near,
        )
        graph.compute(
            "plants.placement",
            "package::terrain::vegetation::placement",
            bind={**common, "squares": "plants.squares", "draws": "plants.draws", "placed": "plants.placed"},
            groups="plants.workgroups",
            structs=structs,
            constants=constants,
            flags=flags,
            when=self._is_near,
        )

    def _add_draws(self, graph: FrameGraph, index: int, stand: Stand) -> None:
        kind = stand.kind
        layers = {"LEAF_LAYER": kind.leaf, "BARK_LAYER": cards.BARK}
        stone = kind.tile is None
        for level in range(LEVELS if stone else 2):
            mesh = kind.mesh(level)
            name = f"plants.{kind.name}{level}"
            graph.buffer_data(f"{name}.vertices", mesh.vertices)
            graph.buffer_data(f"{name}.index", mesh.indices, usage=("index",))
            graph.render(
                name,
                "package::terrain::vegetation::draw",
                color=_COLOR,
                depth="gbuffer.depth",
                bind={
                    "view": "view",
                    "plants": "plants",
                    "placed": "plants.placed",
                    "vertices": f"{name}.vertices",
                    "cards": "plants.cards",
                    "repeating": "sampler:linear-repeat",
                },
                indirect="plants.draws",
                indirect_offset=20 * (index * LEVELS + level),
                index=f"{name}.index",
                structs=[self._struct],
                constants={"FIRST": stand.first[level], **layers},
                flags={"STONE": stone},
                when=lambda level=level: self._is_near() and self._above < self._reach[index][level],
            )
        if kind.tile is not None:
            self._add_impostor(graph, index, stand)

    def _add_impostor(self, graph: FrameGraph, index: int, stand: Stand) -> None:
        kind = stand.kind
        assert kind.tile is not None
        mesh, name = kind.mesh(0), f"plants.{kind.name}"
        size = (VIEWS * kind.tile[0], VIEWS * kind.tile[1])
        away = mesh.vertices["place"] - np.array([0.0, 0.0, 0.5], np.float32)
        # not constants: one shader draws all kinds, and a driver compiles it once
        graph.uniform(f"{name}.impostor", IMPOSTOR).set(
            half_width=1.02 * float(np.hypot(away[:, 0], away[:, 1]).max()),
            half_height=1.02 * mesh.reach,
            tile_height=kind.tile[1],
            first=stand.first[2],
            caster=caster_rooms(self.stands)[index][0],
            leaf_layer=kind.leaf,
        )

        def making() -> bool:
            return index in self._making

        for part in ("looks", "shapes"):
            graph.texture(f"{name}.{part}", "rgba8unorm", size, mips=_LAST_MIP + 1, persistent=True)
        graph.texture(f"{name}.depth", "depth32float", size, persistent=True)
        graph.render(
            f"{name}.bake",
            "package::terrain::vegetation::bake",
            color=(f"{name}.looks:mip0", f"{name}.shapes:mip0"),
            depth=f"{name}.depth",
            bind={
                "vertices": f"{name}0.vertices",
                "cards": "plants.cards",
                "repeating": "sampler:linear-repeat",
                "impostor": f"{name}.impostor",
            },
            index=f"{name}0.index",
            indices=len(mesh.indices),
            instances=VIEWS**2,
            structs=[IMPOSTOR],
            constants={"VIEWS": VIEWS, "BARK_LAYER": cards.BARK},
            when=making,
        )
        maker = MipMaker.of(graph.device)

        def mips(context: Any) -> None:
            for part in ("looks", "shapes"):
                texture = context.resource(f"{name}.{part}")
                maker.record(context.encoder, texture, "rgba8unorm", (*size, 1), _LAST_MIP + 1)

        written = [f"{name}.{part}:mip{m}" for part in ("looks", "shapes") for m in range(1, _LAST_MIP + 1)]
        graph.add_pass(
            f"{name}.mips",
            reads=[f"{name}.looks:mip0", f"{name}.shapes:mip0"],
            writes=written,
            record=mips,
            when=making,
        )
        graph.render(
            f"{name}2",
            "package::terrain::vegetation::impostor",
            color=_COLOR,
            depth="gbuffer.depth",
            bind={
                "view": "view",
                "plants": "plants",
                "placed": "plants.placed",
                "looks": f"{name}.looks",
                "shapes": f"{name}.shapes",
                "linear": "sampler:linear-clamp",
                "impostor": f"{name}.impostor",
            },
            indirect="plants.draws",
            indirect_offset=20 * (index * LEVELS + 2),
            index="plants.square",
            structs=[self._struct, IMPOSTOR],
            constants={"VIEWS": VIEWS, "LAST_MIP": float(_LAST_MIP)},
            when=self._is_near,
        )

    def _sine_of_sun(self, state: FrameState) -> float:
        """Of the sun's elevation at the camera; without a sky it stands overhead."""
        if self._light is None:
            return 1.0
        up = state.camera.position + np.array([0.0, 0.0, state.planet_radius])
        return float(self._light.record["sun_direction"] @ up / np.linalg.norm(up))

    def _is_near(self) -> bool:
        """Whether anything may be within its radius."""
        return self._near

    def _made_ahead(self, away: float) -> list[int]:
        """Kinds whose impostors' pictures a frame makes though nobody draws them yet.

        All at the start, which takes its time anyhow, when plants may come near soon; one a frame later on.
        `away`: the camera's height over that at which plants are drawn. Near, the graph makes what it reads.
        """
        first, self._first = self._first, False
        made: list[int] = []
        if away < 1.0:
            self._unmade = []
        elif self._unmade and away < (START if first else AHEAD):
            made = self._unmade if first else self._unmade[:1]
            self._unmade = self._unmade[len(made) :]
        return made

    def update(self, state: FrameState, above: float = 0.0) -> None:
        """Set the uniform of a frame; `above` is the camera's height over the ground, m."""
        if not self.stands:
            return
        # ground elsewhere may be higher than below the camera, but hardly by as much as it is away
        reach = 2.0 * max(s.radius for s in self.stands)
        self._above, self._near = above, above < reach
        self._making = self._made_ahead(above / reach)
        east, north = map_coordinates(state.camera.position, state.planet_radius)
        pixel = 2.0 * np.tan(0.5 * state.camera.fov) / state.size[1]
        windows, grids, levels = [], [], []
        away = [1.0 / (p * pixel) for p in self._pixels]
        for stand, across in zip(self.stands, self._across, strict=True):
            cell = stand.kind.cell
            middle = [_SQUARE * floor(x / (_SQUARE * cell)) for x in (east, north)]
            windows.append((*middle, across, self._cover_level(stand.radius)))
            grids.append((east - middle[0] * cell, north - middle[1] * cell, cell, stand.radius))
            levels.append((*away, *stand.farthest))
        self._reach = [
            [
                *(
                    2.0 * min(a * s.species.heights[1], most)
                    for a, most in zip(away, s.farthest, strict=True)
                ),
                2.0 * s.radius,
            ]
            for s in self.stands
        ]
        self._plants.set(
            windows=windows,
            grids=grids,
            levels=levels,
            time=state.time % PERIOD,
            before=(state.time - state.delta) % PERIOD,
            sun_shade=0.0 if self._has_shadows else _sun_shade(self._sine_of_sun(state)),
        )


def _sun_shade(sine: float) -> float:
    """Of the sun's light that crowns take on its way down into a dense wood: the more the lower it stands."""
    return 0.28 + 0.67 * (1.0 - exp(-0.15 / max(sine, 0.02)))
