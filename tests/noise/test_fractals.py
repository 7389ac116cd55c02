"""Sums of octaves, derivatives and curl against the reference."""

import numpy as np
import pytest

from fallstreak import noise
from fallstreak.noise.kinds import FRACTALS

from . import reference
from .reference import scattered


@pytest.mark.parametrize("fractal", FRACTALS)
def test_fractals_equal_the_reference(fractal):
    points = scattered(3, 2000)
    settings = {"seed": 3, "gain": 0.6, "lacunarity": 2.5, "frequency": 0.7}
    expected = reference.fbm(points, 6, fractal=fractal, **settings)
    found = noise.fbm(points, 6, fractal=fractal, **settings)
    assert np.abs(found - expected).max() <= 2e-6


@pytest.mark.parametrize("fractal", FRACTALS)
def test_fractals_repeat_exactly(fractal):
    points = np.round(scattered(3, 2000) * 64) / 64
    moved = points + np.array([4, -6, 10])
    here = noise.fbm(points, 5, fractal=fractal, period=(4, 3, 5))
    assert np.array_equal(noise.fbm(moved, 5, fractal=fractal, period=(4, 3, 5)), here)
    expected = reference.fbm(points, 5, fractal=fractal, period=(4, 3, 5))
    assert np.abs(here - expected).max() <= 2e-6


@pytest.mark.parametrize("fractal", FRACTALS)
def test_octaves_too_fine_for_the_samples_fade(fractal):
    points = scattered(3, 2000)
    settings = {"fractal": fractal, "frequency": 1.3}
    expected = reference.fbm(points, 8, spacing=1 / 40, **settings)
    found = noise.fbm(points, 8, spacing=1 / 40, **settings)
    assert np.abs(found - expected).max() <= 2e-6
    assert np.abs(found - noise.fbm(points, 8, **settings)).max() > 1e-3
    # so many octaves are dropped that more of them change nothing but the divisor
    more = noise.fbm(points, 12, spacing=1 / 40, **settings)
    assert more * (2 - 0.5**11) == pytest.approx(found * (2 - 0.5**7), abs=2e-6)


def test_a_spacing_that_drops_everything_gives_zero():
    assert not noise.fbm(scattered(3, 100), 4, spacing=10.0).any()


def test_a_fade_has_no_step():
    """From 2 samples a wavelength to 4 an octave comes in smoothly."""
    points = scattered(3, 200)
    before = None
    for spacing in 2.0 ** np.linspace(-2.2, -0.8, 60):
        now = noise.fbm(points, 1, spacing=float(spacing))
        assert before is None or np.abs(now - before).max() < 0.06
        before = now


def test_warp_equals_the_reference():
    points = scattered(3, 2000)
    expected = reference.warp(points, 0.8, 4, seed=2)
    assert np.abs(noise.warp(points, 0.8, 4, seed=2) - expected).max() <= 1e-5
    assert np.array_equal(noise.warp(points, 0.0, 4, seed=2), noise.fbm(points, 4, seed=2))


def test_other_kinds_make_fractals_too():
    points = scattered(3, 1000)
    for kind in ("cellular_f1", "value"):
        expected = reference.fbm(points, 4, kind=kind)
        assert np.abs(noise.fbm(points, 4, kind=kind) - expected).max() <= 2e-6


def test_twelve_octaves_far_away_equal_the_reference():
    points = 1e7 + np.stack([np.arange(2000) / 512 * way for way in (1.0, 0.3, -2.0)], -1)
    assert np.abs(noise.fbm(points, 12) - reference.fbm(points, 12)).max() <= 2e-6


@pytest.mark.parametrize("kind", ["perlin", "simplex"])
@pytest.mark.parametrize("dimensions", [2, 3, 4])
def test_derivatives_are_those_of_the_value(kind, dimensions):
    points = scattered(dimensions, 2000)
    value, slope = noise.gradient(points, kind, seed=5, frequency=1.5)
    assert np.abs(value - noise.sample(points, kind, seed=5, frequency=1.5)).max() <= 1e-6
    expected = reference.differences(lambda p: reference.sample(p, kind, seed=5, frequency=1.5), points)
    assert np.abs(slope - expected).max() <= 2e-5


def test_derivatives_of_octaves_and_of_periods():
    points = scattered(3, 1000)
    settings = {"octaves": 4, "seed": 2, "period": (3, 4, 5)}
    value, slope = noise.gradient(points, **settings)
    assert np.abs(value - reference.fbm(points, **settings)).max() <= 2e-6
    expected = reference.differences(lambda p: reference.fbm(p, **settings), points, 1e-5)
    assert np.abs(slope - expected).max() <= 5e-5


@pytest.mark.parametrize("dimensions", [2, 3])
def test_curl_is_the_curl_of_its_potential(dimensions):
    points = scattered(dimensions, 1000)
    settings = {"octaves": 3, "seed": 4, "frequency": 0.8}
    expected = reference.curl(points, step=2e-5, **settings)
    assert np.abs(noise.curl(points, **settings) - expected).max() <= 5e-5


@pytest.mark.parametrize("dimensions", [2, 3])
def test_a_curl_has_no_sources(dimensions):
    rng = np.random.default_rng(6)
    # inside the cells: across their faces the third derivative jumps, and differences see that
    points = rng.integers(-50, 50, (4000, dimensions)) + rng.uniform(0.1, 0.9, (4000, dimensions))
    slopes = np.stack(
        [reference.differences(lambda p, d=d: noise.curl(p)[..., d], points, 0.02) for d in range(dimensions)]
    )
    divergence = sum(slopes[d, :, d] for d in range(dimensions))
    magnitude = np.sqrt((slopes**2).sum((0, 2)).mean())
    assert np.sqrt((divergence**2).mean()) <= 1e-3 * magnitude
    assert np.abs(divergence).max() <= 1e-2 * magnitude


def test_curl_repeats_exactly():
    points = np.round(scattered(3, 1000) * 64) / 64
    here = noise.curl(points, octaves=3, period=4)
    assert np.array_equal(noise.curl(points + np.array([4, -8, 12]), octaves=3, period=4), here)


def test_fractals_sit_where_their_range_says():
    points = scattered(3, 50_000)
    for name, fractal in FRACTALS.items():
        values = noise.fbm(points, 6, fractal=name)
        assert np.mean((values < fractal.low) | (values > fractal.high)) < 0.01, name
