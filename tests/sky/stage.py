"""A sky alone: a frame graph with `Sky`, an empty depth, a fixed exposure, lights where a test wants them."""

from __future__ import annotations

from dataclasses import replace
from datetime import UTC, datetime

import numpy as np

from fallstreak.gpu import EXPOSURE, VIEW, Device, FrameGraph
from fallstreak.sky.ephemeris import Ephemeris
from fallstreak.sky.passes import Sky
from fallstreak.world import QUALITY, World
from fallstreak.world.state import CameraState, FrameState, camera_rotation, view_values

NOON = datetime(2024, 6, 21, 12, tzinfo=UTC)


def direction(elevation: float, azimuth: float) -> np.ndarray:
    """Unit vector of an elevation and an azimuth clockwise from north, degrees."""
    e, a = np.radians([elevation, azimuth])
    return np.array([np.sin(a) * np.cos(e), np.cos(a) * np.cos(e), np.sin(e)])


class Stage:
    """A sky over nothing, drawn from any height under any sun."""

    def __init__(self, device: Device, world: World, size=(160, 90), quality="high", **changes):
        self.world, self.size, self.device = world, size, device
        self.graph = graph = FrameGraph(device)
        self.view = graph.uniform("view", VIEW)
        graph.texture("frame.hdr", "rgba16float", size)
        graph.texture("gbuffer.depth", "depth32float", size)
        graph.buffer("frame.exposure", 16, history=True)
        graph.add_pass("stage.depth", writes=["gbuffer.depth"], record=self._clear_depth, order=-1)
        graph.add_pass("stage.exposure", writes=["frame.exposure"], record=self._expose, order=50)
        self.scale = 1.0
        self.sky = Sky(device, graph, world, replace(QUALITY[quality], **changes), size)
        graph.output("frame.hdr", "sky.irradiance", "sky.aerial_inscatter", "sky.aerial_transmittance")
        graph.compile()
        self._heavens = Ephemeris(0.6, 0.0, planet=world.planet.preset, refraction=False).at(NOON)

    def _clear_depth(self, context) -> None:
        view = context.resource("gbuffer.depth").create_view()
        context.encoder.begin_render_pass(
            color_attachments=[],
            depth_stencil_attachment={
                "view": view, "depth_clear_value": 0.0, "depth_load_op": "clear", "depth_store_op": "store",
            },
        ).end()  # fmt: skip

    def _expose(self, context) -> None:
        data = EXPOSURE.pack(scale=self.scale, ev100=0.0, luminance=1.0, pre_scale=self.scale)
        self.device.queue.write_buffer(context.resource("frame.exposure"), 0, data)

    def frame(
        self, *, altitude=1.7, sun=(30.0, 180.0), moon=(-90.0, 0.0), moon_phase=0.0,
        heading=180.0, pitch=10.0, fov=60.0, scale=1.0, repeat=1,
    ) -> np.ndarray:  # fmt: skip
        """Luminance (cd/m²), shape (height, width, 3), of a sky with sun and moon at (elevation, azimuth)."""
        heavens = replace(
            self._heavens,
            sun_direction=direction(*sun), moon_direction=direction(*moon), moon_phase=np.radians(moon_phase),
        )  # fmt: skip
        rotation = camera_rotation(np.radians(heading), np.radians(pitch), 0.0, np.eye(3))
        camera = CameraState(np.array([0.0, 0.0, altitude]), rotation, np.radians(fov))
        state = FrameState(0, 0.0, NOON, 0.0, 0, self.size, self.world.planet.radius, camera, camera)
        self.view.set(**view_values(state))
        self.sky.shine(heavens, altitude)
        for _ in range(repeat + (self.scale != scale)):
            self.scale = scale
            self.graph.execute()
        return self.graph.read("frame.hdr")[..., :3].astype(float) / scale
