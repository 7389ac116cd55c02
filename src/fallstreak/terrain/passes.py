"""The ground's GPU passes: selection of nodes, the mesh into the G-buffer, the globe beyond it."""

from __future__ import annotations

from math import cos, floor, hypot, sin, sqrt, tan
from typing import Any

import numpy as np

from ..gpu import Device, FrameGraph, Struct
from ..world.state import FrameState, map_coordinates
from .model import LEAF_DEPTH, SEED, TerrainModel, first_octave, terrain_model
from .pyramid import SIZE

TERRAIN_FRAME = Struct(
    "TerrainFrame",
    [
        ("camera_map", "vec2f", "m, camera on the map, east and north of the anchor"),
        ("camera_local", "vec2f", "m, camera_map − tile, exact"),
        ("camera_fraction", "vec2f", "m, from the corner of the camera's leaf cell to the camera"),
        ("camera_cell", "vec2i", "leaf cell under the camera"),
        ("tile", "vec2i", "m, whole multiple of 4096 near the camera: the origin of noise"),
        ("camera_height", "f32", "m above sea level"),
        ("camera_above", "f32", "m above the ground below"),
        ("sun", "vec3f", "unit, towards the sun, world axes"),
        ("pole", "vec3f", "the planet's north pole in world axes"),
        ("extent", "f32", "m, half the width of the map"),
        ("leaf", "f32", "m, width of the smallest node"),
        ("range", "f32", "a node is drawn up to this many of its own widths away"),
        ("spacing", "f32", "m between texels of level 0"),
        ("levels", "f32", "number of levels"),
        ("lowest", "f32", "m, lowest ground anywhere"),
        ("bump_bound", "f32", "m, largest bump"),
        ("globe_height", "f32", "m above sea level of the sphere beyond the terrain"),
        ("map_cosine", "f32", "cosine of the angle of the terrain's round map; 2 where there is none"),
        ("land_near", "f32", "1 where the planet near the anchor must be land, -1 sea"),
        ("depth", "u32", "quadtree level of the leaves"),
        ("indices", "u32", "of one node's mesh"),
        ("seed", "u32", "of all noise here"),
    ],
)

MAX_NODES = 2048
RINGS, SECTORS = 48, 128
SHORE = 512
_SURFACES = {"ocean": 0, "land": 1, "mars": 2}
_COLOR = ("gbuffer.albedo", "gbuffer.normal", "gbuffer.surface", "gbuffer.motion")
_TILE = 4096


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
    """

    def __init__(self, device: Device, graph: FrameGraph, world: Any, quality: Any, size: tuple[int, int]):
        self.model: TerrainModel = terrain_model(world)
        self._grid = int(quality.terrain_grid)
        # Twice to four times the error is what one edge of the mesh may measure on the screen.
        self._edge_px = 4.0 * float(quality.terrain_error_px)
        self._frame = graph.uniform("terrain.frame", TERRAIN_FRAME)
        self._light = graph.uniforms.get("sky.light")  # without a sky the sun stands overhead
        self._sees_globe = True
        self._is_island = world.terrain.source == "file" and world.terrain.surroundings == "sea"
        self._fixed = self._fixed_values(world)
        self._frame.set(**self._fixed)
        surface = (
            "mars"
            if world.terrain.material == "mars" and world.planet.surface != "ocean"
            else world.planet.surface
        )
        if self.model.pyramid is not None:
            self._add_ground(graph, world, quality, _SURFACES[surface])
        self._add_globe(graph, quality, _SURFACES[surface])

    def _add_ground(self, graph: FrameGraph, world: Any, quality: Any, surface: int) -> None:
        pyramid = self.model.pyramid
        assert pyramid is not None
        # the lowlands that a far view goes over; single deep valleys open no view across the map
        self._lowland = float(np.percentile(pyramid.bounds[6][..., 0], 25))
        graph.texture_data("terrain.coefficients", pyramid.coefficients, "r32float", dimension="2d-array")
        graph.texture_data("terrain.surface", pyramid.surface, "rgba16float", dimension="2d-array")
        graph.buffer_data("terrain.bounds", np.concatenate([b.reshape(-1, 2) for b in pyramid.bounds]))
        graph.buffer_data("terrain.index", grid_indices(self._grid), usage=("index",))
        graph.buffer("terrain.nodes", 8 * MAX_NODES)
        graph.buffer("terrain.draws", 20, usage=("indirect",))
        graph.buffer("terrain.workgroups", 12, usage=("indirect",))
        graph.buffer("terrain.heights", 4 * MAX_NODES * (self._grid + 1) ** 2)
        graph.texture("terrain.shore", "rgba8unorm", (SHORE, SHORE), persistent=True)
        graph.compute(
            "terrain.shore",
            "package::terrain::shore",
            bind={"view": "view", "terrain": "terrain.frame", "output": "terrain.shore"},
            groups=(SHORE // 8, SHORE // 8, 1),
            structs=[TERRAIN_FRAME],
            constants={"SURFACE_KIND": surface, "PLANET_OCTAVES": quality.terrain_planet_octaves},
            when=lambda: False,  # in the first frame alone
        )
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
        )
        graph.compute(
            "terrain.heights",
            "package::terrain::heights_pass",
            bind={
                "terrain": "terrain.frame",
                "coefficients": "terrain.coefficients",
                "nodes": "terrain.nodes",
                "heights": "terrain.heights",
            },
            groups="terrain.workgroups",
            structs=[TERRAIN_FRAME],
            constants={"GRID": self._grid, "FIRST_OCTAVE": first_octave(pyramid.spacing)},
        )
        graph.render(
            "terrain.gbuffer",
            "package::terrain::draw",
            color=_COLOR,
            depth="gbuffer.depth",
            bind={
                "view": "view",
                "terrain": "terrain.frame",
                "heights": "terrain.heights",
                "surface": "terrain.surface",
                "linear": "sampler:linear-clamp",
                "nodes": "terrain.nodes",
                "workgroups": "terrain.workgroups",
                "shore": "terrain.shore",
            },
            indirect="terrain.draws",
            index="terrain.index",
            indices=6 * self._grid**2,
            structs=[TERRAIN_FRAME],
            flags={
                "MARS": world.terrain.material == "mars",
                "SEA": self._is_island,
                "CROWNS": True,
                "PARCELS": True,
                "STONES": True,
                "LEAVES": quality.terrain_bump_finest < 0,
            },
            constants={
                "GRID": self._grid,
                "FIRST_OCTAVE": first_octave(pyramid.spacing),
                "NORMAL_FINEST": quality.terrain_bump_finest,
                "STONE_FINEST": 1 if quality.terrain_bump_finest >= 0 else -2,
                "GROUND_FINEST": quality.terrain_bump_finest - 3,
                "SURFACE_KIND": surface,
                "PLANET_OCTAVES": quality.terrain_planet_octaves,
            },
        )

    def _add_globe(self, graph: FrameGraph, quality: Any, surface: int) -> None:
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
            constants={
                "RINGS": RINGS,
                "SECTORS": SECTORS,
                "SURFACE_KIND": surface,
                "PLANET_OCTAVES": quality.terrain_planet_octaves,
            },
            order=1,
        )

    def update(self, state: FrameState) -> None:
        """Set the uniforms of a frame, after the sky has set its own."""
        moving = self._moving_values(state)
        self._sees_globe = self.model.pyramid is None or self._sees_beyond(moving, state.planet_radius)
        if self._light is not None:
            self._frame.set(sun=self._light.record["sun_direction"])
        self._frame.set(**moving)

    def _sees_beyond(self, moving: dict[str, Any], radius: float) -> bool:
        """Whether the horizon may lie outside of the terrain's round map."""
        assert self.model.pyramid is not None
        eye = max(moving["camera_height"] - self._lowland, 0.0)
        top = max(self._fixed["globe_height"] - self._lowland, 0.0)
        sight = sqrt(eye * (2.0 * radius + eye)) + sqrt(2.0 * radius * top)
        return hypot(*moving["camera_map"]) + sight > 0.97 * self.model.pyramid.extent

    def frame_values(self, state: FrameState) -> dict[str, Any]:
        """All fields of `TerrainFrame` for a camera; what the CPU twin of the selection starts from."""
        return {**self._fixed, **self._moving_values(state)}

    def _fixed_values(self, world: Any) -> dict[str, Any]:
        latitude, pyramid = world.place.latitude_radians, self.model.pyramid
        values: dict[str, Any] = {
            "seed": (world.seed + SEED) & 0xFFFFFFFF,
            "sun": (0.0, 0.0, 1.0),
            "pole": (0.0, cos(latitude), sin(latitude)),
            "globe_height": 0.0,
            "map_cosine": 2.0,
            "land_near": 0.0,
        }
        if pyramid is not None:
            values.update(
                extent=pyramid.extent,
                leaf=2.0 * pyramid.extent / 2**LEAF_DEPTH,
                spacing=pyramid.spacing,
                levels=pyramid.levels,
                lowest=float(pyramid.bounds[0][0, 0, 0]) - bump_bound(pyramid.spacing),
                bump_bound=bump_bound(pyramid.spacing),
                globe_height=pyramid.outside,
                map_cosine=cos(0.975 * pyramid.extent / world.planet.radius),
                land_near=-1.0 if self._is_island else 1.0,
                depth=LEAF_DEPTH,
                indices=6 * self._grid**2,
            )
        return values

    def _moving_values(self, state: FrameState) -> dict[str, Any]:
        east, north = map_coordinates(state.camera.position, state.planet_radius)
        height, pyramid = state.altitude, self.model.pyramid
        if pyramid is None:
            return {"camera_map": (east, north), "camera_height": height}
        leaf, extent = self._fixed["leaf"], pyramid.extent
        cell = (floor((east + extent) / leaf), floor((north + extent) / leaf))
        tile = (floor(east / _TILE) * _TILE, floor(north / _TILE) * _TILE)
        pixel = 2.0 * tan(0.5 * state.camera.fov) / state.size[1]
        return {
            "camera_map": (east, north),
            "camera_height": height,
            "camera_local": (east - tile[0], north - tile[1]),
            "camera_fraction": (east + extent - cell[0] * leaf, north + extent - cell[1] * leaf),
            "camera_cell": cell,
            "tile": tile,
            "camera_above": max(height - nearest_height(pyramid, east, north), 0.0),
            "range": max(1.0 / (self._grid * self._edge_px * pixel), 1.5),
        }


def bump_bound(spacing: float) -> float:
    """The sum of all octaves of bumps at the roughest, every one at its largest value, m."""
    return 0.05 * 1.25 * 2.0 ** (first_octave(spacing) + 1)


def nearest_height(pyramid: Any, east: float, north: float) -> float:
    """Height of the finest texel at a place, m: enough for the level of detail, in microseconds."""
    for level in range(pyramid.levels):
        spacing = pyramid.spacing * 2**level
        i, j = int(north / spacing + SIZE / 2), int(east / spacing + SIZE / 2)
        if 0 <= i < SIZE and 0 <= j < SIZE:
            return float(pyramid.coefficients[level, i, j])
    return pyramid.outside


def grid_indices(columns: int, rows: int | None = None) -> np.ndarray:
    """Two triangles per quad of a grid, all diagonals one way so that the coarser grid's are among them."""
    rows = columns if rows is None else rows
    i, j = np.meshgrid(np.arange(columns), np.arange(rows))
    a = (j * (columns + 1) + i).ravel()
    quads = np.stack([a, a + 1, a + columns + 2, a, a + columns + 2, a + columns + 1], 1)
    return quads.astype(np.uint32).ravel()
