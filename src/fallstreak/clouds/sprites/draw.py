"""The passes that choose, light, order and draw sprites, from the camera or the middle of the ring."""

from __future__ import annotations

from collections.abc import Callable
from itertools import product
from typing import TYPE_CHECKING, Any

from ...gpu import VIEW, FrameGraph
from ..frame import CLOUD_FRAME
from ..order import add_order
from ..shadow import CLOUD_SHADOW
from .scope import RING_VIEW, SPRITE_SCOPE

if TYPE_CHECKING:
    from ..passes import Clouds

MOST = 32768
"""Sprites that are drawn at most."""
BINS = 128
SPRITE_BYTES, MARK_BYTES = 224, 48


def add_sprites(
    graph: FrameGraph,
    clouds: Clouds,
    name: str,
    *,
    ring: tuple[str, ...] = (),
    artist: bool = False,
    when: Callable[[], bool] | None = None,
) -> None:
    """Add the passes: a constant number of them, however many clouds there are.

    Parameters
    ----------
    graph : FrameGraph
        Holds ``view``, ``clouds.frame``, and what `Sprites` declares.
    clouds : Clouds
    name : str
        Of the passes and what they make. Uniforms ``<name>.scope`` and, for the ring, ``<name>.view`` and
        ``<name>.frame`` must be declared.
    ring : tuple of str, optional
        Textures to draw far clouds into; without them clouds near by are drawn into ``clouds.layer``.
    artist : bool
        Also the artists' colours, into ``clouds.colour`` or the second of the ring's textures.
    when : callable, optional
        As of `FrameGraph.compute`.
    """
    field = clouds.field
    cells = len(field.field.layers) * field.window**2
    kept = when is not None
    graph.buffer(f"{name}.work", 32, usage=("indirect",), persistent=True)
    graph.buffer(f"{name}.draw", 64, usage=("indirect",), persistent=True)
    graph.buffer(f"{name}.wanted", 4 * BINS, persistent=kept)
    graph.buffer(f"{name}.chosen", 4 * cells, persistent=kept)
    graph.buffer(f"{name}.sprites", SPRITE_BYTES * MOST, persistent=kept)
    graph.buffer(f"{name}.keys", 8 * MOST, persistent=kept)
    own = {
        word: f"{name}.{word}" for word in ("work", "draw", "wanted", "chosen", "sprites", "keys", "scope")
    }
    common = {
        "view": f"{name}.view" if ring else "view",
        "frame": f"{name}.frame" if ring else "clouds.frame",
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
    scale = 1.0 if ring else clouds.picture[1] / clouds.size[1]
    options: dict[str, Any] = {
        "structs": [VIEW, CLOUD_FRAME, CLOUD_SHADOW, RING_VIEW, SPRITE_SCOPE, *field.structs],
        "constants": {
            "BINS": BINS,
            "MOST": MOST,
            "DENSITY": float(clouds.world.clouds.sprites.density),
            "PIXELS": scale,
            "DEPTH_TEXELS": depth_texels(clouds),
            "GRAINS": float(len(field.field.layers)),
            **field.constants,
        },
        "when": when,
    }

    def add(step: str, groups: Any, flags: dict[str, bool] | None = None, order: float = 0.0) -> None:
        graph.compute(
            f"{name}.{step}",
            f"package::clouds::sprites::{step}",
            bind=common,
            groups=groups,
            flags=flags,
            order=order,
            **options,
        )

    if artist:
        graph.buffer(f"{name}.marks", MARK_BYTES * MOST, persistent=kept)
        common |= {"marks": f"{name}.marks", "paint": "clouds.sprites.paint"}
    targets = ring or ("clouds.layer", "clouds.colour")
    seen = {"RING": bool(ring)}
    add("begin", (1, 1, 1), order=-1.0)
    add("select", (-(-cells // 64), 1, 1), seen)
    add("budget", (1, 1, 1))
    add("expand", own["work"], {"SHADOW": clouds.shadow is not None, "ARTIST": artist, **seen})
    order = add_order(graph, name, keys=own["keys"], count=own["draw"], word=5, capacity=MOST, when=when)
    # nothing of a ring lies behind it
    draws = (
        (("draw", "paint", 0, 0.0),)
        if ring
        else (("behind", "paint_behind", 32, -1.0), ("draw", "paint", 0, 0.0))
    )
    for (light, colours, offset, rank), painted in product(draws, (False, True)[: 1 + artist]):
        step, target = (colours, targets[1]) if painted else (light, targets[0])
        graph.render(
            f"{name}.{step}",
            "package::clouds::sprites::draw",
            color=[target],
            blend="over",
            bind={**common, "order": order},
            indirect=own["draw"],
            indirect_offset=offset,
            index="clouds.sprites.corners",
            flags={"ARTIST": painted, **seen},
            order=rank,
            **options,
        )


def depth_texels(clouds: Clouds) -> tuple[float, float]:
    """Texels of ``gbuffer.depth`` to one of ``clouds.layer``, in both directions."""
    return clouds.picture[0] / clouds.size[0], clouds.picture[1] / clouds.size[1]
