"""Encoding and writing while the GPU renders the next frame."""

from __future__ import annotations

import os
import threading
from collections import deque
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Self


class BackgroundWriter:
    """A few threads that write files; `put` blocks when too many wait, so that memory stays bounded.

    The first failure is raised by the next `put`, or by leaving the `with` block.

    Parameters
    ----------
    threads : int, optional
        zlib and the disk release the interpreter lock, so threads do run side by side. By default up to four,
        and one less than there are cores.
    """

    def __init__(self, threads: int | None = None):
        threads = threads or max(1, min(4, (os.cpu_count() or 2) - 1))
        self._pool = ThreadPoolExecutor(threads, thread_name_prefix="fallstreak-writer")
        self._slots = threading.BoundedSemaphore(threads + 1)
        self._running: deque[Future] = deque()

    def put(self, task: Callable[[], object]) -> None:
        """Run `task` on another thread, soon."""
        self._reap()
        self._slots.acquire()
        try:
            future = self._pool.submit(task)
        except BaseException:
            self._slots.release()
            raise
        future.add_done_callback(lambda _: self._slots.release())
        self._running.append(future)

    def drain(self) -> None:
        """Wait until everything is written; raises what went wrong."""
        while self._running:
            self._running.popleft().result()

    def _reap(self) -> None:
        while self._running and self._running[0].done():
            self._running.popleft().result()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: object, *_: object) -> None:
        try:
            if kind is None:
                self.drain()
        finally:
            self._pool.shutdown(wait=True, cancel_futures=True)
