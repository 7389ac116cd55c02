"""The maps of things as passes of a frame graph."""

from __future__ import annotations

from math import ceil, log
from typing import TYPE_CHECKING, Any

import numpy as np

from ...gpu import VIEW, FrameGraph, Struct
from ...world.state import view_values
from .drawn import STORE_JOB, TEXELS, add_drawn
from .keep import Keep, axes_near
from .window import Window, about, basis

if TYPE_CHECKING:
    from ...world.state import FrameState

MOST = 4
"""Maps of still things about the camera."""
LARGE_RADIUS = 100.0
"""m, from which on a model belongs to the map of large ones."""
FAR = 3e3
"""m from the camera, within which small models that move throw shadows."""
TOGETHER = 60.0
"""m from the nearest of them, within which more share its map; others have that of large ones, if free."""
LOWEST = -0.03
"""Sine of the light's elevation under which nothing is drawn: there is none on the ground."""

NOWHERE = 1e4
"""u of a map that holds nothing."""

CASCADES = Struct(
    "Cascades",
    [
        ("across", "vec3f", "unit, world axes, along u"),
        ("along", "vec3f", "unit, world axes, against v"),
        ("key", "vec3f", "unit, world axes, towards the light"),
        ("finest", "f32", "u per m in map 0; of the next three a quarter each"),
        ("large", "f32", "u per m in the map of large things"),
        ("moving", "f32", "u per m in the map of what moves"),
        ("drawn", "u32", "bits of the maps drawn in this frame"),
        (
            "places",
            f"array<vec4f, {MOST + 2}>",
            "u, v and depth of the camera, depth per m; u = NOWHERE: none",
        ),
    ],
)


class Cascades:
    """Writes ``shadows.maps``; shaders bind `bind` and ask ``cascades/lookup.wesl``.

    Each map is drawn into ``shadows.drawn`` and stored in its layer, one after the other: all but the last of
    a frame ahead of it (`FrameGraph.make`).

    Parameters
    ----------
    graph : FrameGraph
        Must hold what plants and models declare.
    near : float
        m from the camera, as far as the finest map reaches.
    plants : Vegetation or None
    models : Models
        Both can `add_casters`.

    Attributes
    ----------
    any : bool
        False: there is nothing that could throw a shadow, and nothing is declared.
    bind, structs, constants, flags
        What a shader needs that looks up.
    drawn : set of int
        The maps drawn in the frame of the last `update`.
    """

    def __init__(self, graph: FrameGraph, near: float, *, plants: Any, models: Any, wide: bool):
        self._graph, self._plants, self._models = graph, plants, models
        stands = plants.stands if plants is not None else ()
        has_plants = bool(stands)
        self.any = has_plants or len(models) > 0
        self.drawn: set[int] = set()
        if not self.any:
            return
        radius = max((s.radius for s in stands), default=0.0)
        levels = MOST if len(models) else min(max(1 + ceil(log(max(radius / near, 1.0), 4)), 1), MOST)
        self._keep = Keep([near * 4.0**n for n in range(levels)], TEXELS)
        self._large, self._moving = levels, levels + 1
        self._fitted: dict[int, Window | None] = {self._large: None, self._moving: None}
        self._known: list[np.ndarray | None] = [None] * len(models)
        self._home = [levels - 1] * len(models)  # what stands still belongs to all of the first maps
        self._has_plants = has_plants
        self._job: int | None = None
        self._frame = graph.uniform("shadows.cascades", CASCADES)
        self._view = graph.uniform("shadows.view", VIEW)
        self._store = graph.uniform("shadows.store", STORE_JOB)
        self.bind = {"cascades": "shadows.cascades", "drawn": "shadows.maps"}
        self.structs = (CASCADES,)
        self.constants = {"LEVELS": levels, "NEAR": float(near), "TEXELS": TEXELS}
        self.flags = {"MODELS": len(models) > 0, "WIDE": wide}
        self._declare(graph, levels + 2 * (len(models) > 0), has_plants)

    def _declare(self, graph: FrameGraph, layers: int, has_plants: bool) -> None:
        graph.texture(
            "shadows.maps", "r32float", (TEXELS, TEXELS, layers), dimension="2d-array", persistent=True
        )

        add_drawn(graph, "shadows.maps", packed=False, when=lambda: self._job is not None)
        if has_plants:
            self._plants.add_casters(
                graph,
                "shadows",
                view="shadows.view",
                depth="shadows.drawn",
                when=lambda: self._job is not None and self._job < self._large,
            )
        self._models.add_casters(graph, view="shadows.view", depth="shadows.drawn", chosen=self._chosen)

    def _chosen(self, model: int) -> bool:
        """Whether a model is drawn into the map of the job in hand."""
        return self._job is not None and self._home[model] == max(self._job, self._large - 1)

    def update(self, key: np.ndarray, state: FrameState, fresh: bool) -> None:
        """Draw what is due in a frame; after the updates of ground and models.

        Parameters
        ----------
        key : (3,)
            Unit, world axes, towards the light.
        state : FrameState
        fresh : bool
            The first frame, or one after a cut: nothing from before counts.
        """
        camera = state.camera.position
        jobs: list[int] = []
        centre = camera + np.array([0.0, 0.0, state.planet_radius])
        if float(key @ centre) > LOWEST * float(np.linalg.norm(centre)):
            bounds = self._models.bounds(state)
            changed = self._sort(bounds, camera)
            if fresh:
                self._keep.change()
                changed |= {self._large, self._moving}
            if self._stills():
                jobs += self._keep.due(key, camera)
            for number in (self._large, self._moving):
                jobs += self._fit(number, bounds, key, camera, number in changed)
        values = view_values(state) | {"size": (TEXELS, TEXELS)}
        self._job = None
        for number in jobs:
            if self._job is not None:
                self._graph.make("shadows.maps")
            self._job = number
            self._view.set(**values | {"clip_from_world": self._window(number).clip(camera)})
            if self._has_plants:
                self._graph.uniforms["shadows.eye"].set(place=self._window(number).eye(camera))
            self._store.set(layer=number)
        self.drawn = set(jobs)
        self._frame.set(**self._values(key, camera))

    def _sort(self, bounds: list[Any], camera: np.ndarray) -> set[int]:
        """Which map each model belongs to; returns those in which something has changed."""
        changed, apart = set(), _apart(bounds, camera)
        for number, found in enumerate(bounds):
            home = self._large - 1
            if found.radius >= LARGE_RADIUS:
                home = self._large
            elif found.movable:
                home = self._large if number in apart else self._moving
            before = self._home[number]
            if self._known[number] is not found.transforms or home != before:
                changed |= {home, before}
            self._home[number], self._known[number] = home, found.transforms
        if self._large - 1 in changed:
            self._keep.change()
        return changed

    def _stills(self) -> bool:
        """Whether anything stands still that could throw a shadow."""
        plants = self._has_plants and self._plants.casts
        return plants or self._large - 1 in self._home

    def _fit(
        self, number: int, bounds: list[Any], key: np.ndarray, camera: np.ndarray, changed: bool
    ) -> list[int]:
        """Lay the map of large or of moving models; [number] where it is to be drawn."""
        chosen = [found for found, home in zip(bounds, self._home, strict=True) if home == number]
        centres = np.concatenate([found.centres for found in chosen]) if chosen else np.zeros((0, 3))
        radii = np.repeat([found.radius for found in chosen], [len(found.centres) for found in chosen])
        close = (radii >= LARGE_RADIUS) | (np.linalg.norm(centres - camera, axis=1) < FAR)
        centres, radii = centres[close], radii[close]
        window = about(axes_near(key, number), centres, radii) if len(centres) else None
        before, self._fitted[number] = self._fitted[number], window
        return [number] if window is not None and (changed or window != before) else []

    def _window(self, number: int) -> Window:
        window = self._keep.windows[number] if number < self._large else self._fitted[number]
        assert window is not None
        return window

    def _values(self, key: np.ndarray, camera: np.ndarray) -> dict[str, Any]:
        """Every field of `CASCADES` for a frame: the camera moves, kept maps stay.

        Kept maps were drawn for a light that differs by less than `TURNED`; looked up with the axes of this
        frame's they are exact at the camera, and wrong by .2 texels at their borders.
        """
        axes = basis(key)
        places = np.full((MOST + 2, 4), NOWHERE)
        windows = [*self._keep.windows, self._fitted[self._large], self._fitted[self._moving]]
        for number, window in enumerate(windows):
            if window is not None:
                places[number] = (*window.rows(camera)[:, 3], 0.5 / window.half[2])
        per_metre = [0.5 / w.half[0] if w is not None else 0.0 for w in windows]
        return {
            "across": axes[0],
            "along": axes[1],
            "key": axes[2],
            "finest": per_metre[0],
            "large": per_metre[-2],
            "moving": per_metre[-1],
            "drawn": sum(1 << number for number in self.drawn),
            "places": places,
        }


def _apart(bounds: list[Any], camera: np.ndarray) -> set[int]:
    """Small models that move too far from the nearest to share a map with it; none where any are large."""
    if any(found.radius >= LARGE_RADIUS for found in bounds):
        return set()
    movers = {n: found.centres for n, found in enumerate(bounds) if found.movable and len(found.centres)}
    if len(movers) < 2:
        return set()
    every = np.concatenate(list(movers.values()))
    nearest = every[np.argmin(np.linalg.norm(every - camera, axis=1))]
    return {n for n, at in movers.items() if np.linalg.norm(at - nearest, axis=1).min() > TOGETHER}
