"""The cloud-shadow map as passes of a frame graph."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from ...gpu import Struct
from ...world.state import map_coordinates
from .model import local_key, lumps, main_wind, mean_density, shadow_values
from .schedule import MAPS, Schedule

if TYPE_CHECKING:
    from ...world.state import FrameState
    from ..passes import Clouds

CLOUD_SHADOW = Struct(
    "CloudShadow",
    [
        ("key", "vec3f", "unit, towards the light; east, north, up at the camera, never level"),
        ("middle", "f32", "m above the sea, from which v counts"),
        ("across", "vec3f", "unit, of u; level"),
        ("low", "f32", "m above the sea, lowest base of all clouds"),
        ("along", "vec3f", "unit, of v"),
        ("per_height", "f32", "1/m, over the height from the lowest base to the highest top"),
        ("maps", "array<vec4f, 4>", "m: middle, half sizes (u, v); finest to widest, straight down"),
        ("blur", "f32", "m, height of the clouds above the ground that they light"),
        ("dense", "array<vec4f, 2>", "by layer: mean density within the ellipsoids of the clouds' boxes"),
        ("moonlit", "f32", "1: the light is the moon's, 0: the sun's"),
        ("far", "f32", "1: the camera is so high that the map would be a patch on the ground"),
    ],
)

FAR = (50e3, 120e3)
"""m, the camera's height; between them single shadows give way to their mean."""

OVERHEAD = 32
"""Texels along a side of ``clouds.overhead``."""


class ShadowMap:
    """Writes ``clouds.shadow`` (4 layers) and ``clouds.overhead``; the uniform is ``clouds.shadow_frame``.

    Shaders bind them as ``shadow_map`` and ``shadow`` and ask ``shadow/lookup.wesl``. In a sequence one map a
    frame is drawn (`schedule`); the others lie where their clouds have drifted to.

    Parameters
    ----------
    clouds : Clouds
        With its field; `key`, `moonlit` and `fresh` count when `update` is called.
    """

    def __init__(self, clouds: Clouds):
        self._clouds, graph = clouds, clouds.graph
        self._texels = texels = clouds.quality.cloud_shadow
        bounds = [layer.bounds for layer in clouds.field.field.layers]
        self._heights = min(low for low, _ in bounds), max(high for _, high in bounds)
        self._uniform = graph.uniform("clouds.shadow_frame", CLOUD_SHADOW)
        self._schedule = Schedule(main_wind(clouds.field.field))
        size = (texels, texels, 2 * MAPS - 1)  # of all but the last another layer
        graph.texture("clouds.shadow", "rgba16float", size, dimension="2d-array", persistent=True)
        graph.texture("clouds.overhead", "rgba16float", (OVERHEAD, OVERHEAD), persistent=True)
        field = clouds.field.field
        made = lumps(field.packed.boxes, field.packed.models)
        graph.buffer_data("clouds.lumps", made)
        dense = np.zeros(8)
        dense[: len(field.layers)] = [mean_density(field, i, made) for i in range(len(field.layers))]
        self._uniform.set(dense=dense.reshape(2, 4))
        structs = [CLOUD_SHADOW, *clouds.field.structs]
        for number in range(MAPS):
            graph.compute(
                f"clouds.shadow.{number}",
                "package::clouds::shadow::map",
                bind={
                    "shadow": "clouds.shadow_frame",
                    "lumps": "clouds.lumps",
                    "output": "clouds.shadow",
                    **clouds.field.bind,
                },
                groups=(-(-texels // 32), -(-texels // 16), 1),  # a thread makes 4 × 2 texels
                structs=structs,
                constants={**clouds.field.constants, "MAP": number},
                when=self._when(number),
            )
        graph.compute(
            "clouds.overhead",
            "package::clouds::shadow::overhead",
            bind={
                "shadow": "clouds.shadow_frame",
                "map": "clouds.shadow",
                "linear": "sampler:linear-clamp",
                "output": "clouds.overhead",
            },
            groups=(OVERHEAD // 8, OVERHEAD // 8, 1),
            structs=structs,
            when=self._when(MAPS - 1),
        )

    def _when(self, number: int) -> Callable[[], bool]:
        return lambda: number in self._schedule.due

    def update(self, state: FrameState) -> None:
        """Lay the maps about the frame's camera."""
        centre = state.camera.position + np.array([0.0, 0.0, state.planet_radius])
        key = local_key(self._clouds.key, centre / np.linalg.norm(centre))
        camera = np.array(map_coordinates(state.camera.position, state.planet_radius))
        values = shadow_values(key, camera, self._heights, self._texels)
        values["maps"] = self._schedule.lay(
            values, camera, state.time, self._texels, fresh=self._clouds.fresh
        )
        height = float(np.linalg.norm(centre)) - state.planet_radius
        far = float(np.clip((height - FAR[0]) / (FAR[1] - FAR[0]), 0.0, 1.0))
        self._uniform.set(**values, moonlit=float(self._clouds.moonlit), far=far)
