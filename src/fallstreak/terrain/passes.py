"""The ground's GPU passes: selection of nodes, the mesh into the G-buffer, the globe beyond it."""

from __future__ import annotations

from collections.abc import Callable
from math import cos, floor, hypot, log2, sin, sqrt, tan
from typing import Any

import numpy as np

from ..gpu import Device, FrameGraph
from ..world.state import FrameState, map_coordinates
from .casters import add_casters
from .clipmap_passes import MIN_RANGE, ClipmapPasses
from .cover import palette as cover_palette
from .frame import TERRAIN_FRAME
from .land.levels import Levels
from .land.shape import land_values
from .materials import add_materials, ground_constants
from .model import COARSE, SEED, TerrainModel, terrain_model
from .near import NearGround
from .profile import Profile
from .vegetation import Vegetation, tree_radius
from .water import add_water, slope_variance, water_constants

MAX_NODES = 4096
RINGS, SECTORS = 48, 128
_SURFACES = {"ocean": 0, "land": 1, "mars": 2}
_COLOR = ("gbuffer.albedo", "gbuffer.normal", "gbuffer.surface", "gbuffer.motion")
_TILE = 4096
_FIRST = -2  # of all that is drawn: where there is depth by then, there is ground


class Terrain:
    """Declares the ground's resources and passes in a graph.

    Parameters
    ----------
    device : Device
    graph : FrameGraph
        Must already hold the G-buffer.
    world : World
    quality : Quality
        ``terrain_error_px`` and ``terrain_grid``.
    size : (width, height)
    show : "materials", optional
        The shares of the base materials in six colours instead of the ground's own.

    Attributes
    ----------
    wooded : bool
        Whether woods may be part of the ground.
    """

    def __init__(
        self,
        device: Device,
        graph: FrameGraph,
        world: Any,
        quality: Any,
        size: tuple[int, int],
        *,
        show: str | None = None,
    ):
        self.model: TerrainModel = terrain_model(world)
        self._grid = int(quality.terrain_grid)
        # Twice to four times the error is what one edge of the mesh may measure on the screen.
        self._edges_px = [4.0 * float(quality.terrain_error_px) / finer for finer in self.model.finer]
        self._frame = graph.uniform("terrain.frame", TERRAIN_FRAME)
        self._light = graph.uniforms.get("sky.light")  # without a sky the sun stands overhead
        self._sees_globe = True
        surface = (
            "mars"
            if world.terrain.material == "mars" and world.planet.surface != "ocean"
            else world.planet.surface
        )
        planet = {
            "SURFACE_KIND": _SURFACES[surface],
            "PLANET_OCTAVES": quality.terrain_planet_octaves,
            "SEA_ROUGHNESS": slope_variance(world.terrain.wind) ** 0.25,
        }
        self.wooded = self.model.land is not None and "canopy" in cover_palette(world.terrain.material)
        self.clip: ClipmapPasses | None = None
        self.profile: Profile | None = None
        self.vegetation: Vegetation | None = None
        if self.model.land is not None:
            self._near = NearGround(self.model)
            self.clip = ClipmapPasses(graph, self.model, world, quality, size, planet)
            self.profile = Profile.of(self.clip)
            add_materials(graph)
            self._add_ground(graph, world, quality, size, show)
            self.vegetation = Vegetation.on_clipmap(graph, world, quality, self.clip)
        self._fixed = self._fixed_values(world)
        self._frame.set(**self._fixed)
        self._add_globe(graph, planet)

    def _add_ground(
        self, graph: FrameGraph, world: Any, quality: Any, size: tuple[int, int], show: str | None
    ) -> None:
        assert self.clip is not None
        graph.buffer_data("terrain.index", grid_indices(self._grid), usage=("index",))
        graph.buffer("terrain.nodes", 8 * MAX_NODES)
        graph.buffer("terrain.draws", 20, usage=("indirect",))
        graph.buffer("terrain.workgroups", 12, usage=("indirect",))
        graph.buffer("terrain.heights", 8 * MAX_NODES * (self._grid + 1) ** 2)
        add_water(graph, world.seed)
        constants = {**self.clip.constants, "GRID": self._grid}
        graph.compute(
            "terrain.selection",
            "package::terrain::selection",
            bind={
                "view": "view",
                "terrain": "terrain.frame",
                "bounds": "terrain.bounds",
                "nodes": "terrain.nodes",
                "draws": "terrain.draws",
                "workgroups": "terrain.workgroups",
            },
            groups=(1, 1, 1),
            structs=[TERRAIN_FRAME],
            constants=constants,
            flags={"ALL_ROUND": False},
        )
        graph.compute(
            "terrain.heights",
            "package::terrain::heights_pass",
            bind={
                "terrain": "terrain.frame",
                "shapes": "terrain.shape",
                "shifts": "terrain.shift",
                "nodes": "terrain.nodes",
                "heights": "terrain.heights",
            },
            groups="terrain.workgroups",
            structs=[TERRAIN_FRAME],
            constants=constants,
            flags=self.clip.flags,
        )
        water = world.terrain.has_water and show is None
        graph.texture("terrain.seen", "rgba32uint", size)
        graph.render(
            "terrain.mesh",
            "package::terrain::draw",
            color=["terrain.seen"],
            depth="gbuffer.depth",
            bind={
                "view": "view",
                "terrain": "terrain.frame",
                "heights": "terrain.heights",
                "nodes": "terrain.nodes",
                "workgroups": "terrain.workgroups",
            },
            indirect="terrain.draws",
            index="terrain.index",
            indices=6 * self._grid**2,
            structs=[TERRAIN_FRAME],
            constants=constants,
            flags={"WATER": water},
            order=_FIRST,
        )
        graph.fullscreen(
            "terrain.gbuffer",
            "package::terrain::pixel",
            color=_COLOR,
            depth="gbuffer.depth",
            depth_compare="less",
            depth_in_turn=True,
            bind={
                "view": "view",
                "terrain": "terrain.frame",
                "places": "terrain.seen",
                "repeat": "sampler:linear-repeat",
                "surface": "terrain.surface",
                "cover_a": "terrain.cover_a",
                "cover_b": "terrain.cover_b",
                "tint": "terrain.tint",
                "material_color": "terrain.material_color",
                "material_shape": "terrain.material_shape",
                "waves": "terrain.waves",
            },
            structs=[TERRAIN_FRAME],
            constants={
                **constants,
                **ground_constants(cover_palette(world.terrain.material), tree_radius(world, quality)),
                **water_constants(world.terrain, world.seed, self.model.island),
            },
            flags={
                "TRIPLANAR": quality.terrain_detail >= 3,
                "MATERIAL_COPIES": quality.terrain_detail >= 2,
                "SHOW_MATERIALS": show == "materials",
                "WATER": water,
            },
            order=_FIRST,
        )

    def _add_globe(self, graph: FrameGraph, planet: dict[str, float]) -> None:
        graph.buffer_data("terrain.globe_index", grid_indices(SECTORS, RINGS), usage=("index",))
        graph.render(
            "terrain.globe",
            "package::terrain::globe",
            color=_COLOR,
            depth="gbuffer.depth",
            bind={"view": "view", "terrain": "terrain.frame"},
            index="terrain.globe_index",
            indices=6 * RINGS * SECTORS,
            instances=lambda: int(self._sees_globe),
            structs=[TERRAIN_FRAME],
            constants={"RINGS": RINGS, "SECTORS": SECTORS, **planet},
            order=1,
        )

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
        """Declare passes that draw the ground's mesh, as fine as it is seen, into a map seen along the light.

        Parameters
        ----------
        name, view, depth, when
            As of `Vegetation.add_casters`.
        """
        if self.clip is None:
            return
        add_casters(
            graph,
            name,
            view=view,
            depth=depth,
            when=when,
            order=order,
            grid=self._grid,
            constants={**self.clip.constants, "GRID": self._grid},
            flags=self.clip.flags,
        )

    def update(self, state: FrameState) -> None:
        """Set the uniforms of a frame, after the sky has set its own."""
        moving = self._moving_values(state)
        self._sees_globe = self.clip is None or self._sees_beyond(moving, state.planet_radius)
        if self._light is not None:
            self._frame.set(sun=self._light.record["sun_direction"])
        self._frame.set(**moving)
        if self.vegetation is not None:
            self.vegetation.update(state, moving["camera_above"])

    def _sees_beyond(self, moving: dict[str, Any], radius: float) -> bool:
        """Whether the horizon may lie outside of the terrain's round map."""
        lowland = self._fixed["lowest"]
        eye = max(moving["camera_height"] - lowland, 0.0)
        top = max(self._fixed["globe_height"] - lowland, 0.0)
        sight = sqrt(eye * (2.0 * radius + eye)) + sqrt(2.0 * radius * top)
        return hypot(*moving["camera_map"]) + sight > 0.97 * self.model.extent

    def frame_values(self, state: FrameState) -> dict[str, Any]:
        """All fields of `TerrainFrame` for a camera; what the CPU twin of the selection starts from."""
        return {**self._fixed, **self._moving_values(state)}

    def _fixed_values(self, world: Any) -> dict[str, Any]:
        latitude, model = world.place.latitude_radians, self.model
        values: dict[str, Any] = {
            "seed": (world.seed + SEED) & 0xFFFFFFFF,
            "sun": (0.0, 0.0, 1.0),
            "pole": (0.0, cos(latitude), sin(latitude)),
            "globe_height": 0.0,
            "map_cosine": 2.0,
            "land_near": 0.0,
        }
        if model.land is not None and self.clip is not None:
            lowest, highest = model.land.bounds()
            lowest = min(lowest, model.land.outside)
            highest = max(highest, model.land.outside, land_values(world.terrain)["water_level"])
            leaf = self._grid * self.clip.spacing
            values.update(
                extent=model.extent,
                leaf=leaf,
                lowest=lowest,
                highest=highest,
                globe_height=model.land.outside,
                map_cosine=cos(0.975 * model.extent / world.planet.radius),
                land_near=-1.0 if model.island else 1.0,
                depth=round(log2(2.0 * self.clip.half / leaf)),
                indices=6 * self._grid**2,
                clip_levels=self.clip.levels,
                shift_bound=model.land.shift_bound,
                coarse_level=log2(COARSE / self.clip.spacing) - 1.0,
            )
            if isinstance(model.land, Levels):
                pyramid = model.land.pyramid
                values.update(spacing=pyramid.spacing, levels=pyramid.levels)
        return values

    def _moving_values(self, state: FrameState) -> dict[str, Any]:
        east, north = map_coordinates(state.camera.position, state.planet_radius)
        height = state.altitude
        if self.clip is None:
            return {"camera_map": (east, north), "camera_height": height}
        leaf, half = self._fixed["leaf"], self.clip.half
        cell = (floor((east + half) / leaf), floor((north + half) / leaf))
        tile = (floor(east / _TILE) * _TILE, floor(north / _TILE) * _TILE)
        pixel = 2.0 * tan(0.5 * state.camera.fov) / state.size[1]
        above = self._near.distance(east, north, height)
        ranges = [
            min(max(1.0 / (self._grid * edge * pixel), MIN_RANGE), self.clip.range) for edge in self._edges_px
        ]
        return {
            "camera_map": (east, north),
            "camera_height": height,
            "camera_local": (east - tile[0], north - tile[1]),
            "camera_fraction": (east + half - cell[0] * leaf, north + half - cell[1] * leaf),
            "camera_cell": cell,
            "tile": tile,
            "camera_above": above,
            "range": ranges[0],
            "coarse_range": ranges[1],
            **self.clip.move(east, north, above * pixel),
        }


def grid_indices(columns: int, rows: int | None = None) -> np.ndarray:
    """Two triangles per quad of a grid, all diagonals one way so that the coarser grid's are among them."""
    rows = columns if rows is None else rows
    i, j = np.meshgrid(np.arange(columns), np.arange(rows))
    a = (j * (columns + 1) + i).ravel()
    quads = np.stack([a, a + 1, a + columns + 2, a, a + columns + 2, a + columns + 1], 1)
    return quads.astype(np.uint32).ravel()
