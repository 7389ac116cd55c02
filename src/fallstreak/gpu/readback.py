"""Bringing GPU memory back without making the GPU wait.

`start` records a copy into a staging buffer and asks for it to be mapped; the caller goes on with the next
frame and takes the `Pending` result when it wants it. Staging buffers are pooled.
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
        self, promise: Any, buffer: Any, finish: Callable[[memoryview], Any], release: Callable[[Any], None]
    ):
        self._promise, self._buffer, self._finish, self._release = promise, buffer, finish, release
        self._value: Any = None

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
            self._release(self._buffer)
            self._buffer = None
        return self._value


class Readback:
    """Copies textures and buffers to the CPU."""

    def __init__(self, device: Device):
        self._device = device
        self._pool: dict[int, list[Any]] = defaultdict(list)

    def _staging(self, size: int) -> Any:
        free = self._pool[size]
        return free.pop() if free else self._device.buffer("readback", size, _MAP_READ | _COPY_DST)

    def _start(
        self, record: Callable[[Any, Any], None], size: int, finish: Callable[[memoryview], Any]
    ) -> Pending:
        with translated("reading back"):
            staging = self._staging(size)
            encoder = self._device.native.create_command_encoder(label="readback")
            record(encoder, staging)
            self._device.queue.submit([encoder.finish()])
            promise = staging.map_async("READ", 0, size)
        return Pending(promise, staging, finish, lambda b: self._pool[size].append(b))

    def buffer(self, source: Any, size: int, dtype: Any = np.uint8) -> Pending:
        """Start reading `size` bytes of a buffer, as a 1-D array of `dtype`."""
        size = -(-size // 4) * 4

        def finish(data: memoryview) -> np.ndarray:
            return np.frombuffer(data, np.uint8).copy().view(dtype)

        return self._start(lambda e, b: e.copy_buffer_to_buffer(source, 0, b, 0, size), size, finish)

    def texture(self, source: Any, fmt: str, size: tuple[int, int, int], mip: int = 0) -> Pending:
        """Start reading a texture as ([depth,] height, width[, components])."""
        kind, count = texel(fmt)
        w, h, d = size
        row = w * kind.itemsize * count
        pitch = -(-row // 256) * 256
        total = pitch * h * d

        def record(encoder: Any, staging: Any) -> None:
            where: dict[str, Any] = {"texture": source, "mip_level": mip}
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

        return self._start(record, total, finish)
