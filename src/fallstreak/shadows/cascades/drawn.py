"""The one depth texture that every map is drawn into, and how it gets to its place."""

from __future__ import annotations

from collections.abc import Callable

from ...gpu import FrameGraph, Struct

TEXELS = 1024
"""Along a side of a map."""

STORE_JOB = Struct("StoreJob", [("layer", "u32", "where the drawn map goes")])


def add_drawn(graph: FrameGraph, output: str, *, packed: bool, when: Callable[[], bool]) -> None:
    """Declare ``shadows.drawn``, cleared before casters draw into it and stored in `output` after them.

    Parameters
    ----------
    output : name
        An r32float array: of maps, or of four in one layer (`packed`).
    when : callable
        Whether there is a map to draw.
    """
    graph.texture("shadows.drawn", "depth32float", (TEXELS, TEXELS), persistent=True)
    # the first that draws into a map clears it, and there may be nothing to draw
    graph.render(
        "shadows.clear",
        "package::gpu::fullscreen",
        depth="shadows.drawn",
        fragment=None,
        vertices=0,
        when=when,
        order=-1.0,
    )
    graph.compute(
        "shadows.store",
        "package::shadows::cascades::store",
        bind={"job": "shadows.store", "drawn": "shadows.drawn", "output": output},
        groups=(TEXELS // 16, TEXELS // 16, 1),
        structs=[STORE_JOB],
        flags={"PACKED": packed},
        when=when,
    )
