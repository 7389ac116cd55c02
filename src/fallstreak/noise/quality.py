"""How good a noise is, measured: its spectrum, its directions, its lattice, its repetitions.

Plain numpy; for the tests, for ``fallstreak bench noise_quality``, and for whoever has a noise to judge. A
*noise* here is a function of points, ``(..., 3)`` float64 in cells, that returns ``(...)`` values. One octave
tells most: in a fractal sum the faults of one octave hide behind the others.

What the figures say: energy under a quarter of a cycle per cell is what an octave has no business having (it
blurs what the lower octaves drew). The power along axes and diagonals, at the same wavelength, shows the
lattice as streaks. Extrema that sit on lattice points show it as beads. Correlations show a hash that
forgets, or a table that starts again.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import combinations, product

import numpy as np

Noise = Callable[[np.ndarray], np.ndarray]

#: wavelengths compared for direction: around one cell, where gradient noise has most of its power
BAND = (0.8, 1.2)
#: half the opening of the cones about an axis or a diagonal
CONE = np.radians(15.0)


@dataclass(frozen=True)
class Quality:
    """Figures of one octave; shares are 0…1, directions are power over the mean of all directions."""

    low_energy: float
    axis: float
    diagonal: float
    body_diagonal: float
    lattice_extrema: float


def measure(noises: Sequence[Noise], size: int = 256, per_cell: int = 8) -> Quality:
    """Measure one octave on volumes of ``size``³ samples, ``per_cell`` samples a cell.

    Parameters
    ----------
    noises
        The same noise with different seeds. Their spectra are averaged: one volume of 256³ knows the
        directions to about 2 %, eight of 128³ as well.
    size, per_cell
        Even; `size` must hold at least eight cells for the energy under .25 cycles per cell to mean much.

    Notes
    -----
    Volumes are seen through a Hann window, so that their cut faces do not count as energy. Cost: about 3 s
    per volume of 256³, of which the transform takes 1 s; 1 GB of memory.
    """
    power, extrema, beads = 0.0, 0, 0
    for noise in noises:
        volume = sample_volume(noise, size, per_cell)
        power = power + spectrum(volume)
        on_lattice, everywhere = count_extrema(volume, per_cell)
        beads, extrema = beads + on_lattice, extrema + everywhere
    axis, diagonal, body = directions(np.asarray(power), per_cell)
    return Quality(
        low_energy(np.asarray(power), per_cell), axis, diagonal, body, beads / extrema if extrema else 0.0
    )


def sample_volume(noise: Noise, size: int, per_cell: int) -> np.ndarray:
    """The noise on a cube from the origin, (size, size, size) float32, indices x, y, z."""
    ticks = np.arange(size) / per_cell
    volume = np.empty((size, size, size), np.float32)
    points = np.empty((size, size, 3))
    points[..., 1], points[..., 2] = ticks[:, None], ticks
    for plane, x in zip(volume, ticks, strict=True):
        points[..., 0] = x
        plane[...] = noise(points)
    return volume


def spectrum(volume: np.ndarray) -> np.ndarray:
    """Power of the windowed volume, in the layout of ``rfftn``; the mirrored half is counted in."""
    size = len(volume)
    window = np.hanning(size + 1)[:-1].astype(np.float32)
    volume = (volume - volume.mean()) * (window[:, None, None] * window[:, None] * window)
    power = np.abs(np.fft.rfftn(volume)) ** 2
    power[..., 1:-1] *= 2
    return power


def low_energy(power: np.ndarray, per_cell: int, below: float = 0.25) -> float:
    """The share of the energy at less than `below` cycles per cell."""
    frequency = _frequency(power, per_cell)[1]
    return float(power[frequency < below].sum() / power.sum())


def directions(power: np.ndarray, per_cell: int) -> tuple[float, float, float]:
    """Power along the axes, the face diagonals and the body diagonals, each over the mean of `BAND`."""
    components, frequency = _frequency(power, per_cell)
    inside = (frequency >= BAND[0]) & (frequency < BAND[1])
    ways = np.sort(np.abs(np.stack([c[inside] for c in np.broadcast_arrays(*components)])), axis=0)
    ways /= frequency[inside]
    # a mode inside rfftn's half stands for two, so that it must also count as two in the mean
    count = np.broadcast_to(
        np.where((np.arange(power.shape[-1]) % (power.shape[-1] - 1)) == 0, 1, 2), power.shape
    )
    count, power = count[inside], power[inside]
    mean = power.sum() / count.sum()
    cosines = (ways[2], (ways[1] + ways[2]) / np.sqrt(2), ways.sum(0) / np.sqrt(3))
    axis, diagonal, body = (
        float(power[near].sum() / count[near].sum() / mean)
        for near in (cosine > np.cos(CONE) for cosine in cosines)
    )
    return axis, diagonal, body


def count_extrema(volume: np.ndarray, per_cell: int) -> tuple[int, int]:
    """Local extrema among 26 neighbours: how many lie on lattice points, and how many there are."""
    inner = volume[1:-1, 1:-1, 1:-1]
    highest, lowest = np.ones(inner.shape, bool), np.ones(inner.shape, bool)
    ends = [(slice(0, -2), slice(1, -1), slice(2, None))] * 3
    for way in product(range(3), repeat=3):
        if way == (1, 1, 1):
            continue
        neighbour = volume[tuple(ends[d][w] for d, w in enumerate(way))]
        highest &= inner > neighbour
        lowest &= inner < neighbour
    extrema = highest | lowest
    on_lattice = extrema[per_cell - 1 :: per_cell, per_cell - 1 :: per_cell, per_cell - 1 :: per_cell]
    return int(on_lattice.sum()), int(extrema.sum())


def places(count: int = 2**19, dimensions: int = 3) -> np.ndarray:
    """The same place in each of about `count` neighbouring cells from the origin, (n, D) float64.

    The same, because cellular noise has a mean that depends on the place in the cell, which is no repetition.
    """
    side = round(count ** (1 / dimensions))
    cells = np.stack(np.meshgrid(*[np.arange(side)] * dimensions, indexing="ij"), -1)
    return cells.reshape(-1, dimensions) + np.array([0.37, 0.58, 0.71, 0.44])[:dimensions]


def correlation_of_seeds(noises: Sequence[Noise], points: np.ndarray | None = None) -> float:
    """The largest |r| between any two of the noises at the same points."""
    points = places() if points is None else points
    values = np.stack([_normalised(noise(points)) for noise in noises])
    products = np.abs(values @ values.T) / values.shape[1]
    return float(max(products[i, j] for i, j in combinations(range(len(noises)), 2)))


def correlation_at_lags(
    noise: Noise, lags: Sequence[int], points: np.ndarray | None = None
) -> dict[int, float]:
    """For each lag, in cells, the largest |r| with the noise moved by it along an axis or a diagonal."""
    points = places() if points is None else points
    here = _normalised(noise(points))
    found = {}
    for lag in lags:
        ways = [np.array(way) for way in product((0, 1), repeat=points.shape[-1]) if any(way)]
        found[lag] = max(
            abs(float(here @ _normalised(noise(points + way * lag)) / len(here))) for way in ways
        )
    return found


def _normalised(values: np.ndarray) -> np.ndarray:
    values = np.asarray(values, np.float32)
    return (values - values.mean()) / values.std()


def _frequency(power: np.ndarray, per_cell: int) -> tuple[tuple[np.ndarray, ...], np.ndarray]:
    """Frequencies along the axes, as broadcastable arrays, and their length, in cycles per cell."""
    size = len(power)
    full = np.fft.fftfreq(size, 1 / per_cell)
    half = np.fft.rfftfreq(size, 1 / per_cell)
    components = (full[:, None, None], full[:, None], half)
    return components, np.sqrt(sum(c**2 for c in components))
