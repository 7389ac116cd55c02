"""The passes that choose, light, order and draw sprites, from the camera or the middle of the ring."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from ...gpu import VIEW, FrameGraph
from ..frame import CLOUD_FRAME
from ..order import add_order
from ..shadow import CLOUD_SHADOW
from .scope import RING_VIEW, SPRITE_SCOPE

if TYPE_CHECKING:
    from ..passes import Clouds

RING, BEHIND = 100.0, 101.0
"""In the order of passes: when the ring is drawn, and what is behind it."""

MOST = 32768
"""Sprites that are drawn at most."""
BINS = 128
BATCHES, FIRST, MORE = 5, 24, 3
"""Sprites are drawn near to far in so many batches: `FIRST`, the next `MORE` times as many, …, the rest. They
cover about as many pixels each. Where the picture is closed after one, nothing more is drawn."""
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
        Holds ``view``, ``clouds.frame``, what `Sprites` declares, and ``<name>.closed``: a depth as large as
        what is drawn into.
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
    graph.buffer(f"{name}.draw", 32 + 20 * (BATCHES + 1), usage=("indirect",), persistent=True)
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
            "BATCHES": BATCHES,
            "FIRST": FIRST,
            "MORE": MORE,
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
    order = add_order(graph, name, keys=own["keys"], count=own["draw"], word=0, capacity=MOST, when=when)
    add("deal", (1, 1, 1))
    # nothing of a ring lies behind it
    for batch in range(BATCHES + (not ring)):
        rank = float(batch) if batch < BATCHES else BEHIND
        step = f"draw{batch}" if batch < BATCHES else "behind"
        closed = {"depth": f"{name}.closed", "depth_write": False, "depth_in_turn": True} if batch else {}
        for painted in (False, True)[: 1 + artist]:
            graph.render(
                f"{name}.{step}" + ".paint" * painted,
                "package::clouds::sprites::draw",
                color=[targets[painted]],
                blend="under",
                bind={**common, "order": order},
                indirect=own["draw"],
                indirect_offset=32 + 20 * batch,
                index="clouds.sprites.corners",
                flags={"ARTIST": painted, **seen},
                order=rank,
                # colours may let more through than light does
                **({} if painted else closed),
                **options,
            )
        if batch < BATCHES - bool(ring):
            graph.render(
                f"{name}.closed{batch}",
                "package::clouds::sprites::closed",
                color=(),
                depth=f"{name}.closed",
                bind={"layer": targets[0]},
                in_turn=[targets[0]],
                order=rank + 0.5,
                when=when,
            )


def depth_texels(clouds: Clouds) -> tuple[float, float]:
    """Texels of ``gbuffer.depth`` to one of ``clouds.layer``, in both directions."""
    return clouds.picture[0] / clouds.size[0], clouds.picture[1] / clouds.size[1]
