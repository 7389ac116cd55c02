"""The clipmap's passes: shape and cover of the tiles of ground that came into reach."""

from __future__ import annotations

from math import ceil, floor, hypot, log2, tan
from typing import Any

import numpy as np

from ..gpu import FrameGraph, Struct
from .clipmap import MAX_JOBS, MAX_LEVELS, TILE, Clipmap, packed_jobs
from .frame import TERRAIN_FRAME
from .land.character import first_octave
from .land.levels import Levels
from .land.shape import LAND, land_values
from .model import LANDS, TerrainModel

CLIP_JOBS = Struct(
    "ClipJobs",
    [
        ("windows", f"array<vec4i, {MAX_LEVELS}>", "first tile of each level's window"),
        ("packed", f"array<vec4u, {MAX_JOBS // 4}>", "level << 16 | row << 8 | column, tiles to do"),
    ],
)
MIN_RANGE = 1.5  # of its own widths that a node is drawn up to, however coarse the picture
MAX_DEPTH = 16  # of the quadtree: a node's column and row have 16 bits each
SHORE = 512
MOST_TILES = 32  # of a window's width; with all levels as many as there can be jobs
_KINDS = ("shape", "surface")


class ClipmapPasses:
    """Declares the clipmap in a graph and keeps it around the camera.

    Parameters
    ----------
    graph : FrameGraph
        Must already hold `terrain.frame`.
    model : TerrainModel
    world : World
    quality : Quality
        ``terrain_spacing``, ``terrain_texel_px``, ``terrain_tiles``, ``terrain_grid``.
    size : (width, height)
    planet : constants of `planet.wesl`

    Attributes
    ----------
    spacing : m between samples of level 0
    half : m, half the width of the quadtree: a power of two that holds the map
    levels : of the clipmap
    range : the most widths away that a node can be drawn and lie in its level's window
    finest : level, of use from the camera of the last `move`
    constants, flags : what shaders that look into the clipmap need
    """

    def __init__(
        self,
        graph: FrameGraph,
        model: TerrainModel,
        world: Any,
        quality: Any,
        size: tuple[int, int],
        planet: dict[str, float],
    ):
        land = model.land
        assert land is not None
        grid = int(quality.terrain_grid)
        self.half = 2.0 ** ceil(log2(model.extent))
        power = max(round(log2(quality.terrain_spacing)), round(log2(2.0 * self.half / grid)) - MAX_DEPTH)
        self.spacing = 2.0**power
        tiles = _tiles(model, world, quality, size)
        reach = 16 * tiles - 48  # samples
        # a node's parent begins within its range; the camera is within half a tile of the window's middle
        self.range = (16 * tiles - 16) / grid - 2.5
        self.levels = min(ceil(log2(2.0 * model.extent / (reach * self.spacing))) + 1, MAX_LEVELS)
        # the root and its children are always cut
        self.levels = min(self.levels, round(log2(2.0 * self.half / (grid * self.spacing))) - 1)
        self.clip = Clipmap(self.spacing, tiles, self.levels, model.extent)
        self._extent = model.extent
        self.finest = 0
        self._jobs = {kind: graph.uniform(f"terrain.{kind}_jobs", CLIP_JOBS) for kind in _KINDS}
        self._new: dict[str, np.ndarray] = {kind: np.zeros(0, np.uint32) for kind in _KINDS}
        graph.uniform("terrain.land", LAND).set(**land_values(world.terrain))
        self.flags = {"SHIFT": land.shift_bound > 0.0, "LEVELS": isinstance(land, Levels)}
        self.constants: dict[str, Any] = {
            "TILES": tiles,
            "SPACING": self.spacing,
            "SPACING_POWER": power,
            "COVER": f"package::terrain::cover::{world.terrain.material}",
            **planet,
        }
        # of these two the flag LEVELS leaves one unused
        self.constants["FIRST_OCTAVE"] = first_octave(
            land.pyramid.spacing if isinstance(land, Levels) else 1.0
        )
        source = world.terrain.source
        self.constants["LAND"] = f"package::terrain::land::{source if source in LANDS else 'canyons'}"
        if isinstance(land, Levels):
            graph.texture_data(
                "terrain.coefficients", land.pyramid.coefficients, "r32float", dimension="2d-array"
            )
            graph.texture_data("terrain.lost", land.pyramid.lost, "r32float", dimension="2d-array")
        self._declare(graph, planet)

    def _declare(self, graph: FrameGraph, planet: dict[str, float]) -> None:
        width = self.clip.tiles * TILE
        layers = (width, width, self.levels)
        for name, format in (
            ("shape", "rg32uint"),
            ("shift", "r32uint"),
            ("surface", "rgba16float"),
            ("cover_a", "rgba8unorm"),
            ("cover_b", "rgba8unorm"),
            ("tint", "rgba8unorm"),
        ):
            where = (4, 4, 1) if name == "shift" and not self.flags["SHIFT"] else layers
            graph.texture(f"terrain.{name}", format, where, dimension="2d-array", persistent=True)
        graph.buffer("terrain.bounds", 16 * self.levels * self.clip.tiles**2, persistent=True)
        graph.texture("terrain.shore", "rgba8unorm", (SHORE, SHORE), persistent=True)
        graph.compute(
            "terrain.shore",
            "package::terrain::shore",
            bind={"view": "view", "terrain": "terrain.frame", "output": "terrain.shore"},
            groups=(SHORE // 8, SHORE // 8, 1),
            structs=[TERRAIN_FRAME],
            constants=planet,
            when=lambda: False,  # in the first frame alone
        )
        bind = {"terrain": "terrain.frame", "land": "terrain.land", "shapes": "terrain.shape"}
        graph.compute(
            "terrain.shape",
            "package::terrain::shape_pass",
            bind={
                **bind,
                "jobs": "terrain.shape_jobs",
                "bounds": "terrain.bounds",
                "shifts": "terrain.shift",
                "coefficients": "terrain.coefficients",
                "lost": "terrain.lost",
            },
            groups=lambda: self._take("shape"),
            when=lambda: len(self._new["shape"]) > 0,
            structs=[TERRAIN_FRAME, CLIP_JOBS, LAND],
            constants=self.constants,
            flags=self.flags,
        )
        graph.compute(
            "terrain.surface",
            "package::terrain::surface_pass",
            bind={
                **bind,
                "jobs": "terrain.surface_jobs",
                "shifts": "terrain.shift",
                "shore": "terrain.shore",
                "linear": "sampler:linear-clamp",
                "surface": "terrain.surface",
                "cover_a": "terrain.cover_a",
                "cover_b": "terrain.cover_b",
                "tint": "terrain.tint",
            },
            groups=lambda: self._take("surface"),
            when=lambda: len(self._new["surface"]) > 0,
            structs=[TERRAIN_FRAME, CLIP_JOBS, LAND],
            constants=self.constants,
            flags=self.flags,
        )

    def move(self, east: float, north: float, footprint: float) -> dict[str, Any]:
        """Follow the camera (m on the map); `footprint` is the least width of ground under a pixel, m.

        Returns the fields of `TerrainFrame` that belong to the clipmap.
        """
        finest = int(np.clip(floor(log2(max(0.5 * footprint, 1e-6) / self.spacing)), 0, self.levels - 1))
        away = hypot(east, north)
        inside = min(1.0, self._extent / away) if away > 0.0 else 1.0
        self.finest = finest
        if self.clip.move(east * inside, north * inside, finest):
            for kind in _KINDS:
                self._new[kind] = self.clip.jobs(kind)
                if len(self._new[kind]):
                    self._jobs[kind].set(windows=self.clip.windows, packed=packed_jobs(self._new[kind]))
        wrap = self.clip.tiles * TILE << self.levels
        sample = [floor(x / self.spacing) for x in (east, north)]
        return {
            "camera_sample": [s % wrap for s in sample],
            "camera_rest": [x / self.spacing - s for x, s in zip((east, north), sample, strict=True)],
            "finest": finest,
        }

    def _take(self, kind: str) -> tuple[int, int, int]:
        """The jobs of a frame as it is recorded."""
        jobs = self._new[kind]
        self.clip.done(kind, jobs)
        self._new[kind] = jobs[:0]
        return max(len(jobs), 1), 1, 1


def _tiles(model: TerrainModel, world: Any, quality: Any, size: tuple[int, int]) -> int:
    """Width of a window in tiles: so wide that a texel, and an edge of the mesh, is small on the screen."""
    camera = world.camera
    fov = np.radians(min([camera.fov, *(key.fov for key in camera.keyframes if key.fov)]))
    pixel = 2.0 * tan(0.5 * fov) / size[1]
    grid, edge = quality.terrain_grid, 4.0 * quality.terrain_error_px / max(model.finer)
    samples = max(
        1.0 / (quality.terrain_texel_px * pixel) + 48.0,
        max(1.0 / (edge * pixel), MIN_RANGE * grid) + 2.5 * grid + 16.0,
    )
    most = min(quality.terrain_tiles * (4 if max(model.finer) > 2.0 else 3) // 6 * 2, MOST_TILES)
    return int(min(2 * ceil(samples / TILE), most))
