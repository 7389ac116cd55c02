"""The work behind `bake`: pipelines, parts, and the recording of their dispatches."""

from __future__ import annotations

import math
import time
from typing import Any, ClassVar
from weakref import WeakKeyDictionary

import numpy as np

from ..gpu import Device, Struct
from ..gpu.errors import translated
from ..gpu.mips import MipMaker, TexelLayout, bind, parts
from ..gpu.readback import Readback
from .bake import BLENDS, BakeSpec, Layer

FRACTALS = ("fbm", "ridged", "billow", "turbulence", "hybrid")  # as numbered in fractal.wesl
_PART = 1 << 20  # texels or points made by one dispatch
_ALL = 1e6  # a detail that keeps all octaves
_COPY_SRC, _COPY_DST, _UNIFORM, _STORAGE = 0x0004, 0x0008, 0x0040, 0x0080

LAYER = Struct(
    "Layer",
    [
        ("part", "vec4u", "first row, first slice, rows, slices"),
        ("axes", "vec4u", "where the coordinates along each axis begin"),
        ("period", "vec4i", "cells, when it repeats"),
        ("width", "u32", "texels in a row"),
        ("slot", "u32", "where the channel begins among the values"),
        ("stride", "u32", "values from a channel to the next"),
        ("octaves", "u32", "how many"),
        ("first", "u32", "number of the first octave"),
        ("seed", "u32", "of the layer"),
        ("lacunarity", "vec2f", "ratio of the octaves' frequencies, and what its float leaves out"),
        ("gain", "f32", "ratio of their strengths"),
        ("detail", "f32", "logarithm to 2 of the samples to a wavelength of the first octave"),
        ("norm", "f32", "1 over the sum of the strengths"),
        ("scale", "f32", "what the noise is multiplied by"),
        ("offset", "f32", "what is added then"),
        ("warp", "f32", "cells that points are moved by"),
        ("radius", "f32", "of a cube's sphere, cells"),
    ],
)
ROWS = Struct(
    "Rows",
    [
        ("width", "u32", "texels in a row"),
        ("stride", "u32", "values from a channel to the next"),
        ("channels", "u32", "how many"),
    ],
)


class Baker:
    """Bakes noise on one device; pipelines are kept."""

    _bakers: ClassVar[WeakKeyDictionary[Device, Baker]] = WeakKeyDictionary()

    def __init__(self, device: Device):
        # Stored under its device, so it must not hold the device itself.
        self._native, self._queue, self._shaders = device.native, device.queue, device.shaders
        self._readback = Readback(device)
        self._mips = MipMaker.of(device)
        self._pipelines: dict[tuple[Any, ...], Any] = {}

    @classmethod
    def of(cls, device: Device) -> Baker:
        """The device's baker."""
        if device not in cls._bakers:
            cls._bakers[device] = cls(device)
        return cls._bakers[device]

    # ---- textures --------------------------------------------------------------------------------------

    def bake(self, texture: Any, spec: BakeSpec) -> None:
        """Fill a texture, waiting for each part."""
        work = _Work(self, spec)
        with translated("baking noise"):
            for part in work.parts:
                self._run(lambda encoder, part=part: work.record(encoder, texture, part), wait=work.values)
            self._run(lambda encoder: self._record_mips(encoder, texture, spec))

    def record(self, encoder: Any, texture: Any, spec: BakeSpec) -> None:
        """Record the filling of a texture."""
        work = _Work(self, spec)
        for part in work.parts:
            work.record(encoder, texture, part)
        self._record_mips(encoder, texture, spec)

    def _record_mips(self, encoder: Any, texture: Any, spec: BakeSpec) -> None:
        self._mips.record(encoder, texture, spec.format, spec.texture_size, spec.levels, spec.dimension)

    def _run(self, record: Any, wait: Any = None) -> None:
        encoder = self._native.create_command_encoder(label="noise")
        record(encoder)
        self._queue.submit([encoder.finish()])
        if wait is not None:
            self._readback.now(self._readback.buffer(wait, 4)).result()

    # ---- points ----------------------------------------------------------------------------------------

    def sample(
        self,
        cells: np.ndarray,
        layer: Layer,
        period: tuple[int, ...] | None = None,
        detail: float | None = None,
        *,
        what: str = "points",
        components: int = 1,
    ) -> np.ndarray:
        """Values at points that are given in cells of the first octave, (components, count).

        `what` is "points", "slopes" or "flow".
        """
        known = np.all(np.isfinite(cells), axis=-1)
        cells = np.where(np.expand_dims(known, -1), cells, 0.0)  # shaders need not know what is no number
        found = [np.empty((components, 0), np.float32)]
        with translated("sampling noise"):
            for start in range(0, len(cells), _PART):
                some = cells[start : start + _PART]
                run, values = self._prepare(some, layer, period, detail, what, components)
                self._run(run)
                size = 4 * components * len(some)
                read = self._readback.now(self._readback.buffer(values, size, np.float32))
                found.append(read.result().reshape(components, -1))
        return np.where(known, np.concatenate(found, 1), np.float32(np.nan))

    def time(self, points: np.ndarray, layer: Layer, rounds: int, what: str, components: int) -> list[float]:
        """Seconds for `sample`, without the transfer of points and values."""
        with translated("sampling noise"):
            run, values = self._prepare(points, layer, None, None, what, components)
            self._run(run, wait=values)
            seconds = []
            for _ in range(rounds):
                begin = time.perf_counter()
                self._run(run, wait=values)
                seconds.append(time.perf_counter() - begin)
        return seconds

    def _prepare(
        self, cells: np.ndarray, layer: Layer, period: Any, detail: float | None, what: str, components: int
    ) -> Any:
        count, dimensions = cells.shape
        coordinates = self.coordinates([cells[:, d] for d in range(dimensions)])
        values = self.buffer(4 * count * components)
        pipeline = self.pipeline(f"{'tiled_' if period else ''}{what}{dimensions}", layer)
        groups = (min(1024, -(-count // 64)), -(-count // 65536), 1)
        uniform = self.uniform(
            LAYER,
            **described(layer),
            part=(0, 0, 1, 1),
            axes=[count * min(d, dimensions - 1) for d in range(4)],
            period=_four(period),
            width=count,
            slot=0,
            stride=count,
            radius=0.0,
            detail=_ALL if detail is None else detail,
        )
        group = self.group(pipeline, [values, uniform, *coordinates])

        def run(encoder: Any) -> None:
            self.dispatch(encoder, pipeline, group, groups)

        return run, values

    # ---- pieces ----------------------------------------------------------------------------------------

    def pipeline(self, entry: str, layer: Layer) -> Any:
        """The pipeline of a layer."""
        constants = {
            "NOISE": f"package::noise::{'perlin' if layer.kind == 'curl' else layer.kind}",
            "SHAPE": FRACTALS.index(layer.fractal),
            "BLEND": BLENDS.index(layer.blend),
            "CLAMPED": layer.range is not None,
            "WARPED": layer.warp != 0.0,
        }
        return self._pipeline("package::noise::bake", entry, constants, LAYER)

    def packing(self, layout: TexelLayout) -> Any:
        """The pipeline that makes texels of values."""
        return self._pipeline("package::noise::pack", "main", layout.constants, ROWS)

    def _pipeline(self, module: str, entry: str, constants: dict[str, Any], struct: Struct) -> Any:
        key = (module, entry, *constants.values())
        if key not in self._pipelines:
            shader, _ = self._shaders.get(module, [entry], constants=constants, structs=[struct])
            self._pipelines[key] = self._native.create_compute_pipeline(
                label=entry, layout="auto", compute={"module": shader, "entry_point": entry}
            )
        return self._pipelines[key]

    def buffer(self, size: int) -> Any:
        """A storage buffer."""
        return self._native.create_buffer(label="noise", size=size, usage=_STORAGE | _COPY_SRC | _COPY_DST)

    def uniform(self, struct: Struct, **values: Any) -> Any:
        """A uniform buffer with these values."""
        return self._native.create_buffer_with_data(data=struct.pack(**values), usage=_UNIFORM | _STORAGE)

    def coordinates(self, axes: list[np.ndarray]) -> tuple[Any, Any]:
        """Buffers of the cells and fractions of coordinates, axis after axis."""
        along = np.concatenate(axes)
        whole = np.floor(along)
        cells = whole.astype(np.int64).astype(np.uint32)
        fractions = (along - whole).astype(np.float32)
        return tuple(
            self._native.create_buffer_with_data(data=data, usage=_STORAGE) for data in (cells, fractions)
        )  # type: ignore[return-value]

    def group(self, pipeline: Any, buffers: list[Any]) -> Any:
        """A bind group of buffers at bindings 0, 1, 2 …"""
        layout = pipeline.get_bind_group_layout(0)
        return bind(self._native, layout, [{"buffer": buffer} for buffer in buffers])

    @staticmethod
    def dispatch(encoder: Any, pipeline: Any, group: Any, groups: tuple[int, int, int]) -> None:
        """Record a dispatch in a pass of its own."""
        work = encoder.begin_compute_pass()
        work.set_pipeline(pipeline)
        work.set_bind_group(0, group)
        work.dispatch_workgroups(*groups)
        work.end()


class _Work:
    """A texture in the making: its buffers, and the recording of its parts."""

    def __init__(self, baker: Baker, spec: BakeSpec):
        self._baker, self._spec = baker, spec
        self._size = spec.texture_size
        w = self._size[0]
        self._layout = TexelLayout(spec.format)
        # rows of a part: what a buffer holds and a dispatch may count
        rows = min(max(1, _PART // w), 32768)
        self.parts = list(parts(self._size, rows))
        most = max(part[2] * part[3] for part in self.parts)
        self._stride = most * w
        self.values = baker.buffer(4 * self._stride * spec.components)
        self._words = baker.buffer(self._layout.pitch(w) * most)
        self._coordinates: dict[Any, tuple[Any, Any]] = {}

    def record(self, encoder: Any, texture: Any, part: tuple[int, int, int, int]) -> None:
        """Record the making of one part."""
        w = self._size[0]
        channel = 0
        for stack in self._spec.stacks:
            for layer in stack:
                self._record_layer(encoder, layer, channel, part)
            channel += self._spec.width(stack)
        pipeline = self._baker.packing(self._layout)
        uniform = self._baker.uniform(ROWS, width=w, stride=self._stride, channels=self._spec.components)
        group = self._baker.group(pipeline, [self.values, uniform, self._words])
        rows = part[2] * part[3]
        self._baker.dispatch(encoder, pipeline, group, (-(-self._layout.groups(w) // 64), rows, 1))
        self._layout.copy(encoder, self._words, texture, 0, w, part)

    def _record_layer(
        self, encoder: Any, layer: Layer, channel: int, part: tuple[int, int, int, int]
    ) -> None:
        spec = self._spec
        frequencies = spec.frequencies(layer)
        key = frequencies
        if key not in self._coordinates:
            axes = [(np.arange(n) + 0.5) / n * f for n, f in zip(spec.shape, frequencies, strict=True)]
            self._coordinates[key] = self._baker.coordinates(axes)
        lengths = [0, *np.cumsum(spec.shape), 0, 0][:4]
        texels_to_cell = spec.shape[0] / frequencies[0]
        if spec.cube:  # a quarter of the way around the sphere is a face
            texels_to_cell = spec.shape[0] / (0.5 * math.pi * frequencies[0])
        uniform = self._baker.uniform(
            LAYER,
            **described(layer),
            part=part,
            axes=lengths,
            period=_four(spec.period(layer)),
            width=self._size[0],
            slot=channel * self._stride,
            stride=self._stride,
            radius=frequencies[0],
            detail=math.log2(texels_to_cell) if layer.spacing else _ALL,
        )
        entry = "cube" if spec.cube else "volume" if len(spec.shape) == 3 else "plane"
        entry = f"flow_{entry}" if layer.kind == "curl" else entry
        pipeline = self._baker.pipeline(f"tiled_{entry}" if spec.tiling else entry, layer)
        buffers = [self.values, uniform]
        if not spec.cube:
            buffers += self._coordinates[key]
        group = self._baker.group(pipeline, buffers)
        self._baker.dispatch(encoder, pipeline, group, (-(-self._size[0] // 16), -(-part[2] // 4), part[3]))


def described(layer: Layer) -> dict[str, Any]:
    """The fields of the uniform that follow from the layer alone."""
    low, high = layer.range or (0.0, 1.0)
    return {
        "octaves": layer.octaves,
        "first": 0,
        "seed": layer.seed,
        "lacunarity": (layer.lacunarity, layer.lacunarity - float(np.float32(layer.lacunarity))),
        "gain": layer.gain,
        "norm": 1.0 / sum(layer.gain**i for i in range(layer.octaves)),
        "scale": 1.0 / (high - low),
        "offset": -low / (high - low),
        "warp": layer.warp,
    }


def _four(period: tuple[int, ...] | None) -> tuple[int, ...]:
    return (*(period or ()), 1, 1, 1, 1)[:4]
