"""The GPU passes of the sprites."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ...gpu import VIEW, FrameGraph
from ...world.state import FrameState, local_axes, map_coordinates
from ..frame import CLOUD_FRAME
from ..order import add_order
from ..shadow import CLOUD_SHADOW
from .artist import paint
from .grain import grain
from .stock import stock
from .textures import sheet

if TYPE_CHECKING:
    from ..passes import Clouds

MOST = 32768
"""Sprites that are drawn at most."""
BINS = 128
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
        made, first = stock(clouds.field.field.packed)
        graph.buffer_data("clouds.sprites.stock", made)
        graph.buffer_data("clouds.sprites.first", first)
        graph.texture_data("clouds.sprites.sheet", sheet(), "rgba8unorm", dimension="2d-array", mips=True)
        looks = [layer.genus.look for layer in clouds.field.field.layers]
        graph.texture_data("clouds.sprites.grain", grain(looks), "rgba8unorm", dimension="3d")
        corners = _CORNERS * np.arange(MOST, dtype=np.uint32)[:, None] + np.ravel(_TRIANGLES).astype(
            np.uint32
        )
        graph.buffer_data("clouds.sprites.corners", corners, usage=("index",))
        self._graph = graph
        self._models = [model for layer in clouds.field.field.layers for model in layer.models]
        self._artist = clouds.world.clouds.colours == "artist"
        if self._artist:
            graph.texture("clouds.colour", "rgba16float", clouds.size)
            graph.buffer_data("clouds.sprites.paint", paint(self._models, 1.0, 0.0))
        add_sprites(graph, clouds, "clouds.sprites")

    def update(self, state: FrameState) -> None:
        """Tell the artists' colours the hour; all else is what all clouds are told."""
        if self._artist:
            centre = state.camera.position + np.array([0.0, 0.0, state.planet_radius])
            axes = local_axes(
                *map_coordinates(state.camera.position, state.planet_radius), state.planet_radius
            )
            sun = self._graph.uniforms["sky.light"].record["sun_direction"].astype(np.float64)
            height = float(sun @ centre / np.linalg.norm(centre))
            self._graph.upload("clouds.sprites.paint", paint(self._models, height, float(sun @ axes[:, 0])))


def add_sprites(graph: FrameGraph, clouds: Clouds, name: str) -> None:
    """Add the passes that choose, light, order and draw sprites."""
    field = clouds.field
    cells = len(field.field.layers) * field.window**2
    shadow = clouds.shadow is not None
    graph.buffer(f"{name}.work", 32, usage=("indirect",), persistent=True)
    graph.buffer(f"{name}.draw", 32, usage=("indirect",), persistent=True)
    graph.buffer(f"{name}.wanted", 4 * BINS)
    graph.buffer(f"{name}.chosen", 4 * cells)
    graph.buffer(f"{name}.sprites", 224 * MOST, persistent=True)
    graph.buffer(f"{name}.keys", 8 * MOST)
    own = {word: f"{name}.{word}" for word in ("work", "draw", "wanted", "chosen", "sprites", "keys")}
    common = {
        "view": "view",
        "frame": "clouds.frame",
        "stock": "clouds.sprites.stock",
        "first": "clouds.sprites.first",
        "sheet": "clouds.sprites.sheet",
        "linear": "sampler:linear-clamp",
        "shadow": "clouds.shadow_frame",
        "shadow_map": "clouds.shadow",
        "scene": "gbuffer.depth",
        "grain": "clouds.sprites.grain",
        **field.bind,
        **own,
    }
    options: dict[str, Any] = {
        "structs": [VIEW, CLOUD_FRAME, CLOUD_SHADOW, *field.structs],
        "constants": {
            "BINS": BINS,
            "MOST": MOST,
            "DENSITY": float(clouds.world.clouds.sprites.density),
            "PIXELS": clouds.picture[1] / clouds.size[1],
            "DEPTH_TEXELS": tuple(p / s for p, s in zip(clouds.picture, clouds.size, strict=True)),
            "GRAINS": float(len(field.field.layers)),
            **field.constants,
        },
    }

    def add(step: str, groups: Any, **more: Any) -> None:
        graph.compute(
            f"{name}.{step}",
            f"package::clouds::sprites::{step}",
            bind=common,
            groups=groups,
            **options,
            **more,
        )

    add("begin", (1, 1, 1), order=-1.0)
    add("select", (-(-cells // 64), 1, 1))
    add("budget", (1, 1, 1))
    artist = clouds.world.clouds.colours == "artist"
    if artist:
        graph.buffer(f"{name}.marks", 48 * MOST)
        common |= {"marks": f"{name}.marks", "paint": "clouds.sprites.paint"}
    add("expand", own["work"], flags={"SHADOW": shadow, "ARTIST": artist})
    order = add_order(graph, name, keys=own["keys"], count=own["draw"], word=5, capacity=MOST)
    for painted in (False, True)[: 1 + artist]:
        graph.render(
            f"{name}.paint" if painted else f"{name}.draw",
            "package::clouds::sprites::draw",
            color=["clouds.colour" if painted else "clouds.layer"],
            blend="over",
            bind={**common, "order": order},
            indirect=own["draw"],
            index="clouds.sprites.corners",
            flags={"ARTIST": painted},
            **options,
        )
