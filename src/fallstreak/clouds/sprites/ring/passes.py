"""The ring's passes: a picture of far clouds, kept, and the octagon behind the sprites near by."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ....gpu import VIEW, FrameGraph, Struct
from ....world.state import CameraState, FrameState, local_axes, map_coordinates, view_values
from ...frame import CLOUD_FRAME, frame_values
from ..draw import add_sprites, depth_texels
from ..scope import BLOCK, LIMIT, RING_VIEW, SPRITE_SCOPE
from .plan import SIDES, Plan, slices
from .plan import Ring as Made

if TYPE_CHECKING:
    from ....gpu.resources import Uniform
    from ...passes import Clouds

TEXELS = 256
MARGIN = 1.0 - 4.0 / TEXELS
"""Part of a picture that its side of the octagon shows: the rest is for interpolation at the seams."""
FOV = 2.0 * np.arctan(np.tan(np.pi / SIDES) / MARGIN)
PARTS = 8
"""In how many parts a side is drawn where one block is drawn a frame."""

RING_KEPT = Struct(
    "RingKept", [("layer", "u32", "of the pictures, that was drawn"), ("more", "u32", "0: begun anew")]
)


class Ring:
    """The ring of a world's sprites.

    Parameters
    ----------
    graph : FrameGraph
    clouds : Clouds
    scope : Uniform
        Of the sprites near by: is told what the ring shows.
    """

    def __init__(self, graph: FrameGraph, clouds: Clouds, scope: Uniform):
        layers = clouds.field.field.layers
        settings = clouds.world.clouds.sprites
        self._clouds, self._near = clouds, scope
        self._winds = np.array([layer.wind for layer in layers])
        ages = [layer.lifetime for layer in layers if layer.lifetime > 0.0]
        self._parts = slices(
            settings.ring_radius,
            clouds.world.clouds.visibility,
            PARTS if settings.ring_update == "block" else 1,
        )
        self.plan = Plan(settings.ring_radius, self._winds, min(ages, default=np.inf), len(self._parts))
        self._view = graph.uniform("clouds.ring.view", VIEW)
        self._frame = graph.uniform("clouds.ring.frame", CLOUD_FRAME)
        self._scope = graph.uniform("clouds.ring.scope", SPRITE_SCOPE)
        self._kept = graph.uniform("clouds.ring.kept", RING_KEPT)
        graph.texture("clouds.ring.drawn", "rgba16float", (TEXELS, TEXELS), persistent=True)
        graph.buffer("clouds.ring.parts", 16 * TEXELS**2, persistent=True)
        graph.texture(
            "clouds.ring.pictures", "rgba8unorm", (TEXELS, TEXELS, 2 * SIDES), dimension="2d-array",
            persistent=True,
        )  # fmt: skip
        add_sprites(graph, clouds, "clouds.ring", ring="clouds.ring.drawn", when=self._draws)
        graph.compute(
            "clouds.ring.keep",
            "package::clouds::sprites::ring::keep",
            bind={
                "drawn": "clouds.ring.drawn",
                "pictures": "clouds.ring.pictures",
                "kept": "clouds.ring.kept",
                "parts": "clouds.ring.parts",
            },
            groups=(TEXELS // 8, TEXELS // 8, 1),
            structs=[RING_KEPT],
            when=self._draws,
        )
        graph.render(
            "clouds.ring.show",
            "package::clouds::sprites::ring::show",
            color=["clouds.layer"],
            blend="over",
            bind={
                "view": "view",
                "scope": "clouds.sprites.scope",
                "shown": "clouds.ring.pictures",
                "linear": "sampler:linear-clamp",
                "scene": "gbuffer.depth",
            },
            vertices=2 * 6 * SIDES,
            structs=[VIEW, RING_VIEW, SPRITE_SCOPE],
            constants={"DEPTH_TEXELS": depth_texels(clouds), "MARGIN": MARGIN},
            when=self._shows,
            order=-0.5,
        )

    def _draws(self) -> bool:
        return self.plan.side is not None

    def _shows(self) -> bool:
        return self.plan.shown is not None or self.plan.weight > 0.0

    def update(self, state: FrameState) -> None:
        """Decide what of the ring a frame draws, and tell everybody."""
        plan, radius = self.plan, state.planet_radius
        place = np.array(map_coordinates(state.camera.position, radius))
        plan.update(
            Made(state.camera.position.copy(), place, state.altitude, self._clouds.key.copy(), state.time, 0)
        )
        told: dict[str, Any] = {
            "shown": self._told(plan.shown, 1.0 - plan.weight, state, place),
            "next": self._told(plan.next, plan.weight, state, place),
        }
        behind = plan.radius if self._shows() else 1e9
        self._near.set(shift=(0.0, 0.0), slices=(0.0, 1e9), behind=behind, **told)
        ring = plan.next
        if ring is None or plan.side is None or plan.step is None:
            return
        # seen from the ring's middle, where its first picture was drawn
        self._scope.set(shift=place - ring.place, slices=self._parts[plan.step], behind=1e9, **told)
        self._kept.set(layer=SIDES * ring.set + plan.side, more=plan.step > 0)
        axes = local_axes(float(ring.place[0]), float(ring.place[1]), radius)
        angle = 2.0 * np.pi * plan.side / SIDES
        ahead = np.sin(angle) * axes[:, 0] + np.cos(angle) * axes[:, 1]
        right = np.cos(angle) * axes[:, 0] - np.sin(angle) * axes[:, 1]
        camera = CameraState(ring.position, np.stack([right, axes[:, 2], -ahead], 1), float(FOV))
        there = replace(
            state, size=(TEXELS, TEXELS), camera=camera, previous_camera=camera, jitter=(0.0, 0.0)
        )
        self._view.set(**view_values(there))
        visibility = self._clouds.world.clouds.visibility
        self._frame.set(**frame_values(there, visibility=visibility, key=self._clouds.key))

    def _told(self, ring: Made | None, weight: float, state: FrameState, place: np.ndarray) -> dict[str, Any]:
        """The fields of `RING_VIEW`."""
        rows, bounds = np.zeros((2, 8, 4))
        if ring is None:
            axes, ring, weight = np.eye(3), Made(state.camera.position, place, 0.0, np.zeros(3), 0.0, 0), 0.0
        else:
            axes = local_axes(float(ring.place[0]), float(ring.place[1]), state.planet_radius)
            for i, layer in enumerate(self._clouds.field.field.layers):
                middle = ring.place - self._winds[i] * ring.time
                corner = BLOCK * np.floor(middle / BLOCK)
                rows[i] = *(place - self._winds[i] * state.time - corner), *(middle - corner)
                low, high = layer.bounds
                away = max(low - ring.height, ring.height - high, 0.0)
                bounds[i, 0] = away <= LIMIT
        return {
            "height": ring.height,
            "radius": self.plan.radius,
            "weight": weight,
            "first": SIDES * ring.set,
            "middle": ring.position - state.camera.position,
            "east": axes[:, 0],
            "north": axes[:, 1],
            "up": axes[:, 2],
            "layers": rows,
            "bounds": bounds,
        }
