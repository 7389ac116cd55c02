"""Clouds in the picture: what a technique drew becomes light, seen through the air, and lies over the rest.

    add_clouds(graph, clouds)      # after the sky's own passes; reads clouds.layer, draws over frame.hdr

Reads the sky's tables: the key light is the sun's (at night the moon's) at the height of the cloud itself, so
that hours need no tuning. A layer coarser than the picture is lit at its own resolution and then brought up
with regard to the land's edges.
"""

from __future__ import annotations

from collections.abc import Callable
from math import inf
from typing import TYPE_CHECKING, Any

import numpy as np

from fallstreak.clouds.shadow import CLOUD_SHADOW
from fallstreak.gpu import EXPOSURE, FrameGraph
from fallstreak.shadows.frame import SHADOWS
from fallstreak.shadows.sweep import ABSENT
from fallstreak.sky.air import AIR
from fallstreak.sky.light import LIGHT

if TYPE_CHECKING:
    from fallstreak.clouds.passes import Clouds
    from fallstreak.shadows.sweep import Sweep

FAR_ALTITUDE = 20e3
"""Metres; from here on the air before clouds is marched, not looked up (see sky/lookup.wesl)."""

SIDES = 64
"""Of the ring about the camera in which clouds lie beyond those that a technique draws."""

ORDER = 30.0
"""Among the passes that draw into the picture: after the sky, the moon and the stars."""


def add_clouds(graph: FrameGraph, clouds: Clouds, sweep: Sweep | None = None) -> None:
    """Lay ``clouds.layer`` over ``frame.hdr``; nothing where a world has no clouds.

    Parameters
    ----------
    graph : FrameGraph
        With the sky's passes and ``frame.exposure``.
    clouds : Clouds
        `moonlit` says whether sun or moon lights them.
    sweep : Sweep, optional
        Of the land, which then throws shadows on them.
    """
    if not clouds.any:
        return
    view = graph.uniforms["view"].record
    coarse = clouds.size != clouds.picture
    artist = clouds.world.clouds.colours == "artist"
    polar = clouds.world.clouds.technique == "spheres"
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
        "shadow": "clouds.shadow_frame",
        "overhead": "clouds.overhead",
        "cast_shadows": "shadows.frame",
        "repeat": "sampler:linear-repeat",
        **(sweep.bind if sweep else {}),
    }
    constants = sweep.constants if sweep else ABSENT
    structs = [AIR, LIGHT, EXPOSURE, CLOUD_SHADOW, SHADOWS]
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

    def far() -> bool:
        return float(view["altitude"]) > FAR_ALTITUDE

    def when(key_moon: bool, from_far: bool) -> Callable[[], bool]:
        return lambda: clouds.moonlit == key_moon and far() == from_far

    for key_moon in (False, True):
        if clouds.shadow is not None and clouds.reach < inf and not artist:
            graph.render(
                "frame.clouds.horizon" + ".moon" * key_moon,
                "package::frame::horizon",
                bind={**bind, "depth_buffer": "gbuffer.depth"},
                flags={
                    "KEY_MOON": key_moon,
                    "FAR": False,
                    "ARTIST": False,
                    "POLAR": polar,
                    "SHADOWS": True,
                    "LAND": sweep is not None,
                },
                constants={**constants, "REACH": float(clouds.reach), "SIDES": np.uint32(SIDES)},
                structs=structs,
                topology="triangle-strip",
                vertices=2 * SIDES + 2,
                color=["frame.hdr"],
                blend="over",
                order=ORDER - 1.0,
                when=when(key_moon, False),
            )
        for from_far in (False, True):
            graph.render(
                "frame.clouds.light" + ".moon" * key_moon + ".far" * from_far,
                "package::frame::clouds",
                fragment="light_main",
                bind=bind,
                flags={
                    "KEY_MOON": key_moon,
                    "FAR": from_far,
                    "ARTIST": artist,
                    "POLAR": polar,
                    "SHADOWS": clouds.shadow is not None,
                    "LAND": sweep is not None,
                },
                structs=structs,
                constants=constants,
                when=when(key_moon, from_far),
                **onto,
            )
