"""Gradient noise: its scale, its derivatives, its independence of seed and place."""

from __future__ import annotations

import numpy as np

from fallstreak.noise.gradient import fbm, gradient_noise, gradient_value, hash_lattice


def points(count=200_000, seed=0):
    return np.random.default_rng(seed).uniform(-1e5, 1e5, (2, count))


def test_mean_and_spread_are_as_documented():
    value = gradient_value(*points())
    assert abs(value.mean()) < 2e-3 and abs(value.std() - 0.25) < 3e-3 and np.abs(value).max() < 1.25


def test_value_alone_is_the_same_value():
    x, y = points(1000)
    assert np.allclose(gradient_noise(x, y, 7)[0], gradient_value(x, y, 7), atol=1e-12)


def test_derivatives_against_finite_differences():
    x, y = points(2000, 1)
    _, dx, dy = gradient_noise(x, y, 3)
    e = 1e-4
    for slope, (a, b) in ((dx, (e, 0)), (dy, (0, e))):
        numeric = (gradient_value(x + a, y + b, 3) - gradient_value(x - a, y - b, 3)) / (2 * e)
        assert np.abs(numeric - slope).max() < 1e-5


def test_seeds_and_far_places_do_not_correlate():
    x, y = points(100_000, 2)
    a = gradient_value(x, y, 1)
    for other in (gradient_value(x, y, 2), gradient_value(x, y, 2**31), gradient_value(x + 256, y, 1)):
        assert abs(np.corrcoef(a, other)[0, 1]) < 0.01


def test_zero_on_the_lattice_and_continuous_across_it():
    i, j = np.meshgrid(np.arange(-5, 5.0), np.arange(-5, 5.0))
    assert np.abs(gradient_value(i, j, 4)).max() == 0.0
    assert np.abs(gradient_value(i - 1e-9, j + 0.3, 4) - gradient_value(i + 1e-9, j + 0.3, 4)).max() < 1e-7


def test_hash_is_a_uint32_of_the_place_modulo_its_range():
    h = hash_lattice(np.arange(1000), np.zeros(1000, int), 0)
    assert h.dtype == np.uint32 and len(np.unique(h)) == 1000
    assert hash_lattice(np.array([-1]), np.array([2]), 5) == hash_lattice(
        np.array([2**32 - 1]), np.array([2]), 5
    )


def test_fbm_adds_octaves():
    x, y = points(1000, 3)
    assert np.allclose(fbm(x, y, 1, seed=9), 0.5 * gradient_value(x, y, 9))
    assert fbm(x, y, 5).std() > 0.1
