"""The lens: a little of the light lands beside where it should.

    name = add_bloom(graph, world.film, quality, size)      # None for film.bloom = 0

Gives the name of a texture to blend with the picture: ``mix(picture, bloom, share)``, `bloom_share` says how
much; the light stays the same in sum. Level n of the pyramid is 2^n times wider and gets `SPREAD` times the
light of the one before: the glare falls with the angle to the power of log2(SPREAD) - 2, about -2.5, near
what eyes and lenses do (Spencer, Shirley, Zimmerman, Greenberg 1995 give -2 to -3).

A quality may leave out the finest level (``bloom_first``), which spreads light by two pixels: its share stays
in the picture. Cost: 2 levels - 1 fullscreen passes on a half, a quarter … of the picture.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from fallstreak.gpu import FrameGraph

if TYPE_CHECKING:
    from fallstreak.world import Film
    from fallstreak.world.quality import Quality

SPREAD = 0.7
_SHADER = "package::frame::bloom"


def bloom_share(film: Film, quality: Quality) -> float:
    """How much of its light the picture gives to what `add_bloom` makes."""
    return film.bloom * SPREAD ** (quality.bloom_first - 1)


def add_bloom(
    graph: FrameGraph, film: Film, quality: Quality, size: tuple[int, int], picture: str = "frame.resolved"
) -> str | None:
    """Add the pyramid's passes; returns the texture to blend with the picture, or None without bloom."""
    if film.bloom <= 0:
        return None
    first = quality.bloom_first
    sizes = [size]
    while len(sizes) <= quality.bloom_levels and min(sizes[-1]) >= 16:
        sizes.append((sizes[-1][0] // 2, sizes[-1][1] // 2))
    if len(sizes) <= first:
        return None
    levels = len(sizes) - 1
    linear = "sampler:linear-clamp"
    above = picture
    for level in range(first, levels + 1):
        name = f"frame.bloom.down{level}"
        graph.texture(name, "rgba16float", sizes[level])
        graph.fullscreen(
            name,
            _SHADER,
            fragment="down" if level > first else "down_first" if first == 1 else "down_second",
            color=[name],
            bind={"source": above, "linear": linear},
            constants={"SPREAD": SPREAD},
        )
        above = name
    wide = above
    for level in range(levels - 1, first - 1, -1):
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
