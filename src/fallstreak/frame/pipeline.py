"""One frame from end to end: which passes there are, between which resources.

    G-buffer (terrain, models) → shadows → lighting → sky, moon, stars → clouds → temporal or accumulated
    anti-aliasing → exposure meter → bloom → tone map

The systems and the parts of the frame add their own passes; the graph finds the order. This file only says
who takes part.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from fallstreak.clouds.passes import Clouds
from fallstreak.gpu import EXPOSURE, FrameGraph
from fallstreak.models.passes import Models
from fallstreak.shadows.passes import Shadows
from fallstreak.sky.passes import Sky
from fallstreak.terrain.passes import Terrain

from .accumulate import Accumulate, still_jitter
from .bloom import add_bloom, bloom_share
from .clouds import add_clouds
from .exposure import Exposure, add_exposure_buffer
from .gbuffer import add_gbuffer
from .lighting import add_lighting
from .shafts import add_shafts, land_shades
from .temporal import Temporal, sequence_jitter
from .tonemap import ToneMap

if TYPE_CHECKING:
    from fallstreak.models.poses import PlacedModels
    from fallstreak.world import World
    from fallstreak.world.quality import Quality
    from fallstreak.world.state import FrameState


class Pipeline:
    """The passes of one world's frame.

    Parameters
    ----------
    graph : FrameGraph
        In which the uniform `view` is declared.
    world, quality, size
        What to draw, how finely, how large.
    models : PlacedModels
        The world's models, loaded.
    temporal : bool
        Anti-aliasing over frames; else the mean over a frame's samples.
    bits : 8 or 16
        Of `frame.ldr`.
    show : "materials", optional
        See `Renderer`.

    Attributes
    ----------
    light : str
        The resource that holds the frame's light: `luminance` makes cd/m² of it.
    """

    def __init__(
        self,
        graph: FrameGraph,
        world: World,
        quality: Quality,
        size: tuple[int, int],
        models: PlacedModels,
        *,
        temporal: bool,
        bits: Literal[8, 16] = 8,
        show: str | None = None,
    ):
        add_exposure_buffer(graph)
        add_gbuffer(graph, size)
        graph.texture("frame.hdr", "rgba16float", size)
        self.sky = Sky(graph.device, graph, world, quality, size, shaded=land_shades(world))
        self.terrain = Terrain(graph.device, graph, world, quality, size, show=show)
        self.models = Models(graph, models)
        self.clouds = Clouds(graph, world, quality, size, accumulated=not temporal)
        self.shadows = Shadows(graph, world, quality, size, terrain=self.terrain, models=self.models)
        if land_shades(world) and self.shadows.sweep is not None:
            add_shafts(graph, self.shadows.sweep)
        past_clouds = self.clouds.any and self.clouds.shadow is not None
        add_lighting(graph, world, quality, size, clouds=past_clouds, shadows=self.shadows.any)
        add_clouds(graph, self.clouds, self.shadows.sweep)
        self._resolve = (
            Temporal(graph, size, fast=quality.temporal_fast, clouds=self.clouds.any)
            if temporal
            else Accumulate(graph, size)
        )
        self._temporal = temporal
        self.light = "frame.resolved" if temporal else "frame.accumulation"
        self.exposure = Exposure(graph, world.film, size)
        bloom = add_bloom(graph, world.film, quality, size)
        ToneMap(graph, world.film, size, bits=bits, bloom=bloom, share=bloom_share(world.film, quality))
        self._fresh = False  # without `begin`, the graph's histories were restored

    def begin(self, state: FrameState) -> None:
        """Forget all history: the next frame is the first."""
        self.exposure.begin(self.sky.sun_elevation(state))
        self.clouds.begin()
        self.shadows.begin()
        self._fresh = True

    def update(self, state: FrameState, *, delta: float, instant: bool) -> None:
        """Tell everybody of the frame to be rendered.

        Parameters
        ----------
        delta : float
            Seconds of the sequence since the frame before, for the adaptation of the exposure.
        instant : bool
            The exposure settles at once.
        """
        self.sky.update(state)
        self.terrain.update(state)
        self.models.update(state)
        self.clouds.update(state)
        self.shadows.update(state)
        self.exposure.update(delta, instant=instant)
        if isinstance(self._resolve, Temporal):
            self._resolve.update(reset=self._fresh)
        else:
            self._resolve.update(state.sample)
        self._fresh = False

    def jitter(self, index: int, sample: int, samples: int) -> tuple[float, float]:
        """Offset of the sampling points of a frame, pixels."""
        return sequence_jitter(index) if self._temporal else still_jitter(sample, samples)

    def read_exposure(self, raw: np.ndarray) -> dict[str, float]:
        """The frame's exposure from the bytes of `frame.exposure`."""
        record = raw.view(np.uint8)[: EXPOSURE.size].view(EXPOSURE.dtype)[0]
        return {name: float(record[name]) for name in ("scale", "ev100", "luminance", "pre_scale")}

    def luminance(self, raw: np.ndarray, exposure: dict[str, Any]) -> np.ndarray:
        """Luminance in cd/m² from what was read of `light`, (H, W, 3) float32."""
        rgb = raw[..., :3].astype(np.float32)
        return rgb / np.float32(exposure["pre_scale"]) if self._temporal else rgb
