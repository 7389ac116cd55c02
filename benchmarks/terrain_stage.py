"""The ground of a world in a G-buffer, without sky and light: what the terrain benchmarks measure on."""

from __future__ import annotations

import time
from datetime import UTC, datetime

import numpy as np

import fallstreak as fs

LANDS = {
    "jacksboro": [],
    "canyons": [
        "terrain.source=canyons",
        "terrain.material=canyon",
        "terrain.base_height=1600",
        "terrain.relief=350",
        "terrain.feature_size=3e3",
    ],
    "alpine": [
        "terrain.source=alpine",
        "terrain.material=alpine",
        "terrain.base_height=1500",
        "terrain.relief=2600",
        "terrain.feature_size=16e3",
    ],
    "dunes": [
        "terrain.source=dunes",
        "terrain.material=dunes",
        "terrain.relief=120",
        "terrain.feature_size=1500",
    ],
    "water": ["terrain.water_level=380"],
}


class Stage:
    """Draws the ground of a kind of land; ``overrides`` come on top of it."""

    def __init__(self, device, land, quality, size, overrides=("terrain.vegetation=0",)):
        from fallstreak.frame.gbuffer import COLOR, DEPTH, add_gbuffer
        from fallstreak.gpu import VIEW, FrameGraph
        from fallstreak.terrain.passes import Terrain
        from fallstreak.world.quality import QUALITY

        self.world = fs.load("jacksboro", [*LANDS[land], *overrides])
        self.size, self.quality = size, QUALITY[quality]
        self.graph = FrameGraph(device)
        self.graph.pass_times = True
        self.view = self.graph.uniform("view", VIEW)
        add_gbuffer(self.graph, size)
        self.terrain = Terrain(device, self.graph, self.world, self.quality, size)
        self.graph.output(*COLOR, DEPTH)
        self.graph.output(*(f"terrain.{name}" for name in ("nodes", "heights", "draws")))
        if self.world.terrain.vegetation > 0.0:
            self.graph.output("plants.draws")
        self.graph.compile()
        self.model = self.terrain.model

    def pose(self, east, north, height, heading, pitch, above=True, fov=45.0):
        """State of a camera, degrees and metres; `fov` is its vertical field of view."""
        from fallstreak.world.state import (
            CameraState,
            FrameState,
            camera_rotation,
            local_axes,
            position_on_planet,
        )

        radius = self.world.planet.radius
        if above:
            height = height + float(self.world.terrain.height(east, north))
        axes = local_axes(east, north, radius)
        rotation = camera_rotation(np.radians(heading), np.radians(pitch), 0.0, axes)
        place = position_on_planet(east, north, height, radius)
        camera = CameraState(place, rotation, np.radians(fov))
        now = datetime(2025, 10, 18, tzinfo=UTC)
        return FrameState(0, 0.0, now, 0.0, self.world.seed, self.size, radius, camera, camera)

    def draw(self, state):
        """Draw a frame; processor time that Python took for it, ms."""
        from fallstreak.world.state import view_values

        values = view_values(state)
        start = time.thread_time()
        self.terrain.update(state)
        self.view.set(**values)
        self.graph.execute()
        return (time.thread_time() - start) * 1e3

    def read(self, name):
        return np.array(self.graph.read(name))

    def costs(self):
        """GPU time of the passes of the last frame, ms, by name; those of all plants together."""
        out = {"plants": 0.0}
        for step in self.graph.stats()["passes"]:
            name = step["name"].removeprefix("terrain.")
            if name.startswith("plants"):
                out["plants"] += step["gpu_ms"] or 0.0
            else:
                out[name] = step["gpu_ms"] or 0.0
        return out

    def nodes(self):
        """(count, 3): x, y, level; and the triangles they have."""
        draws = self.read("terrain.draws").view(np.uint32)
        raw = self.read("terrain.nodes").view(np.uint32).reshape(-1, 2)[: draws[1]]
        return np.stack([raw[:, 0] & 0xFFFF, raw[:, 0] >> 16, raw[:, 1]], 1).astype(int), int(
            draws[0] * draws[1] // 3
        )

    def mesh(self, slot):
        """Vertices of a drawn node: places on the map (n, 2), world coordinates (n, 3) less the camera's."""
        from fallstreak.terrain.projection import world_from_map
        from fallstreak.terrain.selection import morphed

        grid = self.quality.terrain_grid
        frame = self._frame
        vertices = morphed(frame, self._nodes[slot], grid)
        place = vertices.offset + np.array(frame["camera_map"])
        shift = self._heights[slot, :, 1].copy().view(np.int16).reshape(-1, 2) / 32767.0 * 128.0
        height = self._heights[slot, :, 0].copy().view(np.float32).astype(float)
        drawn = place + shift
        return place, world_from_map(drawn[:, 0], drawn[:, 1], height, self.model.radius)

    def hold(self, state):
        """Read the mesh of the frame that was drawn for `state`."""
        self._frame = self.terrain.frame_values(state)
        self._nodes, _ = self.nodes()
        count = (self.quality.terrain_grid + 1) ** 2
        raw = self.read("terrain.heights").view(np.uint32).reshape(-1, count, 2)
        self._heights = np.ascontiguousarray(raw[: len(self._nodes)])
        return len(self._nodes)
