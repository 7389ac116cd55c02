"""The sky in a frame: which tables there are, when they are made, what is drawn."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fallstreak.gpu import EXPOSURE, VIEW, Device, FrameGraph

from .air import AIR, Air
from .celestial_passes import Celestial
from .ephemeris import Heavens
from .light import LIGHT
from .sight import in_sight

if TYPE_CHECKING:
    from collections.abc import Callable

    from fallstreak.world import World
    from fallstreak.world.quality import Quality
    from fallstreak.world.state import FrameState

_LINEAR = "sampler:linear-clamp"


class Sky:
    """Air, sun and moon as passes of a frame graph.

    Writes `sky.air`, `sky.light`, the tables `sky.transmittance`, `sky.multiscattering`, `sky.skylight`,
    `sky.view_table`, `sky.view_table_moon`, `sky.aerial_inscatter`, `sky.aerial_transmittance`, the buffer
    `sky.irradiance`, and draws into `frame.hdr` where `gbuffer.depth` is 0.

    Parameters
    ----------
    device, graph
        Where the passes go; `view`, `frame.hdr`, `gbuffer.depth` and `frame.exposure` must be declared.
    world : World
        Place, planet and air.
    quality : Quality
        Sizes and steps of the tables.
    size : (int, int)
        Of the picture, pixels.
    shaded : bool
        Something throws shadows into the air: whoever knows writes `sky.shares`, the sun's and the moon's
        share of light (red, green) in each slice of the tables of the air before the camera.
    """

    def __init__(
        self,
        device: Device,
        graph: FrameGraph,
        world: World,
        quality: Quality,
        size: tuple[int, int],
        shaded: bool = False,
    ):
        self._celestial = Celestial(graph, world, quality)
        self._moon_matters = False
        self._view, self._light = graph.uniforms["view"].record, graph.uniforms["sky.light"].record
        graph.uniform("sky.air", AIR).set(**Air.of(world).uniform())
        _still_tables(graph, quality)
        if shaded:
            graph.texture("sky.shares", "rgba8unorm", quality.aerial_size, dimension="3d", persistent=True)
        _frame_tables(graph, quality, lambda: self._moon_matters, shaded)
        shared = {"view": "view", "air": "sky.air", "light": "sky.light", "linear": _LINEAR}
        shared |= {"exposure": "frame.exposure@previous"}
        onto = {"color": ["frame.hdr"], "depth": "gbuffer.depth", "depth_write": False}
        structs = [AIR, LIGHT, EXPOSURE]
        for name, moon in (("sky.draw", False), ("sky.draw.moon", True)):
            graph.render(
                name,
                "package::sky::draw",
                bind={
                    **shared,
                    "sky_view": "sky.view_table",
                    "sky_view_moon": "sky.view_table_moon",
                    "inscatter": "sky.aerial_inscatter",
                },
                flags={"MOON": moon, "SHARES": shaded},
                structs=structs,
                depth_compare="equal",
                vertices=3,
                when=lambda moon=moon: self._moon_matters == moon,
                order=10,
                **onto,
            )
        graph.render(
            "sky.sun",
            "package::sky::sun",
            bind={**shared, "transmittance": "sky.transmittance"},
            structs=structs,
            depth_compare="greater-equal",
            blend="add",
            topology="triangle-strip",
            vertices=4,
            when=self._sees_sun,
            order=11,
            **onto,
        )
        self._celestial.draw()

    def update(self, state: FrameState) -> None:
        """Set the lights of a frame."""
        self._see(self._celestial.update(state))

    def sun_elevation(self, state: FrameState) -> float:
        """Elevation of the sun in a frame, radians."""
        return self._celestial.ephemeris.at(state.utc, state.camera.position).sun_elevation

    def shine(self, heavens: Heavens, altitude: float) -> None:
        """Set the lights of a given sky, for a camera at an altitude (m)."""
        self._see(self._celestial.shine(heavens, altitude))

    def _sees_sun(self) -> bool:
        return in_sight(self._view, self._light["sun_direction"], float(self._light["sun_radius"]))

    def _see(self, values: dict[str, Any]) -> None:
        moon = values["moon_illuminance"]
        # lookup.wesl's question, a little earlier, so that no frame reads a table that was not made
        self._moon_matters = float(moon[1]) * float(values["table_scale"]) > 0.9e-4


def rehearse(device: Device, world: World, quality: Quality, shaded: bool) -> None:
    """Have the sky's tables made once for nothing, without waiting for them.

    Some drivers compile a shader when it first runs, on one core; so they begin with these while other things
    are prepared. The tables have the sizes that `Sky` gives them, and its pipelines are these.
    """
    graph = FrameGraph(device)
    graph.uniform("view", VIEW)
    graph.uniform("sky.light", LIGHT)
    graph.uniform("sky.air", AIR).set(**Air.of(world).uniform())
    _still_tables(graph, quality)
    if shaded:
        lit = np.full((*quality.aerial_size[::-1], 4), 255, np.uint8)
        graph.texture_data("sky.shares", lit, "rgba8unorm", dimension="3d")
    _frame_tables(graph, quality, _never, shaded)
    graph.output("sky.view_table", "sky.aerial_inscatter", "sky.irradiance")
    graph.compile()
    graph.execute()


def _never() -> bool:
    """For passes that run once, before somebody reads what they make."""
    return False


def _still_tables(graph: FrameGraph, quality: Quality) -> None:
    """Tables of the air alone, which is the same as long as the graph lives."""
    width, height = quality.transmittance_size
    graph.texture("sky.transmittance", "rgba16float", (width, height), persistent=True)
    graph.compute(
        "sky.transmittance",
        "package::sky::transmittance",
        bind={"air": "sky.air", "output": "sky.transmittance"},
        groups=(-(-width // 8), -(-height // 8), 1),
        constants={"STEPS": 40},
        structs=[AIR],
        when=_never,
    )
    bind = {"air": "sky.air", "transmittance": "sky.transmittance", "linear": _LINEAR}
    width, height = quality.multiscattering_size
    graph.texture("sky.multiscattering", "rgba16float", (width, height), persistent=True)
    graph.compute(
        "sky.multiscattering",
        "package::sky::multiscattering",
        bind={**bind, "output": "sky.multiscattering"},
        groups=(width, height, 1),
        constants={"STEPS": 20},
        structs=[AIR],
        when=_never,
    )
    graph.texture("sky.skylight", "rgba16float", (64, 8), persistent=True)
    graph.compute(
        "sky.skylight",
        "package::sky::skylight",
        bind={**bind, "multiple": "sky.multiscattering", "output": "sky.skylight"},
        groups=(64, 8, 1),
        constants={"STEPS": 20},
        structs=[AIR],
        when=_never,
    )


def _frame_tables(
    graph: FrameGraph, quality: Quality, moon_matters: Callable[[], bool], shaded: bool
) -> None:
    """Tables of the air under this frame's lights, from this frame's camera."""
    structs = [AIR, LIGHT]
    bind = {
        "view": "view",
        "air": "sky.air",
        "light": "sky.light",
        "transmittance": "sky.transmittance",
        "multiple": "sky.multiscattering",
        "linear": _LINEAR,
    }
    width, height = quality.sky_view_size
    for name, moon in (("sky.view_table", False), ("sky.view_table_moon", True)):
        graph.texture(name, "rgba16float", (width, height), persistent=True)
        graph.compute(
            name,
            "package::sky::view_table",
            bind={**bind, "sky_light": "sky.skylight", "output": name},
            groups=(-(-width // 8), -(-height // 8), 1),
            flags={"MOON": moon},
            constants={"STEPS": quality.sky_view_steps},
            structs=structs,
            when=moon_matters if moon else None,
        )
    width, height, depth = quality.aerial_size
    for name in ("sky.aerial_inscatter", "sky.aerial_transmittance"):
        graph.texture(name, "rgba16float", (width, height, depth), dimension="3d", persistent=True)
    graph.buffer("sky.irradiance", 9 * 16, persistent=True)
    # shaders of their own for moonlit nights: where the moon does not matter nobody pays for it
    for suffix, moon, when in (("", False, lambda: not moon_matters()), (".moon", True, moon_matters)):
        graph.compute(
            "sky.aerial" + suffix,
            "package::sky::aerial",
            bind={
                **bind,
                "inscatter": "sky.aerial_inscatter",
                "through": "sky.aerial_transmittance",
                "shares": "sky.shares",
            },
            groups=(-(-width // 8), -(-height // 8), 1),
            flags={"MOON": moon, "SHARES": shaded},
            constants={"STEPS": quality.aerial_steps},
            structs=structs,
            when=when,
        )
        graph.compute(
            "sky.irradiance" + suffix,
            "package::sky::irradiance",
            bind={**bind, "sky_light": "sky.skylight", "irradiance": "sky.irradiance"},
            groups=(1, 1, 1),
            flags={"MOON": moon},
            constants={"STEPS": 12},
            structs=structs,
            when=when,
        )
