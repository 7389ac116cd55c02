"""The ring's passes: a picture of far clouds, kept, and the octagon behind the sprites near by."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ....gpu import VIEW, FrameGraph, Struct
from ....world.state import CameraState, FrameState, local_axes, map_coordinates, view_values
from ...frame import CLOUD_FRAME, frame_values
from ..draw import RING, add_sprites, depth_texels
from ..scope import BLOCK, LIMIT, RING_VIEW, SPRITE_SCOPE
from .parts import SIDES, Part, by_block, by_side
from .plan import Plan
from .plan import Ring as Made

if TYPE_CHECKING:
    from ....gpu.resources import Uniform
    from ...passes import Clouds

TEXELS = 256
MARGIN = 1.0 - 4.0 / TEXELS
"""Part of a picture that its side of the octagon shows: the rest is for interpolation at the seams."""
FOV = 2.0 * np.arctan(np.tan(np.pi / SIDES) / MARGIN)
FAR = 1e9
"""Farther than any cloud, m."""

RING_KEPT = Struct(
    "RingKept",
    [
        ("layer", "u32", "of the pictures, that was drawn"),
        ("more", "u32", "0: begun anew"),
        ("start", "u32", "of the picture's texels among those drawn so far"),
    ],
)


class Ring:
    """The ring of a world's sprites.

    Parameters
    ----------
    graph : FrameGraph
    clouds : Clouds
    scope : Uniform
        Of the sprites near by: is told what the ring shows.
    artist : bool
        With the artists' colours: pictures of these, too.
    """

    def __init__(self, graph: FrameGraph, clouds: Clouds, scope: Uniform, *, artist: bool = False):
        layers = clouds.field.field.layers
        settings = clouds.world.clouds.sprites
        self._graph, self._clouds, self._near = graph, clouds, scope
        self._winds = np.array([layer.wind for layer in layers])
        ages = [layer.lifetime for layer in layers if layer.lifetime > 0.0]
        reach = 0.5 * clouds.field.window * max(layer.cell for layer in layers)
        reach = min(clouds.world.clouds.visibility, reach)
        self._apart = settings.ring_update == "block"
        if self._apart:
            widest = 1.3 * max(layer.radius[1] for layer in layers)
            steps = by_block(settings.ring_radius, reach, widest)
        else:
            steps = by_side(settings.ring_radius, reach)
        self.plan = Plan(settings.ring_radius, self._winds, min(ages, default=np.inf), steps)
        self._view = graph.uniform("clouds.ring.view", VIEW)
        self._frame = graph.uniform("clouds.ring.frame", CLOUD_FRAME)
        self._scope = graph.uniform("clouds.ring.scope", SPRITE_SCOPE)
        self._kept = graph.uniform("clouds.ring.kept", RING_KEPT)
        self._add(graph, clouds, artist)

    def _add(self, graph: FrameGraph, clouds: Clouds, artist: bool) -> None:
        bind, onto = {"kept": "clouds.ring.kept"}, {"pictures": "clouds.layer"}
        for drawn, pictures, parts in (
            ("drawn", "pictures", "parts"),
            ("painted", "colours", "painted_parts"),
        )[: 1 + artist]:
            graph.texture(f"clouds.ring.{drawn}", "rgba16float", (TEXELS, TEXELS), persistent=True)
            texels = TEXELS**2 * (SIDES if self._apart else 1)
            graph.buffer(f"clouds.ring.{parts}", 8 * texels, persistent=True)
            size = TEXELS, TEXELS, 2 * SIDES
            graph.texture(
                f"clouds.ring.{pictures}", "rgba8unorm", size, dimension="2d-array", persistent=True
            )
            bind |= {name: f"clouds.ring.{name}" for name in (drawn, pictures, parts)}
        if artist:
            onto["colours"] = "clouds.colour"
        graph.texture("clouds.ring.closed", "depth32float", (TEXELS, TEXELS), persistent=True)
        targets = ("clouds.ring.drawn", "clouds.ring.painted")[: 1 + artist]
        add_sprites(graph, clouds, "clouds.ring", ring=targets, artist=artist, when=self._draws)
        graph.compute(
            "clouds.ring.keep",
            "package::clouds::sprites::ring::keep",
            bind=bind,
            groups=(TEXELS // 8, TEXELS // 8, 1),
            flags={"ARTIST": artist},
            structs=[RING_KEPT],
            when=self._draws,
        )
        closed = {"depth": "clouds.sprites.closed", "depth_write": False, "depth_in_turn": True}
        for pictures, target in onto.items():
            graph.render(
                f"clouds.ring.show_{pictures}",
                "package::clouds::sprites::ring::show",
                color=[target],
                blend="under",
                bind={
                    "view": "view",
                    "scope": "clouds.sprites.scope",
                    "shown": "clouds.ring.pictures",
                    "colours": "clouds.ring.colours",
                    "linear": "sampler:linear-clamp",
                    "scene": "gbuffer.depth",
                },
                vertices=2 * 6 * SIDES,
                flags={"ARTIST": pictures == "colours"},
                structs=[VIEW, RING_VIEW, SPRITE_SCOPE],
                constants={"DEPTH_TEXELS": depth_texels(clouds), "MARGIN": MARGIN},
                when=self._shows,
                order=RING,
                **({} if pictures == "colours" else closed),
            )

    def _draws(self) -> bool:
        return bool(self.plan.parts)

    def _shows(self) -> bool:
        return self.plan.shown is not None

    def update(self, state: FrameState) -> None:
        """Decide what of the ring a frame draws, and tell everybody.

        Of several parts all but the last are drawn here, ahead of the frame.
        """
        plan = self.plan
        place = np.array(map_coordinates(state.camera.position, state.planet_radius))
        now = Made(state.camera.position.copy(), place, state.altitude, self._clouds.key.copy(), state.time)
        plan.update(now, fresh=self._clouds.fresh)
        told: dict[str, Any] = {
            "shown": self._told(plan.shown, 1.0 - plan.weight, state, place),
            "next": self._told(plan.next, plan.weight, state, place),
        }
        # blocks that are not in the ring reach so far
        behind = plan.radius + BLOCK / np.sqrt(2.0) if self._shows() else FAR
        self._near.set(shift=(0.0, 0.0), behind=behind, **told)
        if plan.drawn is None:
            return
        self._scope.set(shown=told["shown"], next=self._told(plan.drawn, 0.0, state, place))
        for part in plan.parts[:-1]:
            self._tell(part, plan.drawn, state, place)
            self._graph.make("clouds.ring.pictures")
        self._tell(plan.parts[-1], plan.drawn, state, place)

    def _tell(self, part: Part, ring: Made, state: FrameState, place: np.ndarray) -> None:
        """Tell the ring's own passes what to draw, seen from the ring's middle."""
        texels = np.clip(part.square, -FAR, FAR)
        self._scope.set(
            shift=place - ring.place, slices=np.clip(part.distances, 0.0, FAR), square=texels, behind=FAR
        )
        start = part.side * TEXELS**2 if self._apart else 0
        self._kept.set(layer=SIDES * ring.set + part.side, more=not part.first, start=start)
        axes = local_axes(float(ring.place[0]), float(ring.place[1]), state.planet_radius)
        angle = 2.0 * np.pi * part.side / SIDES
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
        rows = np.zeros((8, 4))
        if ring is None:
            axes, ring, weight = np.eye(3), Made(state.camera.position, place, 0.0, np.zeros(3), 0.0), 0.0
        else:
            axes = local_axes(float(ring.place[0]), float(ring.place[1]), state.planet_radius)
            for row, layer, wind in zip(rows, self._clouds.field.field.layers, self._winds, strict=False):
                low, high = layer.bounds
                away = max(low - ring.height, ring.height - high, 0.0)
                row[:2] = place - ring.place - wind * (state.time - ring.time)
                row[2] = away <= LIMIT
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
        }
