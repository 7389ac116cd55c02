"""The land and its swept shadows alone, with a pass that looks at given places."""

from __future__ import annotations

from dataclasses import replace
from datetime import UTC, datetime

import numpy as np
from shader_probes import find_probes

import fallstreak as fs
from fallstreak.frame.gbuffer import add_gbuffer
from fallstreak.gpu import VIEW, FrameGraph
from fallstreak.shadows.sweep import Sweep
from fallstreak.terrain.passes import Terrain
from fallstreak.world.quality import QUALITY
from fallstreak.world.state import (
    CameraState,
    FrameState,
    camera_rotation,
    local_axes,
    position_on_planet,
    view_values,
)

PLACES = 16384
SIZE = (640, 360)


class Stage:
    """A world's land; `look` renders a frame and says what light arrives at places."""

    def __init__(self, device, monkeypatch, scene="jacksboro", overrides=(), **quality):
        find_probes(monkeypatch, __file__)
        self.world = fs.load(scene, overrides=["terrain.vegetation=0", *overrides])
        self.quality = replace(QUALITY["low"], **quality)
        self.graph = FrameGraph(device)
        self.view = self.graph.uniform("view", VIEW)
        add_gbuffer(self.graph, SIZE)
        self.terrain = Terrain(device, self.graph, self.world, self.quality, SIZE)
        self.sweep = Sweep(self.graph, self.terrain.profile)
        self.graph.buffer_data("places", np.zeros((PLACES, 4), np.float32))
        self.graph.buffer_data("normals", np.tile(np.float32([0, 0, 1, 0]), (PLACES, 1)))
        self.graph.buffer("found", 4 * PLACES)
        self.graph.compute(
            "probe",
            "package::sweep_probe",
            bind={
                **self.sweep.bind,
                "repeat": "sampler:linear-repeat",
                "places": "places",
                "normals": "normals",
                "found": "found",
            },
            groups=(PLACES // 64, 1, 1),
            constants=self.sweep.constants,
        )
        self.graph.output("shadows.sweep", "terrain.shape", "found")
        self.graph.compile()

    @property
    def radius(self):
        return self.world.planet.radius

    def state(self, east, north, height):
        camera = CameraState(
            position_on_planet(east, north, height, self.radius),
            camera_rotation(0.0, 0.0, 0.0, local_axes(east, north, self.radius)),
            np.radians(60.0),
        )
        now = datetime(2025, 6, 1, tzinfo=UTC)
        return FrameState(0, 0.0, now, 0.0, self.world.seed, SIZE, self.radius, camera, camera)

    def key(self, azimuth, elevation, east=0.0, north=0.0):
        """World axes; degrees as seen from a place of the map."""
        a, e = np.radians([azimuth, elevation])
        local = np.array([np.sin(a) * np.cos(e), np.cos(a) * np.cos(e), np.sin(e)])
        return local_axes(east, north, self.radius) @ local

    def look(self, camera, key, places=None, fresh=True, footprint=0.0, normals=None):
        """Light at places (n, 3: east, north on the map, height above the sea) of a frame, (n,)."""
        state = self.state(*camera)
        self.view.set(**view_values(state))
        self.terrain.update(state)
        self.sweep.update(key, state, fresh)
        count = 0 if places is None else len(places)
        if places is not None:
            given = np.zeros((PLACES, 4), np.float32)
            given[:count, :3] = np.asarray(places) - np.array([camera[0], camera[1], 0.0])
            given[:count, 3] = footprint
            self.graph.upload("places", given)
        if normals is not None:
            given = np.zeros((PLACES, 4), np.float32)
            given[:count, :3] = normals
            self.graph.upload("normals", given)
        self.graph.execute()
        return np.array(self.graph.read("found")).view(np.float32)[:count]

    def swept(self):
        """(levels, W, W, 3): ground, and the two shadow heights above the sea."""
        found = np.array(self.graph.read("shadows.sweep"), np.float64)
        ground = 8.0 * found[..., 0] + found[..., 1]
        return np.stack([ground, ground + found[..., 2], ground + found[..., 3]], -1)

    def at_samples(self, level):
        """Both shadow heights at a level's samples (rows north), out of the sheared grid: 2 × (W, W)."""
        n, (_, across, slope, northern) = self.sweep.constants["SWEEP_WIDTH"], self.sweep._lies[level]
        phase = 0.5 + 0.5 * slope - across * n
        i, minor = np.mgrid[0:n, 0:n]
        line = minor - phase - slope * i
        left = np.floor(line).astype(int)
        part = line - left
        found = []
        for heights in np.moveaxis(self.swept()[level, ..., 1:], -1, 0):
            taken = (1.0 - part) * heights[left % n, i] + part * heights[(left + 1) % n, i]
            found.append(taken if northern else taken.T)
        return found
