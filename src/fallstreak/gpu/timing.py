"""Per-pass times: GPU by timestamp queries where the adapter has them, CPU by the clock."""

from __future__ import annotations

from typing import Any

import numpy as np

from .device import Device
from .readback import Readback

_QUERY_RESOLVE, _COPY_SRC = 0x0200, 0x0004


class Timing:
    """Two timestamps around each pass of a frame.

    Without the capability `timestamp-query`, `writes` gives None and GPU times are absent.
    """

    def __init__(self, device: Device, count: int):
        self._count = count
        self.available = "timestamp-query" in device.capabilities and count > 0
        if self.available:
            self._queries = device.native.create_query_set(type="timestamp", count=2 * count)
            self._buffer = device.buffer("timing", 16 * count, _QUERY_RESOLVE | _COPY_SRC)
            self._readback = Readback(device)

    def writes(self, position: int) -> dict[str, Any] | None:
        """What a pass descriptor needs to be timed."""
        if not self.available:
            return None
        return {
            "query_set": self._queries,
            "beginning_of_pass_write_index": 2 * position,
            "end_of_pass_write_index": 2 * position + 1,
        }

    def resolve(self, encoder: Any) -> None:
        """Record, at the frame's end, the copy of the timestamps into memory."""
        if self.available:
            encoder.resolve_query_set(self._queries, 0, 2 * self._count, self._buffer, 0)

    def milliseconds(self) -> np.ndarray | None:
        """GPU time of each pass of the last frame, in ms; waits for the GPU."""
        if not self.available:
            return None
        copy = self._readback.now(self._readback.buffer(self._buffer, 16 * self._count, np.uint64))
        stamps = copy.result().reshape(-1, 2)
        # WebGPU timestamps are nanoseconds; a pass that did not run keeps old stamps, the graph masks those.
        return (stamps[:, 1].astype(np.int64) - stamps[:, 0].astype(np.int64)) / 1e6
