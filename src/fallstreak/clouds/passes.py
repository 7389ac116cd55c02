"""The clouds in a frame: the field, the shadow map and the technique that draws it."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

import numpy as np

from ..gpu import FrameGraph
from .frame import cloud_frame, frame_values, key_light, layer_values

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

    Attributes
    ----------
    layers : list of Layer
        Empty: there are no clouds.
    struct : Struct
        `CloudFrame`, for passes that bind ``clouds.frame``.
    size : (int, int)
        Of ``clouds.layer``.
    """

    def __init__(self, graph: FrameGraph, world: World, quality: Quality, size: tuple[int, int]):
        self.graph, self.world, self.quality, self.picture = graph, world, quality, size
        self.layers: list[Any] = []
        if not world.clouds.layers:
            return
        from .field import layers_of
        from .field.passes import FieldPasses
        from .shadow import ShadowMap

        self.layers = layers_of(world)
        self.struct = cloud_frame(len(self.layers))
        self._frame = graph.uniform("clouds.frame", self.struct)
        self._frame.set(**layer_values(self.layers))
        scale = quality.cloud_scale
        self.size = (-(-size[0] // scale), -(-size[1] // scale))
        graph.texture("clouds.layer", "rgba16float", self.size)
        self.field = FieldPasses(self)
        self.shadow = ShadowMap(self) if world.clouds.shadows else None
        module = import_module(f".{world.clouds.technique}", __package__)
        self.technique = getattr(module, TECHNIQUES[world.clouds.technique])(graph, self)

    def update(self, state: FrameState) -> None:
        """Tell everybody of the frame to be rendered; after the sky's own `update`."""
        if not self.layers:
            return
        centre = state.camera.position + np.array([0.0, 0.0, state.planet_radius])
        self.key = key_light(self.graph.uniforms["sky.light"].record, centre / np.linalg.norm(centre))
        self._frame.set(
            **frame_values(
                self.layers,
                state,
                cells=self.quality.cloud_cells,
                visibility=self.world.clouds.visibility,
                key=self.key,
            )
        )
        if self.shadow is not None:
            self.shadow.update(state)
        self.technique.update(state)
