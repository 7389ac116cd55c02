"""Simplex noise with a period: another lattice, which must be as smooth and as random as the classic one.

That it equals the reference and repeats exactly is in test_kinds.py, and in test_wesl.py for the GPU.
"""

import numpy as np
import pytest

from fallstreak import noise
from fallstreak.noise import quality

from . import reference

PERIODS = {2: (5, 4), 3: (5, 3, 4)}


@pytest.mark.parametrize("dimensions", [2, 3])
def test_derivatives_are_those_of_the_reference(dimensions):
    points, period = reference.scattered(dimensions, 2000), PERIODS[dimensions]
    value, slopes = noise.gradient(points, "simplex", octaves=2, seed=3, frequency=0.5, period=period)

    def expected(p):
        return reference.fbm(p, 2, "simplex", seed=3, frequency=0.5, period=period)

    assert np.abs(value - expected(points)).max() <= 1e-6
    assert np.abs(slopes - reference.differences(expected, points)).max() <= 1e-5


@pytest.mark.parametrize("dimensions", [2, 3])
def test_value_and_slope_are_continuous_over_borders(dimensions):
    """Between two sides of the faces of cells and, where sums of coordinates are whole, of simplices."""
    points = np.random.default_rng(5).uniform(-9, 9, (20_000, dimensions))
    borders = points[:16_000].copy()
    first, second, third, fourth = np.split(borders, 4)
    first[:, 0] = np.round(first[:, 0])
    second[:, 1] = np.round(second[:, 1])
    third[:, 0] += np.round(third.sum(1)) - third.sum(1)
    fourth[:, 0] = np.round(fourth[:, 0] + fourth[:, 1] / 2) - fourth[:, 1] / 2

    def jumps(places):
        way = np.array([3e-5, 2e-5, 1e-5])[:dimensions]
        here, there = (
            noise.gradient(places + s * way, "simplex", period=PERIODS[dimensions]) for s in (-1, 1)
        )
        expected = (here[1] + there[1]) @ way  # what the slopes promise
        return np.abs(there[0] - here[0] - expected).max(), np.abs(there[1] - here[1]).max()

    (value, slope), (_, usual) = jumps(borders), jumps(points[16_000:])
    assert value <= 1e-6
    assert slope <= 1.3 * usual <= 0.01


def test_a_lattice_of_any_size_repeats():
    p = np.random.default_rng(2).integers(-512, 512, (500, 3)) / 64
    for period in ((1, 2, 1), (2**31 - 1, 2**31 - 2, 5)):
        assert np.array_equal(
            noise.sample(p + period, "simplex", period=period), noise.sample(p, "simplex", period=period)
        )


@pytest.mark.parametrize("dimensions", [2, 3])
def test_seeds_are_independent_and_nothing_comes_again(dimensions):
    def octave(seed):
        return lambda points: noise.sample(points, "simplex", seed=seed, period=2**20)

    points = quality.places(2**18, dimensions)
    assert quality.correlation_of_seeds([octave(seed) for seed in range(16)], points) <= 0.012
    assert max(quality.correlation_at_lags(octave(0), [4, 64, 1024], points).values()) <= 0.012


def test_spectrum_is_that_of_the_classic_lattice():
    found, classic = (
        quality.measure(
            [
                lambda p, s=s, period=period: noise.sample(p, "simplex", seed=s, period=period)
                for s in range(2)
            ],
            96,
        )
        for period in (2**20, None)
    )
    assert found.low_energy == pytest.approx(classic.low_energy, abs=0.005) and found.low_energy <= 0.015
    assert found.lattice_extrema <= 0.03


@pytest.mark.parametrize(
    ("dimensions", "period", "words"),
    [
        (2, 5, "period=5 .*simplex.* in 2 dimensions: along y it must be even"),
        (2, (4, 3), r"period=\(4, 3\) .* along y it must be even"),
        (4, 4, "period=4 .*simplex.* in 4 dimensions: there only perlin repeats"),
    ],
)
def test_periods_that_it_has_not(dimensions, period, words):
    with pytest.raises(ValueError, match=words):
        noise.sample(np.zeros((3, dimensions)), "simplex", period=period)
