"""The GPU passes of the sprites."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...gpu import FrameGraph
from ...world.state import FrameState, local_axes, map_coordinates
from ..grain import grain
from .artist import paint
from .draw import MOST, add_sprites
from .ring.passes import Ring
from .scope import SPRITE_SCOPE
from .stock import stock
from .textures import sheet

if TYPE_CHECKING:
    from ..passes import Clouds

_CORNERS = 4
_TRIANGLES = ((0, 1, 2), (0, 2, 3))


class Sprites:
    """Clouds of sprites in a frame graph.

    Parameters
    ----------
    graph : FrameGraph
    clouds : Clouds
        With its field.
    """

    def __init__(self, graph: FrameGraph, clouds: Clouds):
        made, first = stock(clouds.field.field.packed, float(clouds.world.clouds.sprites.density))
        graph.buffer_data("clouds.sprites.stock", made)
        graph.buffer_data("clouds.sprites.first", first)
        graph.texture_data("clouds.sprites.sheet", sheet(), "rgba8unorm", dimension="2d-array", mips=True)
        layers = clouds.field.field.layers
        looks = [layer.genus.look for layer in layers]
        graph.texture_data("clouds.sprites.grain", grain(looks), "rgba8unorm", dimension="3d")
        corners = _CORNERS * np.arange(MOST, dtype=np.uint32)[:, None] + np.ravel(_TRIANGLES).astype(
            np.uint32
        )
        graph.buffer_data("clouds.sprites.corners", corners, usage=("index",))
        self._graph = graph
        self._models = [model for layer in layers for model in layer.models]
        self._artist = clouds.world.clouds.colours == "artist"
        if self._artist:
            graph.texture("clouds.colour", "rgba16float", clouds.size)
            graph.buffer_data("clouds.sprites.paint", paint(self._models, 1.0, 0.0))
        self._scope = graph.uniform("clouds.sprites.scope", SPRITE_SCOPE)
        self._scope.set(behind=1e9)
        graph.texture("clouds.sprites.closed", "depth32float", clouds.size)
        # the ring saves time at the price of far clouds' sharpness
        with_ring = clouds.world.clouds.sprites.ring and not clouds.accumulated
        self.ring = Ring(graph, clouds, self._scope, artist=self._artist) if with_ring else None
        add_sprites(graph, clouds, "clouds.sprites", artist=self._artist)

    def update(self, state: FrameState) -> None:
        """Tell the ring where the camera is, and the artists' colours the hour."""
        if self._artist:
            centre = state.camera.position + np.array([0.0, 0.0, state.planet_radius])
            axes = local_axes(
                *map_coordinates(state.camera.position, state.planet_radius), state.planet_radius
            )
            sun = self._graph.uniforms["sky.light"].record["sun_direction"].astype(np.float64)
            height = float(sun @ centre / np.linalg.norm(centre))
            self._graph.upload("clouds.sprites.paint", paint(self._models, height, float(sun @ axes[:, 0])))
        if self.ring is not None:
            self.ring.update(state)

    def counts(self) -> dict[str, int]:
        """What the last frame chose and drew; waits for the GPU.

        Returns
        -------
        dict
            clouds, sprites: drawn one by one; ring_clouds, ring_sprites: in the picture of the ring that was
            drawn last; ring_parts: how many parts of it this frame drew.
        """
        found = {}
        for name, word in (("clouds.sprites", ""), ("clouds.ring", "ring_"))[: 1 + (self.ring is not None)]:
            found[f"{word}clouds"] = int(_words(self._graph.read(f"{name}.work"))[0])
            found[f"{word}sprites"] = int(_words(self._graph.read(f"{name}.draw"))[0])
        if self.ring is not None:
            found["ring_parts"] = len(self.ring.plan.parts)
        return found


def _words(data: np.ndarray) -> np.ndarray:
    return np.ascontiguousarray(data).view(np.uint32)
