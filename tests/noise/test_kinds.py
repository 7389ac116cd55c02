"""Every kind against the float64 reference: values, periods, far from the origin, special points."""

import numpy as np
import pytest

from fallstreak import noise
from fallstreak.noise.kinds import KINDS

from . import reference
from .reference import scattered

EVERY = [(kind.name, d) for kind in KINDS.values() for d in kind.dimensions]
PERIODIC = [(kind.name, d) for kind in KINDS.values() for d in kind.periodic]


@pytest.mark.parametrize(("kind", "dimensions"), EVERY)
def test_equals_the_reference(kind, dimensions):
    points = scattered(dimensions)
    expected = reference.sample(points, kind, seed=7)
    assert np.abs(noise.sample(points, kind, seed=7) - expected).max() <= 1e-6


@pytest.mark.parametrize(("kind", "dimensions"), EVERY)
def test_single_precision_points_equal_the_reference(kind, dimensions):
    points = scattered(dimensions).astype(np.float32)
    expected = reference.sample(points, kind, seed=8)
    assert np.abs(noise.sample(points, kind, seed=8) - expected).max() <= 1e-6


@pytest.mark.parametrize(("kind", "dimensions"), PERIODIC)
def test_periodic_variants_equal_the_reference(kind, dimensions):
    points = scattered(dimensions, 2000)
    period = (5, 4, 3, 7)[:dimensions]
    expected = reference.sample(points, kind, seed=9, period=period)
    assert np.abs(noise.sample(points, kind, seed=9, period=period) - expected).max() <= 1e-6


@pytest.mark.parametrize(("kind", "dimensions"), PERIODIC)
def test_periodic_variants_repeat_exactly(kind, dimensions):
    points = np.round(scattered(dimensions, 2000) * 64) / 64  # so that adding a period loses nothing
    period = (5, 4, 3, 7)[:dimensions]
    here = noise.sample(points, kind, period=period)
    for axis in range(dimensions):
        moved = points.copy()
        moved[:, axis] += 3 * period[axis]
        assert np.array_equal(noise.sample(moved, kind, period=period), here)


@pytest.mark.parametrize(("kind", "dimensions"), EVERY)
def test_ten_thousand_kilometres_away_there_are_no_steps(kind, dimensions):
    ticks = np.arange(4096) / 512
    points = 1e7 + np.stack([ticks * (0.37 + d) for d in range(dimensions)], -1)
    strip = noise.sample(points, kind)
    assert np.abs(strip - reference.sample(points, kind)).max() <= 1e-6
    # a step would stand out among the differences of neighbours
    jumps = np.abs(np.diff(strip))
    assert jumps.max() < 0.05
    assert (jumps == 0).mean() < 0.01


@pytest.mark.parametrize(("kind", "dimensions"), EVERY)
def test_values_stay_in_the_range_that_is_promised(kind, dimensions):
    values = noise.sample(scattered(dimensions, 200_000), kind)
    low, high = KINDS[kind].low, KINDS[kind].high
    width = high - low
    assert np.isfinite(values).all()
    assert np.mean((values < low) | (values > high)) < 0.01
    assert np.ptp(values) > 0.55 * width


def test_improved_noise_is_ken_perlins():
    """The value that his Java program prints for this point, known from many ports."""
    point = np.array([[3.14, 42.0, 7.0]])
    assert noise.sample(point, "improved")[0] == pytest.approx(0.13691995878400012, abs=1e-6)


def test_gradient_kinds_are_zero_on_the_lattice():
    points = np.stack(np.meshgrid(*[np.arange(-3.0, 4.0)] * 3), -1)
    for kind in ("perlin", "improved"):
        assert not noise.sample(points, kind).any()


def test_cellular_finds_points_two_cells_away():
    """Three cells along an axis do not hold all nearest points; the package must not settle for them."""
    points = scattered(2, 100_000)
    first, second = (noise.sample(points, kind) for kind in ("cellular_f1", "cellular_f2"))
    narrow = narrow_cellular(points)
    assert (narrow[1] > second + 1e-5).any()  # else this test says nothing
    expected = reference.cellular(points, reference.axis_words(0, 0))
    assert np.abs(first - expected[0]).max() <= 1e-6
    assert np.abs(second - expected[1]).max() <= 1e-6


def narrow_cellular(points):
    """First and second distance as most libraries have them: 3 × 3 cells."""
    fraction, at = reference.lattice(points, None)
    ways = []
    for offset in np.ndindex(3, 3):
        offset = np.array(offset) - 1
        feature = reference.feature_point(at(offset), reference.axis_words(0, 0))
        ways.append(np.linalg.norm(feature + offset - fraction, axis=-1))
    return np.sort(ways, axis=0)[:2]
