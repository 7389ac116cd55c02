"""The GPU passes of the sphere clouds."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ...gpu import VIEW, FrameGraph, Struct
from ..frame import CLOUD_FRAME
from ..order import add_order
from ..shadow import CLOUD_SHADOW
from .atlas import TILE, sections
from .groups import filled, group

if TYPE_CHECKING:
    from ...world.state import FrameState
    from ..passes import Clouds

MOST_SEEN = 4096
MOST_NEAR = 12
MOST_ABOUT = 512
MOST_CORES = 256
_DRAW, _CORES = 16, 32  # bytes before the draws' arguments in section.wesl's Tiles

SPHERES_FRAME = Struct(
    "SpheresFrame",
    [
        ("rooms", "vec4f", "texels along a side of a section, by shelf"),
        ("firsts", "vec4u", "first section of each shelf"),
        ("visibility", "f32", "m"),
        ("pixel_angle", "f32", "radians per pixel of clouds.layer"),
        ("budget", "f32", "tiles drawn anew in a frame, of clouds that have a section"),
        ("patience", "f32", "how outdated a section may be, 1 is what would be seen"),
        ("ragged", "f32", "strength of the first turbulence"),
        ("cotton", "f32", "strength of the second"),
    ],
)


class Spheres:
    """Clouds of spheres in a frame graph.

    Parameters
    ----------
    graph : FrameGraph
    clouds : Clouds
        With its field.
    """

    def __init__(self, graph: FrameGraph, clouds: Clouds):
        self._graph, self._clouds, self._last = graph, clouds, -2
        self._settings = clouds.world.clouds.spheres
        quality = clouds.quality
        width = quality.cloud_atlas
        shelves = quality.cloud_sections
        table, height = sections(shelves, width)
        field = clouds.field.field
        layers = len(field.layers)
        firsts = np.cumsum([0, *(count for _, count in shelves)])[:4]
        self._uniform = graph.uniform("clouds.spheres.frame", SPHERES_FRAME)
        self._fixed = {
            "rooms": [size for size, _ in shelves],
            "firsts": firsts,
            "ragged": self._settings.ragged,
            "cotton": self._settings.cotton,
        }
        self._budget = float(quality.cloud_tiles)

        models = [model for layer in field.layers for model in layer.models]
        groups = [group(model, number) for number, model in enumerate(models)]
        most = max(len(g) for g in groups)
        counts = np.array([len(g) for g in groups])
        ranges = np.stack([np.cumsum(counts) - counts, counts], 1).astype(np.uint32)
        graph.buffer_data("clouds.spheres.groups", ranges)
        graph.buffer_data("clouds.spheres.shapes", np.concatenate(groups))
        graph.buffer_data(
            "clouds.spheres.filled", np.stack([filled(m, g) for m, g in zip(models, groups, strict=True)])
        )
        graph.buffer_data("clouds.spheres.table", table)

        name = "clouds.spheres."
        items = MOST_NEAR + len(table)
        tiles = int(((table[:, 2] // TILE).astype(np.int64) ** 2).sum())
        homes = layers * clouds.field.window**2
        graph.buffer(name + "counts", 16, persistent=True)
        graph.buffer(name + "seen", 64 * homes)
        graph.buffer(name + "keys", 8 * homes)
        graph.buffer(name + "about", 48 * MOST_ABOUT)
        graph.buffer(name + "wishes", 8 * MOST_SEEN)
        graph.buffer(name + "items", 16 + 48 * items, usage=("indirect",), persistent=True)
        graph.buffer(name + "tiles", 48 + 4 * tiles, usage=("indirect",), persistent=True)
        graph.buffer(name + "posed", 48 * most * items)
        graph.buffer(name + "sections", 64 * len(table), persistent=True)
        graph.buffer(name + "shown", 240 * MOST_SEEN)
        graph.buffer(name + "homes", 4 * homes, persistent=True)
        graph.texture(name + "cores", "depth32float", clouds.size)
        graph.texture(name + "shape", "rgba8unorm", (width, height), persistent=True)
        graph.texture(name + "placed", "rgba16float", (width, height), persistent=True)
        graph.buffer(name + "near_groups", 16, usage=("indirect",))
        near = tuple(-(-side // quality.cloud_near) for side in clouds.size)
        near_tiles = (-(-near[0] // 8), -(-near[1] // 8))
        graph.buffer(name + "near_masks", 8 * MOST_NEAR * near_tiles[0] * near_tiles[1])
        graph.buffer(name + "near_tiles", 16 + 4 * near_tiles[0] * near_tiles[1], usage=("indirect",))
        graph.texture(name + "near_shape", "rgba8unorm", (near[0], near[1]))
        graph.texture(name + "near_placed", "rgba16float", (near[0], near[1]))

        shared = {
            "frame": "clouds.frame",
            "view": "view",
            "spheres": name + "frame",
            "groups": name + "groups",
            "shapes": name + "shapes",
            "filled": name + "filled",
            "near_found": name + "near_tiles",
            "table": name + "table",
            "shape": name + "shape",
            "placed": name + "placed",
            "shadow": "clouds.shadow_frame",
            "shadow_map": "clouds.shadow",
            "linear": "sampler:linear-clamp",
            "scene": "gbuffer.depth",
            **{
                key: name + key
                for key in (
                    "counts", "seen", "keys", "about", "wishes", "items", "tiles", "posed", "sections",
                    "homes", "near_groups", "near_tiles", "near_masks", "shown", "cores",
                )
            },
            **clouds.field.bind,
        }  # fmt: skip
        common: dict[str, Any] = {
            "structs": [VIEW, CLOUD_FRAME, CLOUD_SHADOW, SPHERES_FRAME, *clouds.field.structs],
            "constants": {
                "MOST_CORES": MOST_CORES,
                "MOST_SEEN": MOST_SEEN,
                "MOST_SPHERES": most,
                "SECTIONS": len(table),
                "ATLAS": (width, height),
                "LAYER_SIZE": clouds.size,
                "NEAR_GROUPS": near_tiles,
                **clouds.field.constants,
            },
        }
        shadowed = {"flags": {"SHADOW": clouds.shadow is not None}}

        def compute(what: str, groups: Any, **options: Any) -> None:
            bind = shared | options.pop("bind", {})
            module = f"package::clouds::spheres::{what}"
            graph.compute(name + what, module, bind=bind, groups=groups, **common, **options)

        def render(what: str, **options: Any) -> None:
            module = f"package::clouds::spheres::{what}"
            bind = shared | options.pop("bind", {})
            onto = {"color": ["clouds.layer"], "blend": "over"}
            graph.render(name + what, module, bind=bind, **common, **(onto | options))

        graph.clear(name + "counts")
        square = -(-clouds.field.window // 8)
        compute("gather", (square, square, layers))
        order = add_order(
            graph,
            "clouds.spheres.by_distance",
            keys=name + "keys",
            count=name + "counts",
            word=1,
            capacity=homes,
        )
        shared["order"] = order
        compute("nearest", (MOST_ABOUT // 64, 1, 1))
        compute("assign", (1, 1, 1))
        compute("pose", name + "items")
        compute("trace", name + "tiles", **shadowed)
        screen = {"shape": name + "near_shape", "placed": name + "near_placed"}
        compute("near_tiles", name + "near_groups", bind=screen)
        compute("near", name + "near_tiles", bind=screen, **shadowed)
        compute("place", (MOST_SEEN // 64, 1, 1))
        strip: dict[str, Any] = {"topology": "triangle-strip", "indirect": name + "tiles"}
        render("cores", color=[], depth=name + "cores", blend=None, indirect_offset=_CORES, **strip)
        render("draw", indirect_offset=_DRAW, **strip)
        render("near_draw", bind=screen)
        render("inside")

    def update(self, state: FrameState) -> None:
        """Tell the shaders of the frame to be rendered."""
        # what does not follow a frame before is drawn as if alone
        exact = state.delta == 0.0 or state.index not in (self._last, self._last + 1)
        self._last = state.index
        self._uniform.set(
            **self._fixed,
            visibility=float(self._clouds.world.clouds.visibility),
            pixel_angle=2.0 * np.tan(state.camera.fov / 2.0) / self._clouds.size[1],
            budget=1e9 if exact else self._budget,
            patience=1e-4 if exact else 1.0,
        )

    def counts(self) -> dict[str, int]:
        """Of the last frame: clouds near and in sight, sections and tiles drawn anew; waits for the GPU."""
        near, seen, *_ = self._read("counts")
        return {
            "near": min(near, MOST_NEAR),
            "clouds": min(seen, MOST_SEEN),
            "sections_drawn": self._read("items")[0] - MOST_NEAR,
            "tiles_drawn": self._read("tiles")[0],
        }

    def _read(self, what: str) -> list[int]:
        return np.array(self._graph.read(f"clouds.spheres.{what}")).view(np.uint32)[:4].tolist()
