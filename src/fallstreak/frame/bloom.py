"""The lens: a little of the light lands beside where it should.

    name = add_bloom(graph, world.film, quality, size)      # None for film.bloom = 0

Gives the name of a half-size texture to blend with the picture: ``mix(picture, bloom, film.bloom)``; the
light stays the same in sum. Level n of the pyramid is 2^n times wider and gets `SPREAD` times the light of
the one before: the glare falls with the angle to the power of log2(SPREAD) - 2, about -2.5, near what eyes
and lenses do (Spencer, Shirley, Zimmerman, Greenberg 1995 give -2 to -3).

Cost: 2 levels - 1 fullscreen passes on a half, a quarter … of the picture.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from fallstreak.gpu import FrameGraph

if TYPE_CHECKING:
    from fallstreak.world import Film
    from fallstreak.world.quality import Quality

SPREAD = 0.7
_SHADER = "package::frame::bloom"


def add_bloom(
    graph: FrameGraph, film: Film, quality: Quality, size: tuple[int, int], picture: str = "frame.resolved"
) -> str | None:
    """Add the pyramid's passes; returns the texture to blend with the picture, or None without bloom."""
    if film.bloom <= 0:
        return None
    sizes = [size]
    while len(sizes) <= quality.bloom_levels and min(sizes[-1]) >= 16:
        sizes.append((sizes[-1][0] // 2, sizes[-1][1] // 2))
    levels = len(sizes) - 1
    linear = "sampler:linear-clamp"
    above = picture
    for level in range(1, levels + 1):
        name = f"frame.bloom.down{level}"
        graph.texture(name, "rgba16float", sizes[level])
        graph.fullscreen(
            name,
            _SHADER,
            fragment="down_first" if level == 1 else "down",
            color=[name],
            bind={"source": above, "linear": linear},
            constants={"SPREAD": SPREAD},
        )
        above = name
    wide = above
    for level in range(levels - 1, 0, -1):
        name = f"frame.bloom.up{level}"
        graph.texture(name, "rgba16float", sizes[level])
        graph.fullscreen(
            name,
            _SHADER,
            fragment="up",
            color=[name],
            bind={"source": wide, "linear": linear, "own": f"frame.bloom.down{level}"},
            constants={"SPREAD": SPREAD},
        )
        wide = name
    return wide
