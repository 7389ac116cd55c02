"""Rasters read by windows: only the rows and columns asked for, at the resolution asked for.

A file of 10,800² samples is 233 MB of 16-bit numbers and would be 930 MB of float64. What is wanted of it is
a few windows of some hundred samples, each a power of two coarser than the file. A `Raster` therefore hands
out *pieces* (strips of rows, tiles), and `Raster.read` takes the means of blocks piece by piece, in threads,
so that a handful of pieces is in memory at a time, however large the file.
"""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import numpy as np

LOWEST, HIGHEST = -12e3, 30e3  # m: what is outside is no height but a code for "unknown"
MOST_SAMPLES = 2**32  # 65,536²: a bound on how long a hostile header can keep us reading
STRIP = 4 << 20  # bytes of a piece of a file without pieces of its own
THREADS = min(os.cpu_count() or 1, 8)

Span = tuple[int, int]
"""First index and the one after the last."""


@dataclass(frozen=True)
class Piece:
    """Part of a raster: where its first sample lies, whose it is, and how to get it (in any thread)."""

    row: int
    column: int
    load: Callable[[], np.ndarray]
    name: str


@dataclass(frozen=True)
class Window:
    """What was read.

    Attributes
    ----------
    heights : (rows, columns) float32, m; NaN where nothing is known
    unknown : for each file's name, how many of its samples in the window hold no height
    """

    heights: np.ndarray
    unknown: dict[str, int]


class Raster:
    """Heights on a grid; a subclass sets the attributes and gives `pieces`.

    Attributes
    ----------
    shape : (rows, columns)
    name : of the file, for messages
    nodata : stored value that means "unknown", or None
    scale, offset : metres = scale · stored + offset
    """

    shape: tuple[int, int]
    name: str
    nodata: float | None = None
    scale: float = 1.0
    offset: float = 0.0

    def pieces(self, rows: Span, columns: Span) -> Iterator[Piece]:
        """Pieces that together cover the window; they may reach beyond it."""
        raise NotImplementedError

    def read(self, rows: Span, columns: Span, reduction: int = 0) -> Window:
        """Means of blocks of 2^reduction samples square.

        Parameters
        ----------
        rows, columns : Span
            In blocks: block i holds samples i·2^reduction to (i + 1)·2^reduction − 1.
        """
        block = 1 << reduction
        shape = (rows[1] - rows[0], columns[1] - columns[0])
        total, count = np.zeros(shape), np.zeros(shape, np.int64)
        unknown: dict[str, int] = {}
        first = (rows[0] * block, columns[0] * block)
        last = (rows[1] * block, columns[1] * block)

        def work(piece: Piece) -> tuple[str, int, list[tuple]]:
            top, left = max(first[0] - piece.row, 0), max(first[1] - piece.column, 0)
            bottom, right = last[0] - piece.row, last[1] - piece.column
            values = piece.load()[top:bottom, left:right]
            known = self._known(values)
            parts = list(_sums(values, known, piece.row + top, piece.column + left, block))
            return piece.name, 0 if known is None else int(known.size - known.sum()), parts

        for name, missing, parts in _in_threads(work, self.pieces((first[0], last[0]), (first[1], last[1]))):
            unknown[name] = unknown.get(name, 0) + missing
            for row, column, part, known in parts:
                at = (
                    slice(row - rows[0], row - rows[0] + part.shape[0]),
                    slice(column - columns[0], column - columns[0] + part.shape[1]),
                )
                total[at] += part
                count[at] += known
        heights = np.full(shape, np.nan, np.float32)
        np.divide(total, count, out=total, where=count > 0)
        np.copyto(heights, self.scale * total + self.offset, where=count > 0, casting="same_kind")
        return Window(heights, {name: n for name, n in unknown.items() if n})

    def _known(self, values: np.ndarray) -> np.ndarray | None:
        """Which stored values are heights; None where all are, which is the common and quick case."""
        if not values.size:
            return None
        low, high = sorted(((LOWEST - self.offset) / self.scale, (HIGHEST - self.offset) / self.scale))
        least, most = values.min(), values.max()
        # A NaN makes both comparisons false.
        inside = bool(least >= low) and bool(most <= high)
        if inside and (self.nodata is None or not least <= self.nodata <= most):
            return None
        with np.errstate(invalid="ignore"):
            known = (values >= low) & (values <= high)
        if self.nodata is not None:
            known &= values != np.asarray(self.nodata).astype(
                np.float32 if values.dtype.kind == "f" else float
            )
        return None if known.all() else known


class ArrayRaster(Raster):
    """A raster that is in memory."""

    def __init__(self, values: np.ndarray, name: str, nodata: float | None = None):
        self.values, self.name, self.nodata = values, name, nodata
        self.shape = (values.shape[0], values.shape[1])

    def pieces(self, rows: Span, columns: Span) -> Iterator[Piece]:
        for start, stop in strips(rows, self.shape[1] * self.values.itemsize):
            part = self.values[start:stop, slice(*columns)]
            yield Piece(start, columns[0], lambda part=part: part, self.name)


class RawRaster(Raster):
    """Rows of numbers that lie in a file as they are, one after the other."""

    def __init__(
        self,
        path: Path,
        start: int,
        shape: tuple[int, int],
        dtype: np.dtype,
        name: str,
        nodata: float | None = None,
    ):
        self.path, self.start, self.shape, self.dtype = path, start, shape, np.dtype(dtype)
        self.name, self.nodata = name, nodata

    def pieces(self, rows: Span, columns: Span) -> Iterator[Piece]:
        for start, stop in strips(rows, self.shape[1] * self.dtype.itemsize):
            yield Piece(start, columns[0], lambda a=start, b=stop: self._load(a, b, columns), self.name)

    def _load(self, start: int, stop: int, columns: Span) -> np.ndarray:
        # Read, not mapped: mapped pages of a file count as memory of the process until they are let go.
        width = self.shape[1]
        offset = self.start + start * width * self.dtype.itemsize
        values = np.fromfile(self.path, self.dtype, (stop - start) * width, offset=offset)
        part = values.reshape(stop - start, width)[:, slice(*columns)]
        return part if self.dtype.isnative else part.astype(self.dtype.newbyteorder("="))


def strips(rows: Span, row_bytes: int) -> Iterator[Span]:
    """Rows cut into strips of about `STRIP` bytes."""
    height = max(STRIP // max(row_bytes, 1), 16)
    for start in range(rows[0], rows[1], height):
        yield start, min(start + height, rows[1])


def _sums(values: np.ndarray, known: np.ndarray | None, row: int, column: int, block: int) -> Iterator[tuple]:
    """Sums and counts over blocks: (first block's row, its column, sums, counts) for each aligned part."""
    if known is not None:
        values = np.where(known, values, values.dtype.type(0))
    small = values.dtype.kind in "iu" and values.dtype.itemsize <= 2 and block <= 128
    exact = np.int32 if small else np.float64
    for r0, r1, high in _aligned(row, values.shape[0], block):
        for c0, c1, wide in _aligned(column, values.shape[1], block):
            part = _block_sums(values[r0:r1, c0:c1], high, wide, exact)
            if known is None:
                count = high * wide
            else:
                count = _block_sums(known[r0:r1, c0:c1], high, wide, np.int32)
            yield (row + r0) // block, (column + c0) // block, part, count


def _aligned(start: int, length: int, block: int) -> Iterator[tuple[int, int, int]]:
    """A run of samples as the end of one block, whole blocks, and the beginning of another."""
    head = min(-start % block, length)
    body = (length - head) // block * block
    if head:
        yield 0, head, head
    if body:
        yield head, head + body, block
    if head + body < length:
        yield head + body, length, length - head - body


def _block_sums(values: np.ndarray, high: int, wide: int, dtype) -> np.ndarray:
    rows, columns = values.shape[0] // high, values.shape[1] // wide
    if high > 1:
        values = values.reshape(rows, high, values.shape[1]).sum(1, dtype=dtype)
    return values.reshape(rows, columns, wide).sum(2, dtype=dtype) if wide > 1 else values


def _in_threads(work: Callable, items: Iterator) -> Iterator:
    """Results in order, a few items ahead: all of them at once would be the whole file in memory."""
    waiting: deque[Future] = deque()
    with ThreadPoolExecutor(THREADS) as pool:
        try:
            for item in items:
                waiting.append(pool.submit(work, item))
                if len(waiting) >= 2 * THREADS:
                    yield waiting.popleft().result()
            while waiting:
                yield waiting.popleft().result()
        finally:
            for future in waiting:
                future.cancel()
