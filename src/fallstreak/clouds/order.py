"""Which of many transparent things is drawn first: an order by distance, far to near, found on the GPU.

Things fall into 8,192 bins by the logarithm of their distance, 256 to a doubling; within its bin each counts
those before it. The result is exact and does not depend on the order in which things were listed, as long as
their ties differ. Cost: five small passes; n times the things in a bin for the counting, some 20 of 30,000.
"""

from __future__ import annotations

from collections.abc import Callable

from ..gpu import FrameGraph

BINS = 8192


def add_order(
    graph: FrameGraph,
    name: str,
    *,
    keys: str,
    count: str,
    word: int,
    capacity: int,
    when: Callable[[], bool] | None = None,
) -> str:
    """Add the passes that order things.

    Parameters
    ----------
    graph : FrameGraph
    name : str
        Of the passes.
    keys : str
        Buffer, ``array<vec2u>``: bits of the distance (f32, m, 0.01 to 3e7) and a number that breaks ties.
    count : str
        Buffer that holds how many things there are,
    word : int
        in this word.
    capacity : int
        The most there may be.
    when : callable, optional
        As of `FrameGraph.compute`.

    Returns
    -------
    str
        Buffer, ``array<u32>``: indices of things, far to near.
    """
    kept = when is not None
    result = graph.buffer(f"{name}.order", 4 * capacity, persistent=kept)
    graph.buffer(f"{name}.bins", 4 * BINS, persistent=kept)
    graph.buffer(f"{name}.binned", 4 * capacity, persistent=kept)
    every = {
        "keys": keys,
        "count": count,
        "bins": f"{name}.bins",
        "binned": f"{name}.binned",
        "order": result,
    }
    constants = {"BINS": BINS, "COUNT": word}
    things = (-(-capacity // 64), 1, 1)
    for step, groups in (
        ("clear", (BINS // 256, 1, 1)),
        ("tally", things),
        ("sum", (1, 1, 1)),
        ("spread", things),
        ("rank", things),
    ):
        graph.compute(
            f"{name}.{step}",
            "package::clouds::order",
            entry=step,
            bind=every,
            groups=groups,
            constants=constants,
            when=when,
        )
    return result
