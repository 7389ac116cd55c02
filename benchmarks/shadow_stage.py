"""A world's surfaces and the shadows on them, without air and light: pictures, and the same places again.

What ``bench_shadows`` measures shimmer and edges on, and ``tests/shadows`` holds to it.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import tan

import numpy as np

from fallstreak.frame.exposure import add_exposure_buffer
from fallstreak.frame.gbuffer import add_gbuffer
from fallstreak.gpu import VIEW, Device, FrameGraph
from fallstreak.models.passes import Models
from fallstreak.models.poses import PlacedModels
from fallstreak.shadows.cascades import Cascades
from fallstreak.shadows.passes import Shadows
from fallstreak.sky.passes import Sky
from fallstreak.terrain.passes import Terrain
from fallstreak.world import World
from fallstreak.world.quality import QUALITY
from fallstreak.world.state import (
    CameraState,
    FrameState,
    camera_rotation,
    local_axes,
    position_on_planet,
    view_values,
)


@dataclass(frozen=True)
class Picture:
    """What is seen of shadows in a frame.

    Attributes
    ----------
    light : (H, W) float64
        Share of the sun's or the moon's light.
    places : (H, W, 3) float64
        World coordinates of the pixels' middles, m; NaN where there is sky.
    normals : (H, W, 3) float64
        As the G-buffer holds them.
    along : (H, W) float64
        m along the view axis.
    """

    light: np.ndarray
    places: np.ndarray
    normals: np.ndarray
    along: np.ndarray


@dataclass(frozen=True)
class Pose:
    """Where a camera is: on the map, above the sea and above the ground (m), its angles (degrees)."""

    east: float
    north: float
    height: float
    above: float
    heading: float
    pitch: float
    fov: float


class Stage:
    """Draws what a world shows, and asks for the shadows on it.

    Parameters
    ----------
    device : Device
    world : World
    size : (int, int)
        Pixels.
    quality : str
    """

    def __init__(self, device: Device, world: World, size: tuple[int, int], quality: str = "low"):
        self.world, self.size = world, size
        chosen = QUALITY[quality]
        self.graph = graph = FrameGraph(device)
        self._view = graph.uniform("view", VIEW)
        add_exposure_buffer(graph)
        add_gbuffer(graph, size)
        graph.texture("frame.hdr", "rgba16float", size)
        self._sky = Sky(device, graph, world, chosen, size)
        self._terrain = Terrain(device, graph, world, chosen, size)
        self._models = Models(graph, PlacedModels(world))
        self.shadows = Shadows(graph, world, chosen, size, terrain=self._terrain, models=self._models)
        self._count = size[0] * size[1]
        self._add_probe()
        graph.output("shadows.light", "gbuffer.depth", "gbuffer.normal", "shadows.found")
        graph.compile()
        self._frames = 0

    def _add_probe(self) -> None:
        graph, asked = self.graph, self.shadows.lookups()
        for name in ("places", "normals"):
            graph.buffer_data(f"shadows.{name}", np.zeros((self._count, 4), np.float32))
            asked["bind"][name] = f"shadows.{name}"
        graph.buffer("shadows.found", 8 * self._count)
        asked["bind"]["found"] = "shadows.found"
        graph.compute(
            "shadows.probe",
            "package::shadows::selftest_light",
            groups=(-(-self._count // 64), 1, 1),
            **asked,
        )

    @property
    def key(self) -> np.ndarray:
        """Unit, world axes: towards the light of the last frame."""
        return self.graph.uniforms["shadows.frame"].record["key"].astype(np.float64)

    @property
    def reaches(self) -> list[float]:
        """m, of the maps of things that stand still."""
        cascades = self.shadows.cascades
        assert isinstance(cascades, Cascades)
        levels, near = int(cascades.constants["LEVELS"]), float(cascades.constants["NEAR"])
        return [near * 4.0**n for n in range(levels)]

    @property
    def windows(self) -> np.ndarray:
        """First samples of the windows in which the land is swept, (levels, 2)."""
        assert self.shadows.sweep is not None
        return self.shadows.sweep._schedule.firsts.copy()

    @property
    def renewed(self) -> bool:
        """Whether something that is otherwise kept was drawn or swept in the last frame."""
        sweep, cascades = self.shadows.sweep, self.shadows.cascades
        drawn = isinstance(cascades, Cascades) and bool(cascades.drawn)
        return drawn or (sweep is not None and sweep._due)

    def pose(self) -> Pose:
        """The world's camera at its first second."""
        found = self.world.camera.at(0.0)
        heading, pitch, _, fov = np.degrees(found.angles)
        above = found.height - (0.0 if found.above == "ground" else self.ground(found.east, found.north))
        height = above + self.ground(found.east, found.north)
        return Pose(found.east, found.north, height, above, float(heading), float(pitch), float(fov))

    def ground(self, east: float, north: float) -> float:
        """Height of the ground above the sea, m."""
        return float(self.world.terrain.height(east, north))

    def camera(
        self,
        east: float | None = None,
        north: float | None = None,
        height: float | None = None,
        heading: float | None = None,
    ) -> CameraState:
        """Map coordinates and height above the sea, m; degrees. What is not given is as in `pose`."""
        pose, radius = self.pose(), self.world.planet.radius
        east = pose.east if east is None else east
        north = pose.north if north is None else north
        height = pose.height if height is None else height
        heading = pose.heading if heading is None else heading
        axes = local_axes(east, north, radius)
        rotation = camera_rotation(np.radians(heading), np.radians(pose.pitch), 0.0, axes)
        return CameraState(position_on_planet(east, north, height, radius), rotation, np.radians(pose.fov))

    def begin(self) -> None:
        """Forget what is kept of earlier frames."""
        self.shadows.begin()

    def render(
        self, camera: CameraState, places: np.ndarray | None = None, normals: np.ndarray | None = None
    ) -> tuple[Picture, np.ndarray]:
        """The next frame, and what arrives at places (n, 3) of the world: (n, 2), of land and things."""
        state = FrameState(
            index=self._frames,
            time=0.0,
            utc=self.world.time_at(0.0),
            delta=0.0,
            seed=self.world.seed,
            size=self.size,
            planet_radius=self.world.planet.radius,
            camera=camera,
            previous_camera=camera,
        )
        self._view.set(**view_values(state))
        self._sky.update(state)
        self._terrain.update(state)
        self._models.update(state)
        self.shadows.update(state)
        self._frames += 1
        count = 0
        if places is not None:
            count = len(places)
            at, upright = np.zeros((2, self._count, 4), np.float32)
            at[:count, :3] = places - camera.position
            upright[:count, :3] = normals
            upright[:count, 3] = -((places - camera.position) @ camera.rotation)[:, 2]
            self.graph.upload("shadows.places", at)
            self.graph.upload("shadows.normals", upright)
        self.graph.execute()
        found = np.array(self.graph.read("shadows.found")).view(np.float32)
        return self._picture(camera), found.reshape(-1, 2)[:count].astype(np.float64)

    def _picture(self, camera: CameraState) -> Picture:
        depth = np.array(self.graph.read("gbuffer.depth"), np.float64)
        light = np.array(self.graph.read("shadows.light"), np.float64).min(-1) / 255.0
        with np.errstate(divide="ignore", invalid="ignore"):
            along = np.where(depth > 0.0, camera.near / depth, np.nan)
        places = camera.position + (along[..., None] * self.rays(camera)) @ camera.rotation.T
        packed = np.array(self.graph.read("gbuffer.normal")).view(np.uint32).reshape(depth.shape)
        return Picture(light, places, _normals(packed), along)

    def rays(self, camera: CameraState) -> np.ndarray:
        """Through the middles of pixels, of length 1 along the view axis, camera's axes: (H, W, 3)."""
        width, height = self.size
        t = tan(camera.fov / 2.0)
        y, x = np.indices((height, width)) + 0.5
        return np.stack(
            [(2 * x / width - 1) * t * width / height, (1 - 2 * y / height) * t, -np.ones_like(x)], -1
        )

    def pixels(self, camera: CameraState, places: np.ndarray) -> np.ndarray:
        """Where world coordinates (..., 3) are in the picture, (..., 2) in pixels; NaN behind the camera."""
        width, height = self.size
        x, y, z = np.moveaxis((places - camera.position) @ camera.rotation, -1, 0)
        t = tan(camera.fov / 2.0)
        along = np.where(z < 0.0, -z, np.nan)
        u = 0.5 + 0.5 * x / (along * t * width / height)
        v = 0.5 - 0.5 * y / (along * t)
        return np.stack([u * width, v * height], -1)


def _normals(packed: np.ndarray) -> np.ndarray:
    """Of rgb10a2unorm codes, as ``gpu/gbuffer.wesl`` reads them."""
    p = (np.stack([packed & 1023, (packed >> 10) & 1023], -1).astype(np.float64) - 511.0) / 511.0
    z = 1.0 - np.abs(p).sum(-1)
    side = np.where(p >= 0.0, 1.0, -1.0)
    found = np.concatenate([p - side * np.maximum(-z, 0.0)[..., None], z[..., None]], -1)
    return found / np.linalg.norm(found, axis=-1, keepdims=True)
