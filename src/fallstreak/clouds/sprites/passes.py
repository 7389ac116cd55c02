"""The GPU passes of the sprites."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ...gpu import VIEW, FrameGraph
from ...world.state import FrameState
from ..frame import CLOUD_FRAME
from ..order import add_order
from ..shadow import CLOUD_SHADOW
from .grain import grain
from .stock import stock
from .textures import sheet

if TYPE_CHECKING:
    from ..passes import Clouds

MOST = 32768
"""Sprites that are drawn at most."""
BINS = 128
_CORNERS = 6
_TRIANGLES = ((0, 1, 2), (0, 2, 3), (0, 3, 4), (0, 4, 5))


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
        add_sprites(graph, clouds, "clouds.sprites")

    def update(self, state: FrameState) -> None:
        """Nothing changes but what all clouds are told."""


def add_sprites(graph: FrameGraph, clouds: Clouds, name: str) -> None:
    """Add the passes that choose, light, order and draw sprites."""
    field = clouds.field
    cells = len(field.field.layers) * field.window**2
    shadow = clouds.shadow is not None
    graph.buffer(f"{name}.work", 32, usage=("indirect",))
    graph.buffer(f"{name}.draw", 32, usage=("indirect",))
    graph.buffer(f"{name}.wanted", 4 * BINS)
    graph.buffer(f"{name}.chosen", 4 * cells)
    graph.buffer(f"{name}.sprites", 224 * MOST)
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
            "LAYER_SIZE": clouds.size,
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
    add("expand", own["work"], flags={"SHADOW": shadow})
    order = add_order(graph, name, keys=own["keys"], count=own["draw"], word=5, capacity=MOST)
    graph.render(
        f"{name}.draw",
        "package::clouds::sprites::draw",
        color=["clouds.layer"],
        blend="over",
        bind={**common, "order": order},
        indirect=own["draw"],
        index="clouds.sprites.corners",
        **options,
    )
