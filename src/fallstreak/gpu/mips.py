"""Mip chains: each level the mean of the one above it, for 2-D, array, cube and 3-D textures.

A compute pass writes the rows of a level into a buffer, a copy brings them into the texture. So every format
of 8-bit, half and full floats can have mips, not only those that WebGPU renders into or stores to.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from typing import Any, ClassVar
from weakref import WeakKeyDictionary

from .device import Device
from .errors import GpuError, translated
from .formats import texel

Size = tuple[int, int, int]
_PART = 16 << 20  # bytes of a level that are made at a time
_STORAGE, _UNIFORM, _COPY_SRC = 0x0080, 0x0040, 0x0004


def levels(size: Size, dimension: str = "2d") -> int:
    """How many levels the whole chain of a texture has."""
    return math.floor(math.log2(max(size if dimension == "3d" else size[:2]))) + 1


def level_size(size: Size, level: int, dimension: str = "2d") -> Size:
    """Width, height and depth (or layers, which stay) of a level."""
    w, h, d = size
    return max(1, w >> level), max(1, h >> level), max(1, d >> level) if dimension == "3d" else d


def parts(size: Size, most: int) -> Iterator[tuple[int, int, int, int]]:
    """First row, first slice, rows and slices of parts with at most `most` rows in all."""
    _, h, d = size
    rows = max(1, min(most, h))
    slices = max(1, most // h)
    for z in range(0, d, slices):
        for y in range(0, h, rows):
            yield y, z, min(rows, h - y), min(slices, d - z)


class TexelLayout:
    """How a format's rows lie in a buffer that is copied into a texture; the Python half of ``texels.wesl``.

    Parameters
    ----------
    fmt : str
        A format of 8-bit unorm, 16-bit or 32-bit float components.

    Attributes
    ----------
    constants : dict
        What ``texels.wesl`` asks for.
    """

    def __init__(self, fmt: str):
        kind, components = texel(fmt)
        known = fmt.endswith("float") or fmt.endswith("unorm") or fmt.endswith("unorm-srgb")
        if not known or kind.name not in ("uint8", "float16", "float32") or fmt.startswith("depth"):
            raise GpuError(
                f"format {fmt!r} cannot be written by copies: use 8-bit unorm or 16- or 32-bit float"
            )
        self.constants = {"COMPONENTS": components, "BITS": 8 * kind.itemsize, "SRGB": fmt.endswith("srgb")}
        self._bytes = components * kind.itemsize

    def groups(self, width: int) -> int:
        """Groups of texels in a row, each written by one invocation."""
        return -(-width // max(1, 4 // self._bytes))

    def pitch(self, width: int) -> int:
        """Bytes from row to row."""
        return -(-width * self._bytes // 256) * 256

    def parts(self, size: Size) -> Iterator[tuple[int, int, int, int]]:
        """The parts in which to make something of this size, none too large for a buffer."""
        return parts(size, _PART // self.pitch(size[0]))

    def buffer_bytes(self, size: Size) -> int:
        """Bytes that the largest part needs."""
        return max(rows * slices for _, _, rows, slices in self.parts(size)) * self.pitch(size[0])

    def copy(
        self, encoder: Any, buffer: Any, texture: Any, mip: int, width: int, part: tuple[int, int, int, int]
    ) -> None:
        """Record the copy of a part into a texture; `part` counts layers as slices."""
        y, z, rows, slices = part
        encoder.copy_buffer_to_texture(
            {"buffer": buffer, "offset": 0, "bytes_per_row": self.pitch(width), "rows_per_image": rows},
            {"texture": texture, "mip_level": mip, "origin": (0, y, z)},
            (width, rows, slices),
        )


class MipMaker:
    """Makes mip chains on one device; pipelines are kept per format."""

    _makers: ClassVar[WeakKeyDictionary[Device, MipMaker]] = WeakKeyDictionary()

    def __init__(self, device: Device):
        # The maker is stored under its device, so it must not hold the device itself.
        self._native, self._queue, self._shaders = device.native, device.queue, device.shaders
        self._pipelines: dict[tuple[str, bool], Any] = {}

    @classmethod
    def of(cls, device: Device) -> MipMaker:
        """The device's maker."""
        if device not in cls._makers:
            cls._makers[device] = cls(device)
        return cls._makers[device]

    def make(self, texture: Any, fmt: str, size: Size, mips: int, dimension: str = "2d") -> None:
        """Fill levels 1 and up of a texture now; see `record`."""
        with translated("making mips"):
            encoder = self._native.create_command_encoder(label="mips")
            self.record(encoder, texture, fmt, size, mips, dimension)
            self._queue.submit([encoder.finish()])

    def record(
        self, encoder: Any, texture: Any, fmt: str, size: Size, mips: int, dimension: str = "2d"
    ) -> None:
        """Record the making of levels 1 and up.

        Parameters
        ----------
        texture : wgpu texture
            With usages TEXTURE_BINDING and COPY_DST.
        size : (width, height, depth or layers)
            Of level 0.
        mips : int
            Levels that the texture has.
        dimension : "2d", "2d-array" or "3d"
            Layers (a cube's faces too) are averaged each for itself.

        Raises
        ------
        GpuError
            For a format other than 8-bit unorm and 16- or 32-bit float.
        """
        if mips < 2:
            return
        volume = dimension == "3d"
        layout = TexelLayout(fmt)
        pipeline = self._pipeline(fmt, layout, volume)
        bindings = pipeline.get_bind_group_layout(0)
        half = level_size(size, 1, dimension)
        needed = layout.buffer_bytes(half if volume else (*half[:2], 1))
        words = self._native.create_buffer(label="mips", size=needed, usage=_STORAGE | _COPY_SRC)
        for layer, level in itertools.product(range(1 if volume else size[2]), range(1, mips)):
            view = texture.create_view(
                dimension="3d" if volume else "2d",
                base_mip_level=level - 1,
                mip_level_count=1,
                base_array_layer=layer,
                array_layer_count=1,
            )
            w, h, d = level_size(size, level, dimension)
            for y, z, rows, slices in layout.parts((w, h, d if volume else 1)):
                first = self._native.create_buffer_with_data(
                    data=b"".join(n.to_bytes(4, "little") for n in (y, z, rows, slices)),
                    usage=_UNIFORM | _STORAGE,
                )
                resources = [view, {"buffer": words}, {"buffer": first}]
                work = encoder.begin_compute_pass()
                work.set_pipeline(pipeline)
                work.set_bind_group(0, bind(self._native, bindings, resources))
                work.dispatch_workgroups(-(-layout.groups(w) // 16), -(-rows // 4), slices)
                work.end()
                layout.copy(encoder, words, texture, level, w, (y, z + layer, rows, slices))

    def _pipeline(self, fmt: str, layout: TexelLayout, volume: bool) -> Any:
        if (fmt, volume) not in self._pipelines:
            shader, _ = self._shaders.get(
                "package::gpu::mips", ["main"], flags={"VOLUME": volume}, constants=layout.constants
            )
            self._pipelines[fmt, volume] = self._native.create_compute_pipeline(
                label=f"mips {fmt}", layout="auto", compute={"module": shader, "entry_point": "main"}
            )
        return self._pipelines[fmt, volume]


def bind(native: Any, layout: Any, resources: list[Any]) -> Any:
    """A bind group of `resources` at bindings 0, 1, 2 …"""
    entries = [{"binding": i, "resource": resource} for i, resource in enumerate(resources)]
    return native.create_bind_group(layout=layout, entries=entries)
