"""A world becomes pictures.

The renderer builds the graph once, then for each frame tells the systems the time and the camera, records and
submits. A frame is a function of (world, index, seed): a sequence's first frame is preceded by `WARM_UP`
frames that nobody sees, and every later one follows its predecessor. When the GPU is lost, everything is
built anew from the world and the last checkpoint, and the frames since are replayed.
"""

from __future__ import annotations

import gc
import time
from collections import deque
from collections.abc import Iterable, Mapping
from concurrent.futures import ThreadPoolExecutor
from functools import lru_cache
from operator import index as whole_number
from typing import TYPE_CHECKING, Any, Literal, Self

import numpy as np

from fallstreak.gpu import VIEW, Device, DeviceLostError, FrameGraph, GpuError, Pending
from fallstreak.models.poses import PlacedModels
from fallstreak.sky.passes import rehearse
from fallstreak.terrain.model import terrain_model
from fallstreak.world.quality import QUALITY, Quality
from fallstreak.world.state import (
    CameraState,
    FrameState,
    camera_rotation,
    local_axes,
    position_on_planet,
    view_values,
)

from . import frame as decode
from .frame import LAYERS, Frame
from .pipeline import Pipeline
from .shafts import land_shades

if TYPE_CHECKING:
    from fallstreak.world import World
    from fallstreak.world.camera import Pose

WARM_UP = 12
"""Frames rendered unseen before the first one of a sequence, so that its history is settled."""

CHECKPOINT_EVERY = 16
"""Frames between two copies of the histories that the renderer keeps in case the GPU is lost."""

_SOURCES = {
    "ldr": "frame.ldr",
    "depth": "gbuffer.depth",
    "normal": "gbuffer.normal",
    "albedo": "gbuffer.albedo",
    "motion": "gbuffer.motion",
    "clouds": "clouds.layer",
}


class Renderer:
    """Renders frames of one world at one size.

    Parameters
    ----------
    world : World
        What there is.
    size : (int, int)
        Width and height in pixels, 16 to 8192.
    quality : str or Quality
        "low", "medium", "high", "ultra", or your own.
    fps : float
        Frames per second of a sequence.
    samples : int, optional
        Jittered samples averaged into each frame. Default: one, with temporal anti-aliasing where the quality
        has it. A number here turns temporal anti-aliasing off, so that frames do not depend on each other but
        for the exposure.
    still : bool
        Frames stand alone: no motion, the exposure settles at once. `render` uses it.
    layers : sequence of str, or one
        What to keep of a frame besides the picture: "hdr", "depth", "normal", "albedo", "motion",
        "clouds".
    bits : 8 or 16
        Of the picture.
    adapter : str, optional
        Part of the name of the GPU adapter to use.
    show : "materials", optional
        A view into the picture instead of it: "materials" paints the shares of the ground's six base
        materials red, green, blue, yellow, cyan and magenta.

    Examples
    --------
    >>> with Renderer(world, size=(640, 360), fps=30) as renderer:   # doctest: +SKIP
    ...     for i in range(90):
    ...         renderer.render(i).save(f"flight.{i:04d}.png")
    """

    def __init__(
        self,
        world: World,
        size: tuple[int, int] = (1280, 720),
        quality: str | Quality = "high",
        *,
        fps: float = 30.0,
        samples: int | None = None,
        still: bool = False,
        layers: tuple[str, ...] | list[str] = (),
        bits: Literal[8, 16] = 8,
        adapter: str | None = None,
        show: Literal["materials"] | None = None,
    ):
        self.world = world
        self.quality = _quality(quality)
        self.size = _checked_size(size)
        if not 0.0 < fps <= 1e4:
            raise ValueError(f"fps = {fps} must be above 0 and at most 10000")
        if bits not in (8, 16):
            raise ValueError(f"bits = {bits} must be 8 or 16")
        if samples is not None and not 1 <= samples <= 65536:
            raise ValueError(f"samples = {samples} must be 1 to 65536")
        layers = (layers,) if isinstance(layers, str) else layers
        unknown = [name for name in layers if name not in LAYERS]
        if unknown:
            raise ValueError(f"layer {unknown[0]!r} is unknown; there are {', '.join(LAYERS)}")
        if show not in (None, "materials"):
            raise ValueError(f'show = {show!r} is unknown; there is "materials"')
        self.show: Literal["materials"] | None = show
        self.fps = fps
        self.still = still
        self.temporal = samples is None and not still and self.quality.temporal
        self.samples = samples or (self.quality.default_samples if still else 1)
        self.layers = tuple(layers)
        self.bits: Literal[8, 16] = bits
        self._adapter = adapter
        # A point costs the ground's model a millisecond or two, and a frame asks for it several times.
        self._ground = lru_cache(16)(lambda east, north: float(world.terrain.height(east, north)))
        self._inflight: deque[PendingFrame] = deque()
        self._log: list[int] = []
        self._kept: Mapping[str, Any] | None = None
        self._keeping: tuple[int, dict[str, Pending]] | None = None
        self._position: int | None = None
        self._cameras: dict[Pose, CameraState] = {}
        self._closed = False
        self.pass_times = False
        """Let `stats` have the time of every pass; see `FrameGraph.pass_times`."""
        self.models = PlacedModels(world)
        """The world's models by name, to be moved between frames."""
        # The ground's model takes a second or two, much of it in NumPy: meanwhile the device opens and
        # begins to compile.
        with ThreadPoolExecutor(1) as beside:
            ground = beside.submit(terrain_model, world)
            self.device = Device.open(adapter)
            rehearse(self.device, world, self.quality, shaded=land_shades(world))
            ground.result()
        self._build()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Give the GPU's memory back; the renderer cannot be used afterwards."""
        if self._closed:
            return
        self._closed = True
        self.device.destroy()
        # The graph and its passes know each other: a software adapter's textures, some hundred MB of this
        # process, would wait for a collector that hardly ever comes by.
        del self.graph, self.pipeline
        gc.collect()

    # ---- frames ----------------------------------------------------------------------------------------

    def render(self, index: int = 0) -> Frame:
        """Render frame `index` of the sequence and wait for it.

        Raises
        ------
        GpuError
            When the GPU cannot do it; a lost device is rebuilt first, and this is raised only if that fails.
        """
        return self.submit(index).result()

    def submit(self, index: int) -> PendingFrame:
        """Start frame `index` and return at once; take the frame by `.result()`."""
        self._check_open()
        pending = PendingFrame(self, index)
        self._inflight.append(pending)
        try:
            self._advance(index, pending)
        except DeviceLostError:
            self._recover()
        return pending

    def stats(self) -> dict[str, Any]:
        """Times of the last frame, bytes of memory, WebGPU calls; waits for the GPU.

        The time of each pass is there with `pass_times`.
        """
        self._check_open()
        return {**self.graph.stats(), "size": self.size, "frame_ms": self._frame_ms}

    # ---- persistence -----------------------------------------------------------------------------------

    def checkpoint(self) -> dict[str, Any]:
        """Everything that the frame after the last one depends on, as numpy arrays."""
        self._check_open()
        return {"frame": np.int64(self._position or 0), **self.graph.checkpoint()}

    def restore(self, checkpoint: Mapping[str, Any]) -> None:
        """Go on as after the frame whose checkpoint this is."""
        self._check_open()
        self.graph.restore({k: v for k, v in checkpoint.items() if k != "frame"})
        self._position = int(checkpoint["frame"])
        self._settled = True
        self._kept, self._keeping, self._log = dict(checkpoint), None, []

    # ---- within ----------------------------------------------------------------------------------------

    def _build(self) -> None:
        self.graph = FrameGraph(self.device)
        self._view = self.graph.uniform("view", VIEW)
        self.pipeline = Pipeline(
            self.graph,
            self.world,
            self.quality,
            self.size,
            self.models,
            temporal=self.temporal,
            bits=self.bits,
            show=self.show,
        )
        self.graph.output("frame.ldr", *self._sources().values())
        self.graph.compile()
        self._frame_ms = 0.0
        self._settled = False

    def _sources(self) -> dict[str, str]:
        """What is read back of a frame: layer -> resource."""
        found = {"ldr": "frame.ldr"}
        for layer in self.layers:
            if layer == "clouds" and not self.world.clouds.layers:
                continue
            found[layer] = _SOURCES.get(layer) or self.pipeline.light
        if {"normal", "albedo"} & set(self.layers):
            found["depth"] = "gbuffer.depth"
        return found

    def _advance(self, index: int, pending: PendingFrame) -> None:
        """Render frame `index` after the last one, or as a new beginning."""
        fresh = self._position is None or index != self._position + 1 or self.still
        self.models.latch(index, fresh)
        if fresh:
            # A new beginning: nothing of what was rendered before may shine through.
            self._kept, self._keeping, self._log = None, None, []
            self._settled = False
        self._log.append(index)
        keep = not self.still and len(self._log) % CHECKPOINT_EVERY == 0
        reads = self._execute(index, keep)
        pending.take(reads)
        self._position = index
        if keep:
            self._keep(index, reads)

    def _execute(self, index: int, keep: bool = False) -> dict[str, Pending]:
        """Bring the GPU to the end of frame `index`; returns what is read back of it."""
        if not self._settled:
            self.pipeline.begin(self.state(index))
            for before in [index] * 2 if self.still else range(index - WARM_UP, index):
                self._samples(before, 1, instant=True)
            self._settled = True
        names = {*self._sources().values(), "frame.exposure", *(self.graph.histories if keep else ())}
        return self._samples(index, self.samples, instant=self.still, read=names)

    def _samples(
        self, index: int, samples: int, *, instant: bool, read: Iterable[str] = ()
    ) -> dict[str, Pending]:
        reads: dict[str, Pending] = {}
        begin = time.perf_counter()
        self.graph.pass_times = self.pass_times
        for sample in range(samples):
            state = self.state(index, self.pipeline.jitter(index, sample, samples), sample)
            self._view.set(**view_values(state))
            self.pipeline.update(state, delta=1.0 / (self.fps * samples), instant=instant)
            reads = self.graph.execute(read if sample == samples - 1 else ())
        self._frame_ms = (time.perf_counter() - begin) * 1e3
        return reads

    def state(self, index: int, jitter: tuple[float, float] = (0.0, 0.0), sample: int = 0) -> FrameState:
        """What the systems are told of frame `index`."""
        seconds = index / self.fps
        camera = self._camera(seconds)
        previous = seconds if self.still else (index - 1) / self.fps
        before = self._camera(previous)
        return FrameState(
            index=index,
            time=seconds * self.world.time_scale,
            utc=self.world.time_at(seconds),
            delta=0.0 if self.still else self.world.time_scale / self.fps,
            seed=self.world.seed,
            size=self.size,
            planet_radius=self.world.planet.radius,
            camera=camera,
            previous_camera=before,
            jitter=jitter,
            sample=sample,
            seconds=seconds,
            previous_seconds=previous,
        )

    def _camera(self, seconds: float) -> CameraState:
        # A pose comes again, as the next frame's previous one or in every frame of a camera at rest.
        pose = self.world.camera.at(seconds)
        if pose not in self._cameras:
            if len(self._cameras) >= 4:
                self._cameras.clear()
            self._cameras[pose] = self._find_camera(pose)
        return self._cameras[pose]

    def _find_camera(self, pose: Pose) -> CameraState:
        radius = self.world.planet.radius
        height = pose.height
        if pose.above == "ground":
            height += float(self.world.terrain.height(pose.east, pose.north))
        heading, pitch, roll, fov = pose.angles
        return CameraState(
            position=position_on_planet(pose.east, pose.north, height, radius),
            rotation=camera_rotation(heading, pitch, roll, local_axes(pose.east, pose.north, radius)),
            fov=fov,
        )

    def _keep(self, index: int, reads: Mapping[str, Pending]) -> None:
        """Every few frames, the histories come to the CPU while the GPU goes on."""
        if self._keeping is not None:
            position, started = self._keeping
            self._kept = {"frame": np.int64(position), **{n: p.result() for n, p in started.items()}}
            self._log = [i for i in self._log if i > position]
        self._keeping = (index, {name: reads[name] for name in self.graph.histories})

    def _check_open(self) -> None:
        if self._closed:
            raise GpuError("this renderer is closed: make another one")

    def _recover(self, attempts: int = 3) -> None:
        """Build everything anew on a new device and replay the frames since the last checkpoint."""
        self._check_open()
        for attempt in range(attempts):
            try:
                self.device = Device.open(self._adapter)
                self._build()
                self._keeping = None
                if self._kept is not None:
                    self.graph.restore({k: v for k, v in self._kept.items() if k != "frame"})
                    self._settled = True
                wanted = {p.index: p for p in self._inflight}
                goal = max([*self._log, *wanted])
                start = self._log[0] if self._log else goal
                self._log = list(range(start, goal + 1)) if not self.still else [goal]
                for index in self._log:
                    reads = self._execute(index)
                    self._position = index
                    if index in wanted:
                        wanted[index].take(reads)
                return
            except DeviceLostError:
                if attempt == attempts - 1:
                    raise

    def _metadata(self, index: int) -> dict[str, Any]:
        from fallstreak import __version__

        state = self.state(index)
        return {
            "scene": self.world.name,
            "time": state.utc.isoformat(),
            "frame": index,
            "seed": self.world.seed,
            "version": __version__,
            "adapter": self.device.adapter.name,
            "size": list(self.size),
            "quality": self.quality.name,
            "samples": self.samples,
        }


class PendingFrame:
    """A frame the GPU is working on."""

    def __init__(self, renderer: Renderer, index: int):
        self.index = index
        self._renderer = renderer
        self._reads: dict[str, Pending] = {}
        self._frame: Frame | None = None

    def take(self, reads: Mapping[str, Pending]) -> None:
        """Remember what to wait for."""
        sources = {**self._renderer._sources(), "exposure": "frame.exposure"}
        self._reads = {layer: reads[name] for layer, name in sources.items()}

    def result(self) -> Frame:
        """Wait for the frame; a GPU lost meanwhile is rebuilt and the frame rendered again."""
        if self._frame is None:
            try:
                raw = {layer: pending.result() for layer, pending in self._reads.items()}
            except DeviceLostError:
                self._renderer._recover()
                raw = {layer: pending.result() for layer, pending in self._reads.items()}
            self._frame = self._decode(raw)
            self._renderer._inflight.remove(self)
            self._reads = {}
        return self._frame

    def _decode(self, raw: dict[str, np.ndarray]) -> Frame:
        renderer = self._renderer
        exposure = renderer.pipeline.read_exposure(raw["exposure"])
        wanted = renderer.layers
        fov = renderer.world.camera.at(self.index / renderer.fps).angles[3]
        values: dict[str, np.ndarray] = {}
        if renderer.bits == 8:
            values["ldr"] = np.ascontiguousarray(raw["ldr"][..., :3])
        else:
            values["ldr16"] = np.ascontiguousarray(raw["ldr"][..., :3])
        if "hdr" in wanted:
            values["hdr"] = renderer.pipeline.luminance(raw["hdr"], exposure)
        if "depth" in wanted:
            values["depth"] = decode.decode_distance(
                raw["depth"], renderer.state(self.index).camera.near, fov
            )
        if "normal" in wanted:
            values["normal"] = decode.decode_normal(raw["normal"], raw["depth"] > 0)
        if "albedo" in wanted:
            values["albedo"] = decode.decode_albedo(raw["albedo"])
        if "motion" in wanted:
            values["motion"] = decode.decode_motion(raw["motion"])
        if "clouds" in wanted:
            values["clouds"] = decode.decode_clouds(raw.get("clouds"), renderer.size)
        metadata = {**renderer._metadata(self.index), "ev100": round(exposure["ev100"], 4)}
        return Frame(metadata=metadata, stats={"frame_ms": renderer._frame_ms}, **values)


def render(
    world: World,
    size: tuple[int, int] = (1280, 720),
    quality: str | Quality = "high",
    *,
    samples: int | None = None,
    layers: tuple[str, ...] | list[str] = ("hdr", "depth", "normal"),
    bits: Literal[8, 16] = 8,
    adapter: str | None = None,
    show: Literal["materials"] | None = None,
) -> Frame:
    """Render one still.

    Parameters are those of `Renderer`. Returns a `Frame` with its times in `.stats`; of its layers, `.hdr`,
    `.depth` and `.normal` are there unless others are asked for.

    Examples
    --------
    >>> import fallstreak as fs
    >>> frame = fs.render(fs.load("jacksboro"), size=(640, 360))   # doctest: +SKIP
    >>> frame.ldr.shape                                            # doctest: +SKIP
    (360, 640, 3)
    """
    options: dict[str, Any] = {
        "samples": samples,
        "layers": layers,
        "bits": bits,
        "adapter": adapter,
        "show": show,
    }
    with Renderer(world, size, quality, still=True, **options) as renderer:
        renderer.pass_times = True
        pending = renderer.submit(0)
        stats = renderer.stats()
        frame = pending.result()
        return Frame(**{**frame.__dict__, "stats": stats})


def _quality(quality: str | Quality) -> Quality:
    if isinstance(quality, Quality):
        return quality
    if quality not in QUALITY:
        raise ValueError(f"quality {quality!r} is unknown; there are {', '.join(QUALITY)}")
    return QUALITY[quality]


def _checked_size(size: tuple[int, int]) -> tuple[int, int]:
    try:
        width, height = (whole_number(n) for n in size)
    except (TypeError, ValueError):
        raise ValueError(f"size = {size!r} must be two whole numbers, (width, height)") from None
    if not (16 <= width <= 8192 and 16 <= height <= 8192):
        raise ValueError(f"size {width}x{height} must be 16 to 8192 pixels each way")
    return width, height
