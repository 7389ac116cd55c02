"""Light on surfaces: one fullscreen pass over what the G-buffer drew."""

from __future__ import annotations

from fallstreak.gpu import EXPOSURE, FrameGraph
from fallstreak.sky.air import AIR
from fallstreak.sky.light import LIGHT


def add_lighting(graph: FrameGraph, world, quality, size: tuple[int, int]) -> None:
    """Write luminance times exposure into ``frame.hdr`` wherever something was drawn."""
    graph.fullscreen(
        "frame.lighting",
        "package::frame::lighting",
        color=["frame.hdr"],
        depth="gbuffer.depth",
        depth_compare="less",
        bind={
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
            "linear": "sampler:linear-clamp",
        },
        structs=[AIR, LIGHT, EXPOSURE],
    )
