"""The clouds in a frame: the field, the shadow map and the technique that draws it."""

from __future__ import annotations

from importlib import import_module
from math import inf
from typing import TYPE_CHECKING

import numpy as np

from ..gpu import FrameGraph
from ..world.state import key_light
from .frame import CLOUD_FRAME, frame_values

if TYPE_CHECKING:
    from ..world import World
    from ..world.quality import Quality
    from ..world.state import FrameState

TECHNIQUES = {"sprites": "Sprites", "puffs": "Puffs", "spheres": "Spheres"}
"""``clouds.technique`` → class in the folder of that name: ``T(graph, clouds)`` with ``update(state)``."""


class Clouds:
    """Clouds as passes of a frame graph; nothing where a world has none.

    Writes ``clouds.layer``, ``clouds.shadow`` and what the field's shaders bind.

    Parameters
    ----------
    graph : FrameGraph
        Must hold ``view``, ``gbuffer.depth`` and ``sky.light``.
    world : World
    quality : Quality
    size : (int, int)
        Of the picture, pixels.
    accumulated : bool
        A frame is the mean of samples, its quality counts more than its time.

    Attributes
    ----------
    any : bool
        False: the world has no clouds, and nothing is declared.
    field : FieldPasses
        What shaders that look into the field bind.
    size : (int, int)
        Of ``clouds.layer``.
    key : (3,) float64
        In a frame, direction to the light that counts; `moonlit`: it is the moon.
    reach : float
        m, as far as the technique draws the lowest clouds; infinite where it has no end.
    fresh : bool
        In a frame, whether it is the first of a sequence: what was drawn before has nothing to do with it.
    """

    def __init__(
        self,
        graph: FrameGraph,
        world: World,
        quality: Quality,
        size: tuple[int, int],
        *,
        accumulated: bool = False,
    ):
        self.graph, self.world, self.quality, self.picture = graph, world, quality, size
        self.accumulated = accumulated
        self.any = bool(world.clouds.layers)
        self.fresh = False
        if not self.any:
            return
        from .field import field_of
        from .field.passes import FieldPasses
        from .shadow import ShadowMap

        self._frame = graph.uniform("clouds.frame", CLOUD_FRAME)
        scale = quality.cloud_scale
        self.size = (-(-size[0] // scale), -(-size[1] // scale))
        graph.texture("clouds.layer", "rgba16float", self.size)
        # puffs alone stand for clouds beyond the window
        ends = world.clouds.technique != "puffs"
        self.field = FieldPasses(graph, field_of(world), quality, ends=ends)
        low = min(self.field.field.layers, key=lambda layer: layer.bounds[0])
        window = 0.5 * self.field.window * low.cell
        self.reach = min(window, float(world.clouds.visibility)) if ends else inf
        self.shadow = ShadowMap(self) if world.clouds.shadows else None
        module = import_module(f".{world.clouds.technique}", __package__)
        self.technique = getattr(module, TECHNIQUES[world.clouds.technique])(graph, self)

    def begin(self) -> None:
        """Forget all history: the next frame is the first."""
        self.fresh = True

    def update(self, state: FrameState) -> None:
        """Tell everybody of the frame to be rendered; after the sky's own `update`."""
        if not self.any:
            return
        centre = state.camera.position + np.array([0.0, 0.0, state.planet_radius])
        light = self.graph.uniforms["sky.light"].record
        self.key = key_light(light, centre / np.linalg.norm(centre))
        self.moonlit = bool(np.array_equal(self.key, light["moon_direction"].astype(np.float64)))
        self._frame.set(**frame_values(state, visibility=self.world.clouds.visibility, key=self.key))
        self.field.update(state)
        if self.shadow is not None:
            self.shadow.update(state)
        self.technique.update(state)
        self.fresh = False
