"""Bringing GPU memory back without making the GPU wait.

A `Pending` copy is recorded into the encoder of the frame itself: a submission of its own would, on a
software adapter, wait for the frame before it returns. The caller goes on with the next frame and takes the
result when it wants it. Staging buffers are pooled.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable
from typing import Any

import numpy as np

from .device import Device
from .errors import translated
from .formats import is_depth, texel

_MAP_READ = 0x0001
_COPY_DST = 0x0008


class Pending:
    """A read-back under way."""

    def __init__(
        self,
        pool: Readback,
        record: Callable[[Any, Any], None],
        size: int,
        finish: Callable[[memoryview], Any],
    ):
        self._pool, self._record, self._size, self._finish = pool, record, size, finish
        self._buffer: Any = pool.take(size)
        self._promise: Any = None
        self._value: Any = None

    def record(self, encoder: Any) -> None:
        """Record the copy into an encoder; `begin` comes after its submission."""
        self._record(encoder, self._buffer)

    def begin(self) -> None:
        """Ask for the copy to be mapped once the GPU has made it."""
        # Plain "READ" would submit an empty command buffer first, which on lavapipe waits for the frame.
        self._promise = self._buffer.map_async("READ_NOSYNC", 0, self._size)

    def result(self) -> Any:
        """Wait until the data is there and return it; may be called again.

        Raises
        ------
        DeviceLostError
            When the GPU went away meanwhile.
        """
        if self._buffer is not None:
            with translated("reading back"):
                self._promise.sync_wait()
                self._value = self._finish(self._buffer.read_mapped(copy=False))
                self._buffer.unmap()
            self._pool.give(self._size, self._buffer)
            self._buffer = None
        return self._value


class Stacked(Pending):
    """Read-backs of the bands of one texture, under way together: what no single buffer may hold."""

    def __init__(self, parts: list[Pending]):
        self._parts = parts

    def record(self, encoder: Any) -> None:
        """As `Pending.record`."""
        for part in self._parts:
            part.record(encoder)

    def begin(self) -> None:
        """As `Pending.begin`."""
        for part in self._parts:
            part.begin()

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

    def now(self, pending: Pending) -> Pending:
        """Submit a copy on its own."""
        with translated("reading back"):
            encoder = self._device.native.create_command_encoder(label="readback")
            pending.record(encoder)
            self._device.queue.submit([encoder.finish()])
            pending.begin()
        return pending

    def buffer(self, source: Any, size: int, dtype: Any = np.uint8) -> Pending:
        """A copy of `size` bytes of a buffer, as a 1-D array of `dtype`; not begun yet."""
        size = -(-size // 4) * 4

        def finish(data: memoryview) -> np.ndarray:
            return np.frombuffer(data, np.uint8).copy().view(dtype)

        return Pending(self, lambda e, b: e.copy_buffer_to_buffer(source, 0, b, 0, size), size, finish)

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

        def record(encoder: Any, staging: Any) -> None:
            where: dict[str, Any] = {"texture": source, "mip_level": mip, "origin": (0, top, 0)}
            if is_depth(fmt):
                where["aspect"] = "depth-only"
            layout = {"buffer": staging, "offset": 0, "bytes_per_row": pitch, "rows_per_image": h}
            encoder.copy_texture_to_buffer(where, layout, size)

        def finish(data: memoryview) -> np.ndarray:
            rows = np.frombuffer(data, np.uint8, total).reshape(d, h, pitch)[:, :, :row]
            # always a copy: with whole 256-byte rows a view would outlive the mapping
            values = np.array(rows, order="C").view(kind).reshape(d, h, w, count)
            if count == 1:
                values = values[..., 0]
            return values[0] if d == 1 else values

        return Pending(self, record, total, finish)
