"""The field alone on the GPU, with a pass that looks at given places."""

from __future__ import annotations

from datetime import UTC, datetime
from types import SimpleNamespace

import numpy as np

from fallstreak.clouds.field import field_of
from fallstreak.clouds.field.passes import FieldPasses
from fallstreak.gpu import FrameGraph
from fallstreak.world.state import CameraState, FrameState, position_on_planet

RADIUS = 6_360_000.0
PLACES = 4096

CLOUD = np.dtype(
    [
        ("offset", "<f4", 2),
        ("base", "<f4"),
        ("yaw", "<f4"),
        ("scale", "<f4", 2),
        ("formation", "<f4"),
        ("extinction", "<f4"),
        ("radius", "<f4"),
        ("top", "<f4"),
        ("model", "<u4"),
        ("seed", "<u4"),
        ("swell", "<f4"),
        ("spare", "<f4"),
        ("turn", "<f4", 2),
    ]
)


class Stage:
    """A world's field in a frame graph; `look` renders a frame with the camera at a place."""

    def __init__(self, device, world, window=32, ends=False):
        self.field = field_of(world)
        self.graph = FrameGraph(device)
        self.passes = FieldPasses(self.graph, self.field, SimpleNamespace(cloud_cells=window), ends=ends)
        self.graph.buffer_data("places", np.zeros((PLACES, 4), np.float32))
        self.graph.buffer("found", PLACES * 8)
        bind = {"places": "places", "found": "found", **self.passes.bind}
        self.graph.compute(
            "look",
            "package::clouds::field::selftest",
            bind=bind,
            groups=(PLACES // 64, 1, 1),
            structs=self.passes.structs,
            constants=self.passes.constants,
        )
        self.graph.output("clouds.cells", "found")
        self.graph.compile()

    def look(self, east, north, time, points=None, size=100.0):
        """Records of all layers' windows; extinction and mean extinction at map points (n, 3)."""
        camera = CameraState(position_on_planet(east, north, 1000.0, RADIUS), np.eye(3), 1.0)
        now = datetime(2025, 6, 1, tzinfo=UTC)
        state = FrameState(0, time, now, 0.0, 7, (16, 9), RADIUS, camera, camera)
        if points is not None:
            places = np.zeros((PLACES, 4), np.float32)
            places[: len(points), :3] = points - np.array([east, north, 0.0])
            places[:, 3] = size
            self.graph.upload("places", places)
        self.passes.update(state)
        self.graph.execute()
        window = self.passes.window
        cells = np.array(self.graph.read("clouds.cells")).view(CLOUD)
        found = np.array(self.graph.read("found")).view(np.float32).reshape(-1, 2)
        return cells.reshape(-1, window, window), found[: 0 if points is None else len(points)]

    def window_cells(self, layer, east, north, time):
        """The cells of a layer's window, (window², 2)."""
        numbers = self.field.layers[layer]
        middle = np.floor((np.array([east, north]) - np.asarray(numbers.wind) * time) / numbers.cell)
        steps = np.arange(self.passes.window) - self.passes.window // 2
        x, y = np.meshgrid(steps + int(middle[0]), steps + int(middle[1]))
        return np.stack([x.ravel(), y.ravel()], 1)
