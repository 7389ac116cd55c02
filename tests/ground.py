"""The terrain's passes alone, drawn into a G-buffer: what the tests of the ground look at."""

from __future__ import annotations

from datetime import UTC, datetime

import numpy as np

import fallstreak as fs
from fallstreak.frame.gbuffer import COLOR, DEPTH, add_gbuffer
from fallstreak.gpu import VIEW, FrameGraph
from fallstreak.terrain.clipmap import TILE
from fallstreak.terrain.passes import Terrain
from fallstreak.terrain.projection import map_from_world
from fallstreak.terrain.selection import bounds_of
from fallstreak.world.quality import QUALITY
from fallstreak.world.state import (
    CameraState,
    FrameState,
    camera_rotation,
    local_axes,
    position_on_planet,
    view_values,
)

SIZE = (160, 90)
#: east, north, metres above ground, heading, pitch (degrees)
VIEWS = {
    "eye": (0.0, 0.0, 1.7, 135.0, -5.0),
    "down": (-5200.0, 3100.0, 30.0, 10.0, -80.0),
    "hill": (2000.0, -4000.0, 300.0, 300.0, -12.0),
    "border": (15_500.0, 1000.0, 1200.0, 60.0, -20.0),
    "far": (70_000.0, 50_000.0, 400.0, 225.0, -10.0),
    "high": (0.0, -40_000.0, 30_000.0, 0.0, -40.0),
    "orbit": (0.0, -200_000.0, 400_000.0, 0.0, -50.0),
}
CLIPMAP = ("shape", "surface", "cover_a", "cover_b", "tint")


class Ground:
    """A world's ground and the globe around it, without sky, light, plants or things."""

    def __init__(self, device, scene="jacksboro", quality="low", overrides=()):
        self.world = fs.load(scene, overrides=["terrain.vegetation=0", *overrides])
        self.quality = QUALITY[quality]
        self.graph = FrameGraph(device)
        self.view = self.graph.uniform("view", VIEW)
        add_gbuffer(self.graph, SIZE)
        self.terrain = Terrain(device, self.graph, self.world, self.quality, SIZE)
        self.graph.output(*COLOR, DEPTH)
        if self.terrain.clip is not None:
            names = ("nodes", "workgroups", "heights", "bounds", *CLIPMAP)
            self.graph.output(*(f"terrain.{name}" for name in names))
        self.declare_more()
        self.graph.compile()

    def declare_more(self):
        """For a test that needs more in the graph."""

    def state(self, east, north, above, heading, pitch, fov=50.0):
        radius = self.world.planet.radius
        height = above + self.world.terrain.height(east, north)
        camera = CameraState(
            position_on_planet(east, north, height, radius),
            camera_rotation(np.radians(heading), np.radians(pitch), 0.0, local_axes(east, north, radius)),
            np.radians(fov),
        )
        now = datetime(2025, 6, 1, tzinfo=UTC)
        return FrameState(0, 0.0, now, 0.0, self.world.seed, SIZE, radius, camera, camera)

    def draw(self, *view):
        state = self.state(*view)
        self.view.set(**view_values(state))
        self.terrain.update(state)
        self.graph.execute()
        return state

    def read(self, name):
        return np.array(self.graph.read(name))

    def nodes(self):
        """(count, 3): x, y, level."""
        count = self.read("terrain.workgroups").view(np.uint32)[0]
        raw = self.read("terrain.nodes").view(np.uint32).reshape(-1, 2)[:count]
        return np.stack([raw[:, 0] & 0xFFFF, raw[:, 0] >> 16, raw[:, 1]], 1).astype(int)

    def bounds(self):
        """Of the clipmap's tiles as the GPU found them, (levels, tiles, tiles, 4)."""
        clip = self.terrain.clip.clip
        held = self.read("terrain.bounds").view(np.float32)
        return held[: 4 * clip.levels * clip.tiles**2].reshape(clip.levels, clip.tiles, clip.tiles, 4)

    def bounds_between(self):
        return bounds_of(self.bounds())

    def tiles_in_use(self, kind):
        """(count, 3) of the clipmap: level, column, row of the whole map."""
        clip = self.terrain.clip.clip
        used = clip._used & (clip._inner if kind == "surface" else True)
        size = clip.spacing * TILE * 2.0 ** np.arange(clip.levels)[:, None, None]
        # beyond the map's edge nothing is seen, and neighbours may be missing
        used &= np.hypot(*np.moveaxis(clip._wanted * size[..., None], -1, 0)) < 1.04 * clip.extent + size
        level = np.nonzero(used)[0]
        return np.column_stack([level, clip._wanted[used]])

    def tile(self, image, level, column, row):
        """The texels of a tile in what was read of a layered texture."""
        tiles = self.terrain.clip.clip.tiles
        x, y = column % tiles * TILE, row % tiles * TILE
        return image[level, y : y + TILE, x : x + TILE]

    def points(self, state):
        """Of every pixel that shows something: (east, north, height, distance, x, y)."""
        depth = self.read(DEPTH).astype(np.float64)
        y, x = np.nonzero(depth > 0)
        clip = np.stack(
            [(x + 0.5) / SIZE[0] * 2 - 1, 1 - (y + 0.5) / SIZE[1] * 2, depth[y, x], np.ones(len(x))], 1
        )
        point = clip @ view_values(state)["world_from_clip"].T
        point = point[:, :3] / point[:, 3:]
        east, north, height = map_from_world(point + state.camera.position, state.planet_radius)
        return east, north, height, np.linalg.norm(point, axis=1), x, y
