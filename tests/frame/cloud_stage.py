"""A sky with one picture of clouds before it, given as an array: what the frame makes of it."""

from __future__ import annotations

from dataclasses import replace
from datetime import UTC, datetime
from types import SimpleNamespace
from typing import Any

import numpy as np

from fallstreak.frame.clouds import add_clouds
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


def coded(key, ambient, distance, opacity):
    """A picture of clouds as techniques write it, from arrays that broadcast."""
    parts = (key, ambient, np.log2(np.maximum(distance, 1.0)) / 24, 1.0)
    return np.stack(np.broadcast_arrays(*(np.asarray(opacity) * p for p in parts)), -1).astype(np.float16)


class CloudStage:
    """Sky, a depth as given and a layer of clouds as given."""

    def __init__(
        self,
        device: Device,
        layer: np.ndarray,
        size=(64, 36),
        depth=None,
        colour=None,
        technique="puffs",
    ):
        self.size, self.device, self.scale = size, device, 1e-3
        self.graph = graph = FrameGraph(device)
        self.view = graph.uniform("view", VIEW)
        graph.texture("frame.hdr", "rgba16float", size)
        graph.texture("gbuffer.depth", "depth32float", size)
        graph.buffer("frame.exposure", 16, history=True)
        graph.add_pass("stage.depth", writes=["gbuffer.depth"], record=self._clear_depth, order=-1)
        graph.add_pass("stage.exposure", writes=["frame.exposure"], record=self._expose, order=50)
        self._depth = depth
        self.world = World(name="stage")
        self.sky = Sky(device, graph, self.world, replace(QUALITY["low"]), size)
        graph.texture_data("clouds.layer", layer, "rgba16float")
        if colour is not None:
            graph.texture_data("clouds.colour", colour, "rgba16float")
        self.clouds: Any = SimpleNamespace(
            any=True,
            moonlit=False,
            shadow=None,
            size=layer.shape[1::-1],
            picture=size,
            world=SimpleNamespace(
                clouds=SimpleNamespace(
                    colours="physical" if colour is None else "artist", technique=technique
                )
            ),
        )
        add_clouds(graph, self.clouds)
        graph.output("frame.hdr", "sky.irradiance")
        graph.compile()
        self._heavens = Ephemeris(0.6, 0.0, planet="earth", refraction=False).at(NOON)

    def _clear_depth(self, context) -> None:
        view = context.resource("gbuffer.depth").create_view()
        encoder, depth = context.encoder, self._depth or 0.0
        encoder.begin_render_pass(
            color_attachments=[],
            depth_stencil_attachment={
                "view": view, "depth_clear_value": depth, "depth_load_op": "clear", "depth_store_op": "store",
            },
        ).end()  # fmt: skip

    def _expose(self, context) -> None:
        data = EXPOSURE.pack(scale=self.scale, ev100=0.0, luminance=1.0, pre_scale=self.scale)
        self.device.queue.write_buffer(context.resource("frame.exposure"), 0, data)

    def frame(
        self, *, altitude=2.0, sun=(50.0, 180.0), moon=(-90.0, 0.0), heading=0.0, pitch=20.0, scale=1e-3
    ) -> np.ndarray:
        """Luminance (cd/m²), shape (height, width, 3), with sun and moon at (elevation, azimuth)."""
        heavens = replace(
            self._heavens, sun_direction=direction(*sun), moon_direction=direction(*moon), moon_phase=0.0
        )
        rotation = camera_rotation(np.radians(heading), np.radians(pitch), 0.0, np.eye(3))
        camera = CameraState(np.array([0.0, 0.0, altitude]), rotation, np.radians(50.0))
        state = FrameState(0, 0.0, NOON, 0.0, 0, self.size, self.world.planet.radius, camera, camera)
        self.view.set(**view_values(state))
        self.sky.shine(heavens, altitude)
        self.clouds.moonlit = sun[0] < -7
        self.scale = scale
        for _ in range(2):
            self.graph.execute()
        return self.graph.read("frame.hdr")[..., :3].astype(float) / scale
