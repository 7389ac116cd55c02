"""From checked arguments to the compiled loops of `loops.py`: octaves as arrays of numbers, and threads.

Threads are Python's: the loops release the interpreter lock, and workers take chunks from a common counter,
so that a core that others use does less. Each point is computed alone: the result does not depend on the
number of threads.
"""

from __future__ import annotations

import functools
import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor

import numpy as np
from numba.core.registry import cpu_target

from . import hashing, loops, sources, vectors
from .static import Static

CHUNK = 4096  # points: about a tenth of a millisecond for ten octaves
FEW = 32768  # points times octaves, below which other threads cost more than they bring


def fbm(axes, out, *, kind, fractal="fbm", threads=1, **series):
    """Fill `out` with a fractal sum of octaves at the points.

    Parameters
    ----------
    axes : sequence of D flat arrays, all float32 or all float64, of any stride; or a `sources.Source`
    out : flat float32 array
    kind, fractal : str
    threads : int
    **series
        `octaves`, `lacunarity`, `gain`, `seed`, `frequency`, `period` (None or D integers) and `fades`
        (None or an array: how much of each octave shows).
    """
    launch(axes, [out], octaves_of(**series), kind=kind, fractal=fractal, threads=threads)


def gradient(axes, value, derivatives, *, kind, threads=1, **series):
    """As `fbm`, with the derivatives by the points' coordinates in the columns of `derivatives`."""
    outputs = [value, *derivatives.T]
    launch(axes, outputs, octaves_of(**series), kind=kind, derivatives=True, threads=threads)


def octaves_of(
    octaves, lacunarity=2.0, gain=0.5, seed=0, frequency=1.0, period=None, fades=None, *, offset=0
):
    """Frequency, share, words and periods of each octave; those of no share at the fine end are left out."""
    index = np.arange(octaves)
    frequencies = frequency * float(lacunarity) ** index
    amplitudes = float(gain) ** index
    amplitudes /= amplitudes.sum()
    if fades is not None:
        amplitudes *= fades
    kept = int(np.flatnonzero(amplitudes).max(initial=-1)) + 1
    words = _words(seed, offset, kept)
    periods = np.zeros((kept, 4))
    if period is not None:
        periods[:, : len(period)] = np.multiply.outer(float(lacunarity) ** index[:kept], period)
    return frequencies[:kept], amplitudes[:kept], words, periods


@functools.lru_cache(maxsize=256)
def _words(seed: int, first: int, octaves: int) -> np.ndarray:
    """The words of some octaves, kept: plain Python takes longer for them than the loops for a tile."""
    words = [hashing.axis_words(seed, first + i) for i in range(octaves)]
    return np.array(words, np.int64).reshape(octaves, 4)


def launch(
    points: Sequence[np.ndarray] | sources.Source,
    outputs: Sequence[np.ndarray],
    octaves: tuple[np.ndarray, ...],
    *,
    kind: str,
    fractal: str = "fbm",
    derivatives: bool = False,
    threads: int = 1,
):
    """Fill `outputs` (flat float32 arrays) with the noise at the points."""
    source = points if isinstance(points, sources.Source) else sources.arrays(points)
    periodic = bool(octaves[3].any())
    # cells wrap in float64; and float32 is exact only where products need not be rounded
    if periodic or not _fused():
        source = source.doubled()
    if periodic and kind == "simplex":
        kind = "simplex_periodic"
    places = np.array([(a.__array_interface__["data"][0], a.strides[0]) for a in outputs], np.int64)

    def run(source: sources.Source) -> bool:
        static = Static(
            kind=kind,
            dimensions=source.dimensions,
            width=_width(),
            derivatives=derivatives,
            fractal=fractal,
            periodic=periodic,
            double=source.double,
        )
        arguments = (static, source.fill, source.data, places, *octaves)
        return _in_chunks(lambda *part: loops.run(*arguments, *part), source.count, len(octaves[0]), threads)

    if not run(source):  # too far from the origin for float32
        run(source.doubled())


def _in_chunks(work, count: int, octaves: int, threads: int) -> bool:
    """Call ``work(start, stop)`` for all parts of `count` points; whether all of them said that they
    succeeded."""
    if threads == 1 or count * max(octaves, 1) <= FEW or count <= CHUNK:
        return work(0, count)
    chunk = max(CHUNK, -(-count // (threads * 16)) & -loops.TILE)
    starts = iter(range(0, count, chunk))  # one step of it is atomic: it may be shared

    def take() -> bool:
        return all([work(start, min(start + chunk, count)) for start in starts])

    helpers = [_pool().submit(take) for _ in range(min(threads, -(-count // chunk)) - 1)]
    own = take()
    return all([own, *(helper.result() for helper in helpers)])


@functools.cache
def _width() -> int:
    return vectors.host_width()


@functools.cache
def _fused() -> bool:
    return vectors.has_fma(cpu_target.target_context)


@functools.cache
def _pool() -> ThreadPoolExecutor:
    return ThreadPoolExecutor(max(1, (os.cpu_count() or 1) - 1), "fallstreak-noise")


if hasattr(os, "register_at_fork"):  # a forked process inherits the pool without its threads
    os.register_at_fork(after_in_child=_pool.cache_clear)
