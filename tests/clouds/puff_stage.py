"""Puffs alone: a frame graph with the passes of the puffs over matter of which the depth is known."""

from __future__ import annotations

from datetime import UTC, datetime
from typing import Any

import numpy as np

from fallstreak.clouds.frame import CLOUD_FRAME, frame_values
from fallstreak.clouds.puffs.levels import Slab
from fallstreak.clouds.puffs.passes import PUFF_BYTES, PuffPasses
from fallstreak.gpu import VIEW, Device, FrameGraph
from fallstreak.world.state import (
    CameraState,
    FrameState,
    camera_rotation,
    local_axes,
    position_on_planet,
    view_values,
)

RADIUS = 6_360_000.0
NOW = datetime(2025, 6, 1, tzinfo=UTC)
PUFF = np.dtype(
    {
        "names": ["centre", "depth", "right", "near", "distance"],
        "formats": [("<f4", 3), "<f4", ("<f4", 3), "<f4", "<f4"],
        "offsets": [0, 12, 16, 28, 140],
        "itemsize": PUFF_BYTES,
    }
)
"""Some of a puff, see ``puff.wesl``."""


class PuffStage:
    """Puffs of `selftest_matter`: heaps `heap` m apart of `depth` 1/m, or with 0 the same everywhere."""

    def __init__(
        self,
        device: Device,
        *,
        slab: Slab | None = None,
        heap: float = 0.0,
        size: tuple[int, int] = (96, 54),
        number: int = 4000,
        everywhere: bool = False,
        most: int = 30000,
    ):
        self.size = size
        self.slab = slab or Slab(1000.0, 1600.0, 0.04, (0.0, 0.0), 7)
        self.graph = graph = FrameGraph(device)
        self._view = graph.uniform("view", VIEW)
        self._frame = graph.uniform("clouds.frame", CLOUD_FRAME)
        graph.texture("clouds.layer", "rgba16float", size)
        graph.texture("gbuffer.depth", "depth32float", size)
        sky = {"depth": "gbuffer.depth", "fragment": None, "vertices": 0}
        graph.render("stage.depth", "package::gpu::fullscreen", **sky)
        self.puffs = PuffPasses(
            graph,
            (self.slab,),
            size=size,
            number=number,
            matter="package::clouds::puffs::selftest_matter",
            constants={"HEAP": heap, "DENSE": self.slab.extinction, "MOST_DRAWN": most},
            everywhere=everywhere,
        )
        graph.output(
            "clouds.layer", "clouds.puffs.puffs", "clouds.puffs.arguments", "clouds.puffs.block_count"
        )
        graph.compile()

    def draw(
        self, east=0.0, north=0.0, height=100.0, heading=0.0, pitch=0.0,
        fov=50.0, time=0.0, visibility=160e3, index=0,
    ) -> np.ndarray:  # fmt: skip
        """`clouds.layer`, (height, width, 4), seen from a place on the map; angles in degrees."""
        eye = CameraState(
            position_on_planet(east, north, height, RADIUS),
            camera_rotation(np.radians(heading), np.radians(pitch), 0.0, local_axes(east, north, RADIUS)),
            np.radians(fov),
        )
        state = FrameState(index, time, NOW, 0.0, 7, self.size, RADIUS, eye, eye)
        self.eye = eye.position
        self._view.set(**view_values(state))
        self._frame.set(**frame_values(state, visibility=visibility, key=np.array([0.5, -0.4, 0.77])))
        self.puffs.update(state, visibility)
        self.graph.execute()
        raw = np.array(self.graph.read("clouds.layer"), np.float64)
        return raw.reshape(self.size[1], self.size[0], 4)

    def _words(self, name: str) -> np.ndarray:
        return np.array(self.graph.read(name)).view(np.uint32).ravel()

    @property
    def drawn(self) -> int:
        return int(self._words("clouds.puffs.arguments")[0]) // 3

    @property
    def blocks(self) -> int:
        return int(self._words("clouds.puffs.block_count")[0])

    def placed(self) -> Any:
        """What was drawn, (n,) of `PUFF`."""
        return np.array(self.graph.read("clouds.puffs.puffs")).view(np.uint8).view(PUFF).ravel()[: self.drawn]
