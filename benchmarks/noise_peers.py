"""Noise of other libraries and ours on the same points, timed in turns within one process.

Every runner is a name, such as ``"pyfastnoisesimd perlin"``; `prepare` makes it a function of no arguments
that fills a plane of points with twelve octaves, and `race` times several of them round by round. Where
something must differ for the whole process (AVX2 only, no vectors), `race_apart` does it in a process of its
own, peers and all. None of the peers is needed for anything else; docs/noise.md says how to install them.
"""

from __future__ import annotations

import ctypes
import importlib
import json
import os
import random
import subprocess
import sys
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from statistics import median

import numpy as np

SIDE, OCTAVES, SEED = 1024, 12, 1337
LIBRARY = "FALLSTREAK_FASTNOISE2"  # where FastNoise2's shared library lies
AVX2 = "FALLSTREAK_BENCH_AVX2"  # set: the peers that choose by themselves are held to AVX2
SLOW_SAMPLE = 512  # points of the plane that the slowest peer is given

Runner = Callable[[], object]


class MissingError(Exception):
    """A peer that is not there; the message says why."""


@dataclass(frozen=True)
class Times:
    """Seconds of every round of one runner."""

    seconds: list[float]

    @property
    def median(self) -> float:
        return median(self.seconds)

    @property
    def least(self) -> float:
        return min(self.seconds)


def plane() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """1024² points of a tilted plane, 256 to a cell of the first octave: x, y, z, float32, flat."""
    u, v = np.meshgrid(np.arange(SIDE) / 256, np.arange(SIDE) / 256)
    rows = (0.8, 0.1, 0.37), (0.3, 0.9, 1.21), (-0.5, 0.4, 2.73)
    x, y, z = (np.ascontiguousarray((a * u + b * v + c).ravel(), np.float32) for a, b, c in rows)
    return x, y, z


def race(rounds: Mapping[str, int], seed: int = 1) -> dict[str, Times | str]:
    """Time runners in turns, each as often as it says; the order changes from round to round.

    Returns
    -------
    Times of every runner, or in words why it is missing.
    """
    found: dict[str, Times | str] = {}
    runners: dict[str, Runner] = {}
    for name in rounds:
        try:
            runners[name] = prepare(name)
            runners[name]()  # compiles, fills caches
        except MissingError as error:
            found[name] = str(error)
    seconds: dict[str, list[float]] = {name: [] for name in runners}
    order, most = random.Random(seed), max(rounds.values())
    for turn in range(most):
        # A slow runner's few rounds are spread over all of the time.
        due = [n for n in runners if (turn + 1) * rounds[n] // most > turn * rounds[n] // most]
        order.shuffle(due)
        for name in due:
            start = time.perf_counter()
            runners[name]()
            seconds[name].append(time.perf_counter() - start)
    return found | {name: Times(s) for name, s in seconds.items()}


def race_apart(rounds: Mapping[str, int], environment: Mapping[str, str]) -> dict[str, Times | str]:
    """`race` in a new process with other environment variables."""
    result = subprocess.run(
        [sys.executable, __file__, json.dumps(dict(rounds))],
        env=os.environ | dict(environment),
        stdout=subprocess.PIPE,
        text=True,
        check=True,
    )
    found = json.loads(result.stdout.splitlines()[-1])
    return {name: value if isinstance(value, str) else Times(value) for name, value in found.items()}


def prepare(name: str) -> Runner:
    """The runner of a name: a library, a kind, ``all`` for all cores.

    Raises
    ------
    MissingError
        If the library is not there.
    """
    library, _, rest = name.partition(" ")
    return _LIBRARIES[library](*rest.split())


def describe() -> list[str]:
    """The peers that are here, with versions."""
    here = []
    for package in ("pyfastnoisesimd", "pyfastnoiselite", "noise", "opensimplex", "vnoise", "perlin-noise"):
        try:
            here.append(f"{package} {version(package)}")
        except PackageNotFoundError:
            here.append(f"{package} not installed")
    path = os.environ.get(LIBRARY)
    return [*here, f"FastNoise2 {path}" if path else f"FastNoise2 not given (--fastnoise2 PATH or {LIBRARY})"]


def _fallstreak(kind: str, *how: str) -> Runner:
    """``all``: every core; ``rows``: points as (N, 3) instead of three arrays; ``double``: in float64."""
    from fallstreak import noise

    points = plane()
    if "double" in how:
        points = tuple(axis.astype(np.float64) for axis in points)
    given = np.stack(points, -1) if "rows" in how else points
    out = np.empty(SIDE * SIDE, np.float32)
    threads = None if "all" in how else 1
    return lambda: noise.fbm(given, OCTAVES, kind=kind, seed=SEED, threads=threads, out=out)


def _pyfastnoisesimd(kind: str, cores: str = "one") -> Runner:
    simd = _module("pyfastnoisesimd")
    if AVX2 in os.environ:
        # The library asks the processor once and keeps the answer in a public variable: 3 is AVX2.
        library = ctypes.CDLL(simd.extension.__file__)
        ctypes.c_int.in_dll(library, "_ZN13FastNoiseSIMD18s_currentSIMDLevelE").value = 3
    noise = simd.Noise(SEED, (os.cpu_count() or 1) if cores == "all" else 1)
    noise.frequency = 1.0
    noise.noiseType = simd.NoiseType[f"{kind.capitalize()}Fractal"]
    noise.fractal.octaves = OCTAVES
    points = simd.empty_coords(SIDE * SIDE)  # aligned as the library wants it
    points[:] = np.stack(plane())
    return lambda: noise.genFromCoords(points)


def _fastnoise2(kind: str) -> Runner:
    path = os.environ.get(LIBRARY)
    if not path:
        raise MissingError("FastNoise2 was not given")
    try:
        library = ctypes.CDLL(path)
    except OSError as error:
        raise MissingError(f"FastNoise2 cannot be loaded: {error}") from error
    pointer, number, real = ctypes.c_void_p, ctypes.c_int, ctypes.c_float
    for function, result, arguments in (
        ("fnGetMetadataName", ctypes.c_char_p, [number]),
        ("fnNewFromMetadata", pointer, [number, ctypes.c_uint]),
        ("fnSetVariableFloat", ctypes.c_bool, [pointer, number, real]),
        ("fnSetVariableIntEnum", ctypes.c_bool, [pointer, number, number]),
        ("fnSetNodeLookup", ctypes.c_bool, [pointer, number, pointer]),
        (
            "fnGenPositionArray3D",
            None,
            [pointer, pointer, number, *[pointer] * 3, *[real] * 3, number, pointer],
        ),
    ):
        getattr(library, function).restype = result
        getattr(library, function).argtypes = arguments
    ids = {library.fnGetMetadataName(i).decode(): i for i in range(library.fnGetMetadataCount())}
    most = 0x3FE if AVX2 in os.environ else 0xFFFFFFFF  # its bits for everything up to AVX2
    source = library.fnNewFromMetadata(ids[kind.capitalize()], most)
    library.fnSetVariableFloat(source, 0, 1.0)  # the size of a cell
    fractal = library.fnNewFromMetadata(ids["FractalFBm"], most)  # gain .5 and lacunarity 2 unless told
    library.fnSetVariableIntEnum(fractal, 0, OCTAVES)
    library.fnSetNodeLookup(fractal, 0, source)
    points, out = plane(), np.empty(SIDE * SIDE, np.float32)
    places = [axis.ctypes.data for axis in points]
    generate = library.fnGenPositionArray3D

    def run() -> np.ndarray:
        generate(fractal, out.ctypes.data, len(points[0]), *places, 0.0, 0.0, 0.0, SEED, None)
        return out

    return run


def _pyfastnoiselite(kind: str) -> Runner:
    lite = _module("pyfastnoiselite.pyfastnoiselite")
    noise = lite.FastNoiseLite(SEED)
    noise.frequency = 1.0
    noise.noise_type = getattr(lite.NoiseType, f"NoiseType_{kind.capitalize()}")
    noise.fractal_type = lite.FractalType.FractalType_FBm
    noise.fractal_octaves = OCTAVES
    points = np.stack(plane())
    return lambda: noise.gen_from_coords(points)


def _noise(kind: str) -> Runner:
    pnoise3 = _module("noise").pnoise3
    points = [axis.tolist() for axis in plane()]
    return lambda: [pnoise3(x, y, z, OCTAVES) for x, y, z in zip(*points, strict=True)]


def _opensimplex(kind: str) -> Runner:
    """Its compiled noise in a compiled loop: its own array function takes grids along the axes only."""
    inside = _module("opensimplex.internals")
    numba = _module("numba")
    noise3 = inside._noise3
    if not hasattr(noise3, "py_func"):
        raise MissingError("opensimplex found no numba")
    permutation, gradients = inside._init(SEED)
    points, out = [axis.astype(np.float64) for axis in plane()], np.empty(SIDE * SIDE)

    @numba.njit
    def fill(x, y, z, permutation, gradients, out):
        for i in range(len(out)):
            total, weight, scale = 0.0, 1.0, 1.0
            for _ in range(OCTAVES):
                total += weight * noise3(x[i] * scale, y[i] * scale, z[i] * scale, permutation, gradients)
                weight *= 0.5
                scale *= 2.0
            out[i] = total

    return lambda: fill(*points, permutation, gradients, out)


def _vnoise(kind: str) -> Runner:
    noise = _module("vnoise").Noise(SEED)
    points = plane()
    return lambda: noise.noise3(*points, octaves=OCTAVES, grid_mode=False)


def _perlin_noise(kind: str) -> Runner:
    """A small part of the plane; who prints it multiplies by ``SIDE² / SLOW_SAMPLE``."""
    made = _module("perlin_noise").PerlinNoise
    octaves = [made(octaves=2**i, seed=SEED + i) for i in range(OCTAVES)]
    points = [tuple(float(v) for v in point) for point in np.stack(plane(), -1)[:: SIDE**2 // SLOW_SAMPLE]]
    return lambda: [sum(noise(point) / 2**i for i, noise in enumerate(octaves)) for point in points]


def _numpy(kind: str, size: str = "whole") -> Runner:
    """Hash-gradient Perlin as one would write it in numpy; ``pieces``: by what stays in the cache."""
    points, out = plane(), np.empty(SIDE * SIDE, np.float32)
    step = 16384 if size == "pieces" else len(out)

    def run() -> np.ndarray:
        for start in range(0, len(out), step):
            part = slice(start, start + step)
            out[part] = sum(
                _numpy_octave(*(axis[part] * np.float32(2**i) for axis in points), SEED + i)
                * np.float32(0.5**i)
                for i in range(OCTAVES)
            )
        return out

    return run


def _numpy_octave(x, y, z, seed):
    cells = [np.floor(axis) for axis in (x, y, z)]
    offsets = [axis - cell for axis, cell in zip((x, y, z), cells, strict=True)]
    u, v, w = (t * t * t * (t * (t * 6 - 15) + 10) for t in offsets)
    primes = np.array([0x9E3779B1, 0x85EBCA6B, 0xC2B2AE35], np.uint32)
    i, j, k = (c.astype(np.int32).view(np.uint32) * p for c, p in zip(cells, primes, strict=True))
    values = []
    for corner in range(8):
        dx, dy, dz = corner & 1, corner >> 1 & 1, corner >> 2
        h = (
            (i + primes[0] * np.uint32(dx))
            ^ (j + primes[1] * np.uint32(dy))
            ^ (k + primes[2] * np.uint32(dz))
        )
        h = (h ^ np.uint32(seed)) * np.uint32(0x27D4EB2F)
        h = (h ^ h >> np.uint32(15)) >> np.uint32(3) & np.uint32(15)
        p, q, r = offsets[0] - np.float32(dx), offsets[1] - np.float32(dy), offsets[2] - np.float32(dz)
        first = np.where(h < 8, p, q)
        second = np.where(h < 4, q, np.where((h == 12) | (h == 14), p, r))
        values.append(np.where(h & 1, -first, first) + np.where(h & 2, -second, second))
    for t in (u, v, w):
        values = [a + t * (b - a) for a, b in zip(values[::2], values[1::2], strict=True)]
    return values[0]


def _journal(step: str) -> Runner:
    import noise_journal

    return noise_journal.runner(step, plane(), OCTAVES)


def _clock() -> Runner:
    import noise_bound

    return noise_bound.chain


def _module(name: str):
    try:
        return importlib.import_module(name)
    except ImportError as error:
        raise MissingError(f"{name.partition('.')[0]} is not installed") from error


_LIBRARIES: dict[str, Callable[..., Runner]] = {
    "fallstreak": _fallstreak,
    "pyfastnoisesimd": _pyfastnoisesimd,
    "FastNoise2": _fastnoise2,
    "pyfastnoiselite": _pyfastnoiselite,
    "noise": _noise,
    "opensimplex": _opensimplex,
    "vnoise": _vnoise,
    "perlin-noise": _perlin_noise,
    "numpy": _numpy,
    "journal": _journal,
    "clock": _clock,
}


if __name__ == "__main__":
    raced = race(json.loads(sys.argv[1]))
    print(json.dumps({name: t if isinstance(t, str) else t.seconds for name, t in raced.items()}))
