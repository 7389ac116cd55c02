"""The Infinity journal's cascades (2007): four maps of everything, fitted to the view, in each frame."""

from __future__ import annotations

from math import tan
from typing import TYPE_CHECKING, Any

import numpy as np

from ...gpu import VIEW, FrameGraph, Struct
from ...world.state import view_values
from .drawn import STORE_JOB, TEXELS, add_drawn
from .passes import LOWEST
from .window import basis, slice_around

if TYPE_CHECKING:
    from ...world.state import FrameState

ENDS = (150.0, 500.0, 1666.0, 5555.0)
"""m along the view axis, as far as each map reaches."""
TOWARDS = 0.1
"""Of a slice's far end: how much farther a map reaches towards the light; what is beyond lies there."""

PACKED = Struct(
    "Packed",
    [
        ("rows", "array<vec4f, 12>", "see packed.wesl"),
        ("ends", "vec4f", "m along the view axis, as far as each map reaches; 0: no shadows"),
        ("near", "f32", "m, the camera's near plane"),
    ],
)


class Packed:
    """Writes ``shadows.packed``; shaders bind `bind` and ask ``cascades/packed.wesl``.

    Parameters
    ----------
    graph : FrameGraph
        Must hold what land, plants and models declare.
    terrain : Terrain
    models : Models

    Attributes
    ----------
    any : bool
        False: there is nothing that could throw a shadow, and nothing is declared.
    bind, structs, constants, flags
        What a shader needs that looks up.
    """

    def __init__(self, graph: FrameGraph, *, terrain: Any, models: Any):
        self._graph = graph
        plants = terrain.vegetation
        has_plants = plants is not None and bool(plants.stands)
        self.any = terrain.clip is not None or has_plants or len(models) > 0
        if not self.any:
            return
        self._due = False
        self._frame = graph.uniform("shadows.packed_frame", PACKED)
        self._view = graph.uniform("shadows.view", VIEW)
        self._store = graph.uniform("shadows.store", STORE_JOB)
        self.bind = {"packed": "shadows.packed_frame", "packed_map": "shadows.packed"}
        self.structs = (PACKED,)
        self.constants: dict[str, Any] = {}
        self.flags: dict[str, bool] = {}
        graph.texture(
            "shadows.packed",
            "r32float",
            (2 * TEXELS, 2 * TEXELS, 1),
            dimension="2d-array",
            persistent=True,
        )

        def due() -> bool:
            return self._due

        add_drawn(graph, "shadows.packed", packed=True, when=due)
        target: dict[str, str] = {"view": "shadows.view", "depth": "shadows.drawn"}
        terrain.add_casters(graph, "shadows", **target, when=due)
        if plants is not None and has_plants:
            plants.add_casters(graph, "shadows", **target, when=due)
        models.add_casters(graph, **target, chosen=lambda model: self._due)

    def update(self, key: np.ndarray, state: FrameState, fresh: bool) -> None:
        """Draw all maps anew; after the updates of ground and models.

        Parameters
        ----------
        key : (3,)
            Unit, world axes, towards the light.
        state : FrameState
        fresh : bool
            Makes no difference: nothing is kept.
        """
        camera = state.camera
        centre = camera.position + np.array([0.0, 0.0, state.planet_radius])
        self._due = float(key @ centre) > LOWEST * float(np.linalg.norm(centre))
        if not self._due:
            self._frame.set(ends=(0.0,) * 4, near=camera.near)
            return
        axes = basis(key)
        width, height = state.size
        tangent = tan(camera.fov / 2.0)
        values = view_values(state) | {"size": (TEXELS, TEXELS)}
        rows, near = np.zeros((4, 3, 4)), camera.near
        for number, far in enumerate(ENDS):
            window = slice_around(
                axes,
                camera.position,
                camera.rotation,
                (tangent * width / height, tangent),
                near,
                far,
                TOWARDS * far,
            )
            if number > 0:
                self._graph.make("shadows.packed")
            self._view.set(**values | {"clip_from_world": window.clip(camera.position)})
            self._store.set(layer=number)
            rows[number], near = window.rows(camera.position), far
        self._frame.set(rows=rows.reshape(-1, 4), ends=ENDS, near=camera.near)
