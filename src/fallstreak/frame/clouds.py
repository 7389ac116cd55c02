"""Clouds in the picture: what a technique drew becomes light, seen through the air, and lies over the rest.

    add_clouds(graph, clouds)      # after the sky's own passes; reads clouds.layer, draws over frame.hdr

Reads the sky's tables: the key light is the sun's (at night the moon's) at the height of the cloud itself, so
that hours need no tuning. A layer coarser than the picture is lit at its own resolution and then brought up
with regard to the land's edges.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from fallstreak.gpu import EXPOSURE, FrameGraph
from fallstreak.sky.air import AIR
from fallstreak.sky.light import LIGHT

if TYPE_CHECKING:
    from fallstreak.clouds.passes import Clouds

FAR_ALTITUDE = 20e3
"""Metres; from here on the air before clouds is marched, not looked up (see sky/lookup.wesl)."""

ORDER = 30.0
"""Among the passes that draw into the picture: after the sky, the moon and the stars."""


def add_clouds(graph: FrameGraph, clouds: Clouds) -> None:
    """Lay ``clouds.layer`` over ``frame.hdr``; nothing where a world has no clouds.

    Parameters
    ----------
    graph : FrameGraph
        With the sky's passes and ``frame.exposure``.
    clouds : Clouds
        Its `key` says whether sun or moon lights the clouds.
    """
    if not clouds.any:
        return
    view, light = graph.uniforms["view"].record, graph.uniforms["sky.light"].record
    coarse = clouds.size != clouds.picture
    artist = clouds.world.clouds.colours == "artist"
    bind = {
        "view": "view",
        "air": "sky.air",
        "light": "sky.light",
        "exposure": "frame.exposure@previous",
        "layer": "clouds.layer",
        "transmittance": "sky.transmittance",
        "multiple": "sky.multiscattering",
        "sky_light": "sky.skylight",
        "inscatter": "sky.aerial_inscatter",
        "through": "sky.aerial_transmittance",
        "linear": "sampler:linear-clamp",
        "colour": "clouds.colour",
    }
    onto: dict[str, Any] = {"color": ["frame.hdr"], "blend": "over", "order": ORDER}
    if coarse:
        graph.texture("frame.clouds_lit", "rgba16float", clouds.size)
        graph.fullscreen(
            "frame.clouds",
            "package::frame::clouds_over",
            bind={"lit": "frame.clouds_lit", "depth_buffer": "gbuffer.depth"},
            **onto,
        )
        onto = {"color": ["frame.clouds_lit"]}

    def moonlit() -> bool:
        return bool(np.array_equal(clouds.key, light["moon_direction"]))

    def far() -> bool:
        return float(view["altitude"]) > FAR_ALTITUDE

    def when(key_moon: bool, from_far: bool) -> Callable[[], bool]:
        return lambda: moonlit() == key_moon and far() == from_far

    for key_moon in (False, True):
        for from_far in (False, True):
            graph.render(
                "frame.clouds.light" + ".moon" * key_moon + ".far" * from_far,
                "package::frame::clouds",
                fragment="light_main",
                bind=bind,
                flags={"KEY_MOON": key_moon, "FAR": from_far, "ARTIST": artist},
                structs=[AIR, LIGHT, EXPOSURE],
                when=when(key_moon, from_far),
                **onto,
            )
