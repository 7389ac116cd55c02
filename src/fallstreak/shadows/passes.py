"""Shadows in a frame: the land's, the things', and the picture of both that lighting reads."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ..gpu import FrameGraph
from .cascades import CASCADES, PACKED, Cascades, Packed
from .frame import SHADOWS, shadow_values
from .sweep import ABSENT, Sweep

if TYPE_CHECKING:
    from ..world import World
    from ..world.quality import Quality
    from ..world.state import FrameState

_ABSENT = {"LEVELS": 1, "NEAR": 1.0, "TEXELS": 1, **ABSENT}
"""Constants of what a world does not have, so that shaders link with every combination of flags."""


class Shadows:
    """Shadows as passes of a frame graph; nothing where a world wants none.

    Writes ``shadows.light``.

    Parameters
    ----------
    graph : FrameGraph
        Must hold ``view``, the G-buffer and ``sky.light``.
    world : World
    quality : Quality
    size : (int, int)
        Of the picture, pixels.
    terrain : Terrain
    models : Models

    Attributes
    ----------
    any : bool
        False: nothing is declared.
    """

    def __init__(
        self,
        graph: FrameGraph,
        world: World,
        quality: Quality,
        size: tuple[int, int],
        *,
        terrain: Any,
        models: Any,
    ):
        settings = world.shadows
        self._fresh = True
        self.sweep: Sweep | None = None
        if settings.technique == "stable" and terrain.profile is not None:
            self.sweep = Sweep(graph, terrain.profile)
        self.cascades: Cascades | Packed | None = None
        if settings.technique != "none":
            made = (
                Cascades(
                    graph, settings.near, plants=terrain.vegetation, models=models, wide=quality.shadow_wide
                )
                if settings.technique == "stable"
                else Packed(graph, terrain=terrain, models=models)
            )
            self.cascades = made if made.any else None
        self.any = self.sweep is not None or self.cascades is not None
        if not self.any:
            return
        self._settings = settings
        self._light = graph.uniforms["sky.light"]
        self._frame = graph.uniform("shadows.frame", SHADOWS)
        asked = self.lookups()
        graph.texture("shadows.light", "rg8unorm", size)
        graph.render(
            "shadows.light",
            "package::shadows::light",
            color=["shadows.light"],
            depth="gbuffer.depth",
            depth_compare="less",
            depth_write=False,
            bind=asked["bind"]
            | {
                "depth_buffer": "gbuffer.depth",
                "normal_buffer": "gbuffer.normal",
                "surface_buffer": "gbuffer.surface",
            },
            structs=asked["structs"],
            constants=asked["constants"],
            flags=asked["flags"] | {"WOODS": terrain.wooded, "CONTACT": settings.contact > 0.0},
        )
        if settings.show:
            self._add_show(graph)

    def lookups(self) -> dict[str, Any]:
        """What a pass declares that asks land and things for light: bind, constants, flags, structs."""
        parts = [part for part in (self.sweep, self.cascades) if part is not None]
        bind = {"view": "view", "shadows": "shadows.frame", "repeat": "sampler:linear-repeat"}
        constants: dict[str, Any] = dict(_ABSENT)
        for part in parts:
            bind |= part.bind
            constants |= part.constants
        flags = {
            "LAND": self.sweep is not None,
            "THINGS": isinstance(self.cascades, Cascades),
            "PACKED": isinstance(self.cascades, Packed),
            "MODELS": False,
            "WIDE": False,
        }
        if self.cascades is not None:
            flags |= self.cascades.flags
        structs = [SHADOWS, CASCADES, PACKED]
        return {"bind": bind, "constants": constants, "flags": flags, "structs": structs}

    def _add_show(self, graph: FrameGraph) -> None:
        """Tint the picture by the maps, after light has fallen on it."""
        maps = self.cascades if isinstance(self.cascades, Cascades) else None
        graph.fullscreen(
            "shadows.show",
            "package::shadows::show",
            color=["frame.hdr"],
            depth="gbuffer.depth",
            depth_compare="less",
            blend="multiply",
            bind={"view": "view", "depth_buffer": "gbuffer.depth"} | (maps.bind if maps else {}),
            structs=[CASCADES],
            constants=_ABSENT | (maps.constants if maps else {}),
            flags={"THINGS": maps is not None, "MODELS": False, "WIDE": False},
            order=0.5,
        )

    def begin(self) -> None:
        """Forget all history: the next frame is the first."""
        self._fresh = True

    def update(self, state: FrameState) -> None:
        """Tell everybody of the frame to be rendered; after sky, ground and models."""
        if not self.any:
            return
        values, key = shadow_values(state, self._light.record, self._settings.contact)
        self._frame.set(**values)
        if self.sweep is not None:
            self.sweep.update(key, state, self._fresh)
        if self.cascades is not None:
            self.cascades.update(key, state, self._fresh)
        self._fresh = False
