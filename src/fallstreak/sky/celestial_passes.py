"""The GPU's share of the heavens: the uniform `sky.light`, and the draws of moon, stars and airglow."""

from __future__ import annotations

from math import tan
from typing import TYPE_CHECKING

import numpy as np

from fallstreak.gpu import EXPOSURE, FrameGraph, Struct

from .air import AIR
from .colour import temperature_colour
from .ephemeris import Ephemeris, Heavens
from .light import LIGHT, MAGNITUDE_ZERO_LUX, light_values
from .moon import RAYED_CRATERS, SEAS, feature_records
from .sight import in_sight
from .stars import star_records

if TYPE_CHECKING:
    from fallstreak.world import World
    from fallstreak.world.quality import Quality
    from fallstreak.world.state import FrameState

PLANETS = 5
MILKY_WAY_SIZE = (512, 512)
WANDERERS = Struct(
    "Wanderers",
    [("spots", f"array<vec4f, {2 * PLANETS}>", "per planet: direction; illuminance above the air, lux")],
)

# B-V of the sunlight each sends back: Mallama and Hilton, Astronomy and Computing 25 (2018).
_PLANET_KELVIN = {
    "Mercury": 5000,
    "Venus": 5400,
    "Earth": 7500,
    "Mars": 3900,
    "Jupiter": 5300,
    "Saturn": 4700,
}


class Celestial:
    """Sun, moon, planets and stars of a world in a frame graph.

    Made before the air's passes, because it declares `sky.light`; `draw` is called after `sky.air`,
    `sky.transmittance` and the frame's `frame.hdr`, `gbuffer.depth` and `frame.exposure` are declared.

    Parameters
    ----------
    graph : FrameGraph
    world : World
        Its place, planet and sky sections.
    quality : Quality
    """

    def __init__(self, graph: FrameGraph, world: World, quality: Quality | None = None):
        self._graph, self._world = graph, world
        self.ephemeris = Ephemeris.of(world)
        self.heavens: Heavens | None = None
        self._light = graph.uniform("sky.light", LIGHT)
        self._wanderers = graph.uniform("sky.wanderers", WANDERERS)
        self._dark = self._moon_up = True
        self._planet_colours: np.ndarray | None = None

    def update(self, state: FrameState) -> dict[str, object]:
        """Set the lights of a frame; returns the values of `sky.light`."""
        return self.shine(self.ephemeris.at(state.utc, state.camera.position), state.altitude)

    def shine(self, heavens: Heavens, altitude: float) -> dict[str, object]:
        """Set the lights of a given sky, for a camera at an altitude (m)."""
        values = light_values(self._world, heavens, altitude)
        self._light.set(**values)
        self._wanderers.set(spots=self._spots(heavens))
        self.heavens = heavens
        # Under a sky of some thousand lux not even Venus is seen; saves the draws of the day. Above the air
        # the sky is black at noon.
        thin = altitude > 0.5 * self._world.sky.top_height
        self._dark = thin or float(values["table_scale"]) > 2e-3  # type: ignore[arg-type]
        self._moon_up = float(values["moon_radius"]) > 0.0  # type: ignore[arg-type]
        return values

    def _spots(self, heavens: Heavens) -> np.ndarray:
        if self._planet_colours is None:
            kelvin = [_PLANET_KELVIN[name] for name in heavens.planet_names]
            self._planet_colours = MAGNITUDE_ZERO_LUX * temperature_colour(kelvin)
        spots = np.zeros((PLANETS, 2, 4))
        spots[:, 0, :3] = heavens.planet_directions
        spots[:, 1, :3] = self._planet_colours * 10 ** (-0.4 * heavens.planet_magnitudes)[:, None]
        return spots.reshape(2 * PLANETS, 4)

    def _sees_moon(self) -> bool:
        light, view = self._light.record, self._graph.uniforms["view"].record
        return self._moon_up and in_sight(view, light["moon_direction"], tan(float(light["moon_radius"])))

    def draw(self) -> None:
        """Declare the draws into `frame.hdr`."""
        sky, graph = self._world.sky, self._graph
        shared = {
            "view": "view",
            "air": "sky.air",
            "light": "sky.light",
            "exposure": "frame.exposure@previous",
        }
        shared |= {"transmittance": "sky.transmittance", "linear": "sampler:linear-clamp"}
        onto = {"color": ["frame.hdr"], "depth": "gbuffer.depth", "depth_write": False, "blend": "add"}
        structs = [AIR, LIGHT, EXPOSURE]
        width, height = MILKY_WAY_SIZE
        graph.texture("sky.milky_way", "rgba16float", (width, height), persistent=True)
        graph.compute(
            "sky.milky_way",
            "package::sky::milky_way",
            bind={"output": "sky.milky_way"},
            groups=(width // 8, height // 8, 1),
            when=lambda: False,  # once, before the first night
        )
        graph.fullscreen(
            "sky.night",
            "package::sky::night",
            bind={**shared, "milky_way": "sky.milky_way"},
            structs=structs,
            depth_compare="equal",
            when=lambda: self._dark,
            order=12,
            **onto,
        )
        if sky.moon and self._world.planet.preset != "mars":
            graph.texture_data("sky.moon_features", feature_records(), "rgba32float", dimension="2d")
            graph.render(
                "sky.moon",
                "package::sky::moon",
                bind={**shared, "features": "sky.moon_features"},
                constants={"SEAS": len(SEAS), "CRATERS": len(RAYED_CRATERS)},
                structs=structs,
                depth_compare="greater-equal",
                topology="triangle-strip",
                vertices=4,
                when=self._sees_moon,
                order=15,
                **onto,
            )
        if sky.stars:
            records = star_records(sky.star_magnitude_limit)
            count = len(records)
            graph.buffer_data("sky.stars", records)
            graph.render(
                "sky.stars",
                "package::sky::stars",
                bind={**shared, "wanderers": "sky.wanderers", "stars": "sky.stars"},
                constants={"PLANETS": np.uint32(PLANETS)},
                structs=[*structs, WANDERERS],
                depth_compare="greater-equal",
                vertices=3 * (PLANETS + count),
                when=lambda: self._dark,
                order=20,
                **onto,
            )
