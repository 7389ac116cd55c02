"""Light on surfaces: one fullscreen pass over what the G-buffer drew.

    add_lighting(graph, world, quality, size)     # after the systems declared theirs; writes frame.hdr

Reads the G-buffer, ``view``, ``frame.exposure@previous`` and the sky's tables. There are three forms of the
pass, of which the CPU picks one each frame: without the moon, with it, and from far above the ground.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from fallstreak.clouds.shadow import CLOUD_SHADOW
from fallstreak.gpu import EXPOSURE, FrameGraph
from fallstreak.sky.air import AIR
from fallstreak.sky.light import LIGHT

if TYPE_CHECKING:
    from fallstreak.world import World
    from fallstreak.world.quality import Quality

FAR_ALTITUDE = 6e3
"""Metres; from here on the sky over distant ground is another than the camera's."""

_LINEAR = "sampler:linear-clamp"


def add_lighting(
    graph: FrameGraph,
    world: World,
    quality: Quality,
    size: tuple[int, int],
    *,
    clouds: bool = False,
    shadows: bool = False,
) -> None:
    """Write luminance times exposure into ``frame.hdr`` wherever something was drawn.

    `clouds`: there is a ``clouds.shadow``, and light comes past clouds. `shadows`: there is a
    ``shadows.light``, and it comes past land and things.
    """
    add_brdf_table(graph)
    view, light = graph.uniforms["view"].record, graph.uniforms["sky.light"].record

    def far() -> bool:
        return float(view["altitude"]) > FAR_ALTITUDE

    def moon() -> bool:
        # as lookup::moon_matters, a little earlier
        return float(light["moon_illuminance"][1] * light["table_scale"]) > 0.9e-4

    bind = {
        "view": "view",
        "air": "sky.air",
        "light": "sky.light",
        "exposure": "frame.exposure@previous",
        "irradiance": "sky.irradiance",
        "albedo_buffer": "gbuffer.albedo",
        "normal_buffer": "gbuffer.normal",
        "surface_buffer": "gbuffer.surface",
        "depth_buffer": "gbuffer.depth",
        "transmittance": "sky.transmittance",
        "multiple": "sky.multiscattering",
        "inscatter": "sky.aerial_inscatter",
        "through": "sky.aerial_transmittance",
        "linear": _LINEAR,
        "brdf_table": "frame.brdf",
        "sky_light": "sky.skylight",
        "sky_view": "sky.view_table",
        "shadow": "clouds.shadow_frame",
        "shadow_map": "clouds.shadow",
        "overhead": "clouds.overhead",
        "shadow_light": "shadows.light",
    }
    forms = {
        "frame.lighting": ({"MOON": False, "FAR": False}, lambda: not far() and not moon()),
        "frame.lighting.moon": ({"MOON": True, "FAR": False}, lambda: not far() and moon()),
        "frame.lighting.far": ({"MOON": True, "FAR": True}, far),
    }
    for name, (flags, when) in forms.items():
        graph.render(
            name,
            "package::frame::lighting",
            color=["frame.hdr"],
            depth="gbuffer.depth",
            depth_compare="less",
            depth_write=False,
            bind=bind,
            flags={
                **flags,
                "REFLECTION": _has_mirrors(world) and not flags["FAR"],
                "CLOUDS": clouds,
                "SHADOWS": shadows,
            },
            structs=[AIR, LIGHT, EXPOSURE, CLOUD_SHADOW],
            when=when,
        )


def _has_mirrors(world: World) -> bool:
    """Whether there may be water about the camera, or a model with glass or polish."""
    return world.planet.surface == "ocean" or world.terrain.has_water or bool(world.models)


def add_brdf_table(graph: FrameGraph) -> None:
    """Declare ``frame.brdf``, the directional albedo of rough mirrors; made in the first frame."""
    graph.texture("frame.brdf", "rgba8unorm", (32, 32), persistent=True)
    graph.compute(
        "frame.brdf",
        "package::frame::brdf_table",
        bind={"output": "frame.brdf"},
        groups=(4, 4, 1),
        when=lambda: False,
    )
