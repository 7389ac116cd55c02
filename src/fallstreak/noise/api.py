"""The noise functions: arguments checked, points brought into shape, the work given to the compiled loops.

All take points in the units in which `frequency` is one over the size of a cell, and give float32.
"""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import arguments, compose, sources, tiles

Points = ArrayLike | tuple[ArrayLike, ...]
Floats = NDArray[np.float32]
KindName = Literal[
    "perlin", "simplex", "value", "cellular_f1", "cellular_f2", "cellular_f2f1", "improved", "table"
]
FractalName = Literal["fbm", "ridged", "billow", "turbulence", "hybrid"]

LOWEST, HIGHEST = 1e-12, 1e12  # of a frequency


def sample(
    points: Points,
    kind: KindName = "perlin",
    *,
    seed: int = 0,
    frequency: float = 1.0,
    period: int | tuple[int, ...] | None = None,
    threads: int | None = None,
    out: Floats | None = None,
) -> Floats:
    """One octave of noise.

    Parameters
    ----------
    points : array of shape (..., D), or tuple of D arrays of one shape
        D is 2, 3 or 4. float32 or float64; integers are converted. Cells are found in the points' own
        precision: float64 has no steps even 10 000 km from the origin, float32 has them from about 1e5 cells
        on. A tuple of contiguous arrays is the fastest form and is not copied.
    kind : str
        One of `kinds.KINDS`, which also says the range of each; most are within −1…1.
    seed : int
        0 to 2³² − 1; noises of different seeds have nothing in common.
    frequency : float
        Cells per unit of the points.
    period : int or D ints, optional
        The noise repeats exactly after so many cells. That of simplex noise must be even along y in 2-D, and
        it has none in 4-D.
    threads : int, optional
        1 is this thread; None is as many as there are cores. The result does not depend on it.
    out : float32 array of shape (...), optional
        Where to write.

    Returns
    -------
    float32 array of shape (...)
        NaN where a coordinate is NaN or infinite.

    Raises
    ------
    ValueError
        When an argument is not allowed: one sentence that names it, its value, and what is.

    Notes
    -----
    Perlin noise in 3-D costs 2 ns a point and thread with AVX-512, 3.5 ns with AVX2; docs/noise.md has the
    other kinds. Beyond 2⁵¹ cells from the origin values mean nothing.
    """
    return fbm(points, 1, kind=kind, seed=seed, frequency=frequency, period=period, threads=threads, out=out)


def fbm(
    points: Points,
    octaves: int = 8,
    *,
    kind: KindName = "perlin",
    fractal: FractalName = "fbm",
    lacunarity: float = 2.0,
    gain: float = 0.5,
    seed: int = 0,
    frequency: float = 1.0,
    period: int | tuple[int, ...] | None = None,
    spacing: float | None = None,
    threads: int | None = None,
    out: Floats | None = None,
) -> Floats:
    """Octaves of noise added up: fractional Brownian motion, or another fractal sum.

    Octave i has ``lacunarity**i`` times the frequency, ``gain**i`` times the weight, and a seed of its own.
    The sum is divided by that of the weights, so that it keeps the range of one octave.

    Parameters
    ----------
    points, kind, seed, frequency, period, threads, out
        As for `sample`; `period` is that of the first octave, and `lacunarity` must then be an integer.
    octaves : int
        1 to 32. The cost is proportional to it.
    fractal : str
        One of `kinds.FRACTALS`: "fbm", "ridged", "billow", "turbulence", "hybrid" (Musgrave in Ebert et al.,
        *Texturing and Modeling*, 2003, chapter 16).
    lacunarity : float
        1 to 16.
    gain : float
        0 to 4.
    spacing : float, optional
        The distance between neighbouring samples, in the units of the points. Octaves with fewer than 2
        samples a wavelength are left out and up to 4 they fade in: no aliasing, and less work.

    Returns
    -------
    float32 array of shape (...)
    """
    return _fractal(
        points, None, octaves, kind, fractal, lacunarity, gain, seed, frequency, period, spacing, threads, out
    )


def ridged(points: Points, octaves: int = 8, **options: Any) -> Floats:
    """`fbm` with ``fractal="ridged"``: sharp ridges, 0…1."""
    return fbm(points, octaves, fractal="ridged", **options)


def billow(points: Points, octaves: int = 8, **options: Any) -> Floats:
    """`fbm` with ``fractal="billow"``: rounded heaps, −1…1."""
    return fbm(points, octaves, fractal="billow", **options)


def turbulence(points: Points, octaves: int = 8, **options: Any) -> Floats:
    """`fbm` with ``fractal="turbulence"``: absolute values, 0…1."""
    return fbm(points, octaves, fractal="turbulence", **options)


def hybrid(points: Points, octaves: int = 8, **options: Any) -> Floats:
    """`fbm` with ``fractal="hybrid"``: smooth where low, rough where high."""
    return fbm(points, octaves, fractal="hybrid", **options)


def warp(
    points: Points,
    amount: float = 1.0,
    octaves: int = 8,
    *,
    kind: KindName = "perlin",
    lacunarity: float = 2.0,
    gain: float = 0.5,
    seed: int = 0,
    frequency: float = 1.0,
    period: int | tuple[int, ...] | None = None,
    spacing: float | None = None,
    threads: int | None = None,
    out: Floats | None = None,
) -> Floats:
    """`fbm` of points that D other `fbm` have displaced: swirls and folds, as in marble or old clouds.

    Parameters
    ----------
    amount : float
        How far a displacement of 1 goes, in the units of the points; 0 is plain `fbm`.
    points, octaves, kind, lacunarity, gain, seed, frequency, period, spacing, threads, out
        As for `fbm`. The cost is 1 + D times that of `fbm`.

    Returns
    -------
    float32 array of shape (...)
    """
    amount = arguments.real("amount", amount, -1e12, 1e12)
    return _fractal(
        points, amount, octaves, kind, "fbm", lacunarity, gain, seed, frequency, period, spacing, threads, out
    )


def gradient(
    points: Points,
    kind: Literal["perlin", "simplex"] = "perlin",
    *,
    octaves: int = 1,
    lacunarity: float = 2.0,
    gain: float = 0.5,
    seed: int = 0,
    frequency: float = 1.0,
    period: int | tuple[int, ...] | None = None,
    spacing: float | None = None,
    threads: int | None = None,
) -> tuple[Floats, Floats]:
    """Noise and its derivatives, analytically.

    Parameters
    ----------
    points, octaves, lacunarity, gain, seed, frequency, period, spacing, threads
        As for `fbm`.
    kind : str
        "perlin" or "simplex".

    Returns
    -------
    value : float32 array of shape (...)
    derivatives : float32 array of shape (..., D)
        Per unit of the points, ∂/∂x first.
    """
    axes, shape = arguments.axes_of(points)
    settings = _settings(
        axes, kind, octaves, lacunarity, gain, seed, frequency, period, spacing, threads, gradient=True
    )
    value = np.empty(shape, np.float32)
    derivatives = np.empty((*shape, len(axes)), np.float32)
    if value.size:
        tiles.gradient(axes, value.reshape(-1), derivatives.reshape(-1, len(axes)), **settings)
    return value, derivatives


def curl(
    points: Points,
    *,
    octaves: int = 1,
    lacunarity: float = 2.0,
    gain: float = 0.5,
    seed: int = 0,
    frequency: float = 1.0,
    period: int | tuple[int, ...] | None = None,
    spacing: float | None = None,
    threads: int | None = None,
    out: Floats | None = None,
) -> Floats:
    """A flow without sources: the curl of Perlin noise (Bridson, Houriham and Nordenstam 2007).

    Parameters
    ----------
    points
        As for `sample`, in 2-D (one potential) or 3-D (three).
    octaves, lacunarity, gain, seed, frequency, period, spacing, threads
        As for `fbm`.
    out : float32 array of shape (..., D), optional

    Returns
    -------
    float32 array of shape (..., D)
        The velocity, whose divergence is 0.
    """
    axes, shape = arguments.axes_of(points)
    if len(axes) == 4:
        raise ValueError("points have 4 coordinates: curl noise is in 2 or 3 dimensions")
    settings = _settings(
        axes, "perlin", octaves, lacunarity, gain, seed, frequency, period, spacing, threads, gradient=True
    )
    del settings["kind"]
    out = arguments.output(out, (*shape, len(axes)), axes)
    _into(out, 1, lambda flat: compose.curl(axes, flat, **settings))
    return out


def grid(
    shape: tuple[int, ...],
    *,
    step: float | tuple[float, ...] | None = None,
    origin: float | tuple[float, ...] = 0.0,
    octaves: int = 1,
    kind: KindName = "perlin",
    fractal: FractalName = "fbm",
    lacunarity: float = 2.0,
    gain: float = 0.5,
    seed: int = 0,
    frequency: float = 1.0,
    period: int | tuple[int, ...] | None = None,
    spacing: float | None = None,
    threads: int | None = None,
    out: Floats | None = None,
) -> Floats:
    """Noise on a regular grid.

    Parameters
    ----------
    shape : tuple of 2, 3 or 4 ints
        The last axis is x: ``(height, width)``, ``(depth, height, width)``.
    step : float or D floats, x first, optional
        The distance between neighbours. Unless given, the grid holds one period where there is one, so that
        its copies fit together, and else 64 points a cell.
    origin : float or D floats, x first
        Where element ``[0, 0]`` lies.
    octaves, kind, fractal, lacunarity, gain, seed, frequency, period, spacing, threads, out
        As for `fbm`.

    Returns
    -------
    float32 array of `shape`
    """
    shape = arguments.shape_of(shape)
    count = len(shape)
    frequency = arguments.real("frequency", frequency, LOWEST, HIGHEST)
    empty = tuple(np.empty(0) for _ in shape)
    settings = _settings(
        empty, kind, octaves, lacunarity, gain, seed, frequency, period, spacing, threads, fractal=fractal
    )
    start = arguments.reals("origin", origin, count, -1e15, 1e15)
    if step is not None:
        steps = arguments.reals("step", step, count, -1e12, 1e12)
    elif settings["period"] is not None:
        steps = tuple(
            p / (frequency * max(n, 1)) for p, n in zip(settings["period"], shape[::-1], strict=True)
        )
    else:
        steps = (1.0 / (64.0 * frequency),) * count
    out = arguments.output(out, shape)
    source = sources.grid(shape, start, steps)
    _into(out, 0, lambda flat: tiles.fbm(source, flat, **settings))
    return out


def cube(
    size: int,
    *,
    radius: float = 1.0,
    octaves: int = 8,
    kind: KindName = "perlin",
    fractal: FractalName = "fbm",
    lacunarity: float = 2.0,
    gain: float = 0.5,
    seed: int = 0,
    frequency: float = 1.0,
    spacing: float | None = None,
    threads: int | None = None,
    out: Floats | None = None,
) -> Floats:
    """3-D noise on the sphere, as the six faces of a cube map: no seams, no poles.

    Parameters
    ----------
    size : int
        Texels along an edge, 1 to 16384.
    radius : float
        Of the sphere, in the units of which `frequency` counts the cells.
    octaves, kind, fractal, lacunarity, gain, seed, frequency, spacing, threads, out
        As for `fbm`.

    Returns
    -------
    float32 array of shape (6, size, size)
        Faces +x, −x, +y, −y, +z, −z, texels as WebGPU's cube textures have them. `cube_directions` gives
        where their centres lie.
    """
    size = arguments.integer("size", size, 1, 16384)
    radius = arguments.real("radius", radius, LOWEST, HIGHEST)
    shape = (6, size, size)
    empty = tuple(np.empty(0) for _ in shape)
    settings = _settings(
        empty, kind, octaves, lacunarity, gain, seed, frequency, None, spacing, threads, fractal=fractal
    )
    out = arguments.output(out, shape)
    source = sources.cube(size, radius)
    _into(out, 0, lambda flat: tiles.fbm(source, flat, **settings))
    return out


def cube_directions(size: int) -> NDArray[np.float64]:
    """Unit vectors to the centres of a cube map's texels, (6, size, size, 3), faces as in `cube`."""
    size = arguments.integer("size", size, 1, 16384)
    return np.stack([np.stack(_face(face, size), -1) for face in range(6)])


def _fractal(
    points, amount, octaves, kind, fractal, lacunarity, gain, seed, frequency, period, spacing, threads, out
) -> Floats:
    axes, shape = arguments.axes_of(points)
    settings = _settings(
        axes, kind, octaves, lacunarity, gain, seed, frequency, period, spacing, threads, fractal=fractal
    )
    out = arguments.output(out, shape, axes)
    if amount is None:
        _into(out, 0, lambda flat: tiles.fbm(axes, flat, **settings))
    else:
        del settings["fractal"]
        _into(out, 0, lambda flat: compose.warp(axes, flat, amount, **settings))
    return out


def _settings(
    axes,
    kind,
    octaves,
    lacunarity,
    gain,
    seed,
    frequency,
    period,
    spacing,
    threads,
    *,
    fractal=None,
    gradient=False,
) -> dict[str, Any]:
    """Everything that the loops want besides points, checked."""
    octaves = arguments.integer("octaves", octaves, 1, arguments.MOST_OCTAVES)
    lacunarity = arguments.real("lacunarity", lacunarity, 1.0, 16.0)
    frequency = arguments.real("frequency", frequency, LOWEST, HIGHEST)
    kind = arguments.kind_of(kind, len(axes), gradient=gradient)
    settings = {
        "kind": kind,
        "octaves": octaves,
        "lacunarity": lacunarity,
        "gain": arguments.real("gain", gain, 0.0, 4.0),
        "seed": arguments.integer("seed", seed, 0, 2**32 - 1),
        "frequency": frequency,
        "period": arguments.period_of(period, kind, len(axes), octaves, lacunarity),
        "fades": arguments.fades_of(spacing, octaves, lacunarity, frequency),
        "threads": arguments.thread_count(threads),
    }
    if fractal is not None:
        settings["fractal"] = arguments.fractal_of(fractal)
    return settings


def _into(out: Floats, extra: int, fill) -> None:
    """Let `fill` write a flat, contiguous view of `out`, or a copy where there is no such view."""
    if out.size == 0:
        return
    form = (-1, *out.shape[out.ndim - extra :])
    if out.flags.c_contiguous:
        fill(out.reshape(form))
    else:
        filled = np.empty(out.shape, np.float32)
        fill(filled.reshape(form))
        out[...] = filled


def _face(face: int, size: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Unit vectors to texels of a face: u runs right and v down, as in the WebGPU specification's table."""
    ticks = (np.arange(size) + 0.5) * (2.0 / size) - 1.0
    u, v = np.broadcast_arrays(ticks, ticks[:, None])
    w = np.ones_like(u)
    x, y, z = (
        (w, -v, -u),
        (-w, -v, u),
        (u, w, v),
        (u, -w, -v),
        (u, -v, w),
        (-u, -v, -w),
    )[face]
    length = np.sqrt(x * x + y * y + z * z)
    return x / length, y / length, z / length
