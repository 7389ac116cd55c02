"""Bringing GPU memory back without making the GPU wait.

A `Pending` copy is recorded into the encoder of the frame itself: a submission of its own would, on a
software adapter, wait for the frame before it returns. The caller goes on with the next frame and takes the
result when it wants it. Staging buffers are pooled.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from .device import Device
from .errors import translated
from .formats import is_depth, texel

_MAP_READ = 0x0001
_COPY_DST = 0x0008


class Staging:
    """A mappable buffer that several copies share: one mapping costs as much as ten."""

    def __init__(self, pool: Readback, size: int):
        self._pool, self._size = pool, size
        self.buffer: Any = pool.take(size)
        self._promise: Any = None
        self._waiting = 0

    def join(self) -> None:
        """One more copy will be taken from here."""
        self._waiting += 1

    def begin(self) -> None:
        """Ask for the buffer to be mapped once the GPU has filled it."""
        if self._promise is None:
            # Plain "READ" would submit an empty command buffer first, which on lavapipe waits for the frame.
            self._promise = self.buffer.map_async("READ_NOSYNC", 0, self._size)

    def take(self, offset: int, size: int, finish: Callable[[memoryview], Any]) -> Any:
        """Wait, and hand a part to `finish`, which copies it; the last one gives the buffer back."""
        with translated("reading back"):
            self._promise.sync_wait()
            value = finish(self.buffer.read_mapped(offset, size, copy=False))
            self._waiting -= 1
            if self._waiting == 0:
                self.buffer.unmap()
                self._pool.give(self._size, self.buffer)
        return value


class Pending:
    """A read-back under way."""

    def __init__(
        self, record: Callable[[Any, Any, int], None], size: int, finish: Callable[[memoryview], Any]
    ):
        self._record, self.size, self._finish = record, size, finish
        self._staging: Staging | None = None
        self._offset = 0
        self._value: Any = None

    @property
    def parts(self) -> list[Pending]:
        """The single copies that this is made of."""
        return [self]

    def record(self, encoder: Any, staging: Staging, offset: int) -> None:
        """Record the copy into an encoder, to a place in a staging buffer."""
        self._staging, self._offset = staging, offset
        staging.join()
        self._record(encoder, staging.buffer, offset)

    def begin(self) -> None:
        """To be called after the submission."""
        assert self._staging is not None
        self._staging.begin()

    def result(self) -> Any:
        """Wait until the data is there and return it; may be called again.

        Raises
        ------
        DeviceLostError
            When the GPU went away meanwhile.
        """
        if self._staging is not None:
            self._value = self._staging.take(self._offset, self.size, self._finish)
            self._staging = None
        return self._value


class Stacked(Pending):
    """Read-backs of the bands of one texture, under way together: what no single buffer may hold."""

    def __init__(self, parts: list[Pending]):
        self._parts = parts

    @property
    def parts(self) -> list[Pending]:
        """The bands."""
        return self._parts

    def result(self) -> np.ndarray:
        """As `Pending.result`, the bands one under the other."""
        return np.concatenate([part.result() for part in self._parts])


class Readback:
    """Copies textures and buffers to the CPU."""

    def __init__(self, device: Device):
        self._device = device
        self._free: dict[int, list[Any]] = defaultdict(list)

    def take(self, size: int) -> Any:
        """A staging buffer."""
        free = self._free[size]
        return free.pop() if free else self._device.buffer("readback", size, _MAP_READ | _COPY_DST)

    def give(self, size: int, buffer: Any) -> None:
        """Take a staging buffer back."""
        self._free[size].append(buffer)

    def record(self, encoder: Any, copies: Iterable[Pending]) -> list[Pending]:
        """Record copies into an encoder, as many to a staging buffer as fit; returns what to `begin`."""
        parts = [part for copy in copies for part in copy.parts]
        limit = self._device.limits["max-buffer-size"]
        start = 0
        while start < len(parts):
            end, offsets = 0, []
            for part in parts[start:]:
                offset = -(-end // 256) * 256
                if offsets and offset + part.size > limit:
                    break
                offsets.append(offset)
                end = offset + part.size
            staging = Staging(self, end)
            for part, offset in zip(parts[start:], offsets, strict=False):
                part.record(encoder, staging, offset)
            start += len(offsets)
        return parts

    def now(self, pending: Pending) -> Pending:
        """Submit a copy on its own."""
        with translated("reading back"):
            encoder = self._device.native.create_command_encoder(label="readback")
            parts = self.record(encoder, [pending])
            self._device.queue.submit([encoder.finish()])
            for part in parts:
                part.begin()
        return pending

    def buffer(self, source: Any, size: int, dtype: Any = np.uint8) -> Pending:
        """A copy of `size` bytes of a buffer, as a 1-D array of `dtype`; not begun yet."""
        size = -(-size // 4) * 4

        def finish(data: memoryview) -> np.ndarray:
            return np.frombuffer(data, np.uint8).copy().view(dtype)

        return Pending(lambda e, b, o: e.copy_buffer_to_buffer(source, 0, b, o, size), size, finish)

    def texture(self, source: Any, fmt: str, size: tuple[int, int, int], mip: int = 0) -> Pending:
        """A copy of a texture as ([depth,] height, width[, components]); not begun yet."""
        kind, count = texel(fmt)
        w, h, d = size
        pitch = -(-w * kind.itemsize * count // 256) * 256
        band = self._device.limits["max-buffer-size"] // pitch
        # The copy of a depth buffer must be whole; at WebGPU's largest size it just fits.
        if band >= h * d or d > 1 or is_depth(fmt):
            return self._rows(source, fmt, size, mip, 0)
        tops = range(0, h, band)
        return Stacked([self._rows(source, fmt, (w, min(band, h - top), 1), mip, top) for top in tops])

    def _rows(self, source: Any, fmt: str, size: tuple[int, int, int], mip: int, top: int) -> Pending:
        """A copy of `size` texels from row `top` on."""
        kind, count = texel(fmt)
        w, h, d = size
        row = w * kind.itemsize * count
        pitch = -(-row // 256) * 256
        total = pitch * h * d

        def record(encoder: Any, staging: Any, offset: int) -> None:
            where: dict[str, Any] = {"texture": source, "mip_level": mip, "origin": (0, top, 0)}
            if is_depth(fmt):
                where["aspect"] = "depth-only"
            layout = {"buffer": staging, "offset": offset, "bytes_per_row": pitch, "rows_per_image": h}
            encoder.copy_texture_to_buffer(where, layout, size)

        def finish(data: memoryview) -> np.ndarray:
            rows = np.frombuffer(data, np.uint8, total).reshape(d, h, pitch)[:, :, :row]
            # always a copy: with whole 256-byte rows a view would outlive the mapping
            values = np.array(rows, order="C").view(kind).reshape(d, h, w, count)
            if count == 1:
                values = values[..., 0]
            return values[0] if d == 1 else values

        return Pending(record, total, finish)
