"""The swept shadow heights as a pass of a frame graph."""

from __future__ import annotations

from math import cos, radians, tan
from typing import TYPE_CHECKING, Any

import numpy as np

from ...gpu import FrameGraph, Struct
from ...world.state import local_axes, map_coordinates
from .model import DISC
from .schedule import Schedule, key_near

if TYPE_CHECKING:
    from ...world.state import FrameState

MOST_TILES = 20
"""Of 32 samples, even, that are swept of a window's width: memory."""
TILE = 32
KEPT = (2, 4)
"""Every second line and every fourth sample along it is kept as it is, for the next finer level."""
RECESS = {False: 0.0, True: 24.0}
"""m, how deep walls that lean over may lie behind their edges; 0: none do."""
ABSENT = {"SWEEP_SPACING": 1.0, "SWEEP_WIDTH": 32, "SWEEP_LEVELS": 1, "SWEEP_RECESS": 0.0}
"""Constants of land that throws no shadows, so that shaders link with every combination of flags."""
LOWEST, HIGHEST = radians(-6.0), radians(85.0)
"""Elevations between which the light is taken to be."""

SWEEP_JOB = Struct(
    "SweepJob",
    [
        ("first", "vec2i", "sample of the clipmap with which the window begins"),
        ("middle", "vec2f", "of the window, samples: where its plane touches the planet"),
        ("level", "i32", ""),
        ("northern", "i32", "1: north is the major axis, 0: east"),
        ("from_end", "i32", "1: the light comes from the major axis' far end"),
        ("slope", "f32", "minor over major of the azimuth, -1..1"),
        ("phase", "f32", "minor coordinate of line 0 at the window's first sample"),
        ("fall", "vec2f", "m from one sample to the next, towards the disc's lower and upper edge"),
        ("curve", "f32", "1/(2 R) in m and samples: by this times d² the ground sinks"),
        (
            "coarse",
            "vec4f",
            "window's first sample in the next level's (major, minor; samples), slope, 1: north",
        ),
        ("any_coarse", "i32", "1: there is a next level"),
    ],
)


class Sweep:
    """Writes ``shadows.sweep``, a layer for each level of the ground's clipmap.

    Shaders bind `bind`, and ask ``sweep/lookup.wesl``.

    Parameters
    ----------
    graph : FrameGraph
    profile : terrain.profile.Profile
        The ground's heights: bindings and module of a shader, and where the windows lie.

    Attributes
    ----------
    bind, constants
        What a shader needs that looks up.
    """

    def __init__(self, graph: FrameGraph, profile: Any):
        self._graph, self._profile = graph, profile
        # a window is the clipmap's, or its middle
        tiles = min(profile.tiles, MOST_TILES)
        self._rim = TILE * ((profile.tiles - tiles) // 2)
        self._width = width = tiles * TILE
        self._levels = levels = profile.levels
        self._spacing = profile.spacing * 2.0 ** np.arange(levels)
        self._schedule = Schedule(levels)
        self._lies = np.zeros((levels, 4))  # as lookup.wesl has them, but from the window's first sample
        self._job = graph.uniform("shadows.sweep_job", SWEEP_JOB)
        self._due = False
        self.bind = {"sweep_levels": "shadows.sweep_levels", "sweep_map": "shadows.sweep"}
        self.constants = {
            "SWEEP_SPACING": float(profile.spacing),
            "SWEEP_WIDTH": width,
            "SWEEP_LEVELS": levels,
            "SWEEP_RECESS": RECESS[profile.flags["SHIFT"]],
        }
        graph.texture(
            "shadows.sweep", "rgba16float", (width, width, levels), dimension="2d-array", persistent=True
        )
        nowhere = np.zeros((1, levels + 1, 4), np.float32)
        graph.texture_data("shadows.sweep_levels", nowhere, "rgba32float")
        kept = (width // KEPT[0]) * (width // KEPT[1])
        graph.buffer("shadows.sweep_kept", 16 * kept * levels, persistent=True)
        graph.compute(
            "shadows.sweep",
            "package::shadows::sweep::sweep",
            bind={
                "job": "shadows.sweep_job",
                "output": "shadows.sweep",
                "kept": "shadows.sweep_kept",
                **profile.bind,
            },
            groups=(width // 32, 1, 1),
            when=lambda: self._due,
            structs=[SWEEP_JOB, *profile.structs],
            constants={**profile.constants, **self.constants},
            flags=profile.flags,
        )

    def update(self, key: np.ndarray, state: FrameState, fresh: bool) -> None:
        """Sweep what is due in a frame; after the terrain's update.

        Parameters
        ----------
        key : (3,)
            Unit, world axes, towards the light.
        state : FrameState
        fresh : bool
            The first frame, or one after a cut: nothing from before counts.
        """
        camera = np.array(map_coordinates(state.camera.position, state.planet_radius))
        finest = int(self._profile.finest)
        near = key_near(key)
        due = self._schedule.due(self._profile.firsts + self._rim, near, finest, fresh=fresh)
        for number, level in enumerate(due):
            self._lay(level, near, state.planet_radius)
            self._due = True
            if number < len(due) - 1:
                self._graph.make("shadows.sweep")
        self._due = bool(due)
        towards = local_axes(float(camera[0]), float(camera[1]), state.planet_radius).T @ key
        self._graph.upload("shadows.sweep_levels", self._levels_from(camera, finest, towards))

    def _lay(self, level: int, key: np.ndarray, radius: float) -> None:
        """Set the job of a level."""
        spacing = float(self._spacing[level])
        first = self._schedule.firsts[level]
        middle = first + self._width // 2
        key = local_axes(float(middle[0]) * spacing, float(middle[1]) * spacing, radius).T @ key
        way = key[:2] / max(float(np.hypot(*key[:2])), 1e-9)
        if not way.any():
            way = np.array([1.0, 0.0])
        northern = int(abs(way[1]) > abs(way[0]))
        major, minor = (way[1], way[0]) if northern else (way[0], way[1])
        slope = float(np.float32(minor / major))
        start = first[::-1] if northern else first
        # lines stand still in the world, wherever the window lies
        phase = float((slope * float(start[0]) - float(start[1])) % 1.0)
        step = spacing * float(np.hypot(1.0, slope))
        elevation = float(np.clip(np.arcsin(np.clip(key[2], -1.0, 1.0)), LOWEST, HIGHEST))
        self._lies[level] = (
            0.5 / self._width,
            (0.5 - phase + 0.5 * slope) / self._width,
            slope,
            northern,
        )
        self._job.set(
            first=first,
            middle=middle - first,
            level=level,
            northern=northern,
            from_end=int(major > 0.0),
            slope=slope,
            phase=phase,
            fall=(step * tan(elevation - DISC), step * tan(elevation + DISC)),
            curve=0.5 * spacing * spacing / radius,
            **self._coarse(level, first),
        )

    def _coarse(self, level: int, first: np.ndarray) -> dict[str, Any]:
        """Where the next level lies as seen from a window's first sample."""
        if level + 1 == self._levels:
            return {"any_coarse": 0}
        lies = self._lies[level + 1]
        place = 0.5 * first - self._schedule.firsts[level + 1]
        major, minor = (place[1], place[0]) if lies[3] else (place[0], place[1])
        return {
            "any_coarse": 1,
            "coarse": (
                major + lies[0] * self._width - 0.5,
                minor + lies[1] * self._width - 0.5 - 0.5 * lies[2],
                lies[2],
                lies[3],
            ),
        }

    def _levels_from(self, camera: np.ndarray, finest: int, towards: np.ndarray) -> np.ndarray:
        """What lookup.wesl asks of each level, as the camera moves and windows stay, and of the light."""
        texels = np.zeros((1, self._levels + 1, 4), np.float32)
        place = (camera / self._spacing[:, None] - self._schedule.firsts) / self._width
        lies = self._lies.copy()
        lies[:, :2] += np.where(self._lies[:, 3:] > 0.5, place[:, ::-1], place)
        along = max(float(np.hypot(*towards[:2])), cos(HIGHEST))
        texels[0, :-1], texels[0, -1] = lies, (finest, *(towards / along))
        return texels
