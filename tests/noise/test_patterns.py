"""Noise in the scale that land and sky are made in, and random numbers of places."""

from __future__ import annotations

import subprocess
import sys

import numpy as np

from fallstreak import noise
from fallstreak.noise import patterns
from fallstreak.noise.scatter import hash_lattice


def points(count=200_000, seed=0):
    return np.random.default_rng(seed).uniform(-1e5, 1e5, (2, count))


def test_mean_and_spread_are_as_documented():
    value = patterns.value(*points(), 5)
    assert abs(value.mean()) < 2e-3 and abs(value.std() - 0.25) < 3e-3 and np.abs(value).max() < 0.77


def test_value_alone_is_the_same_value():
    x, y = points(1000)
    assert np.allclose(patterns.slope(x, y, 7)[0], patterns.value(x, y, 7), atol=1e-12)


def test_it_is_perlin_noise():
    found = noise.sample(tuple(points(1000)), seed=7, threads=1)
    assert np.abs(patterns.value(*points(1000), 7) - patterns.SCALE * found).max() < 1e-6


def test_rendering_does_not_wait_for_numba():
    """Numba takes half a second to import and seconds to compile."""
    code = "import sys; import fallstreak.frame.renderer, fallstreak.noise; assert 'numba' not in sys.modules"
    subprocess.run([sys.executable, "-c", code], check=True)


def test_derivatives_against_finite_differences():
    x, y = points(2000, 1)
    _, dx, dy = patterns.slope(x, y, 3)
    e = 1e-3
    for slope, (a, b) in ((dx, (e, 0)), (dy, (0, e))):
        numeric = (patterns.value(x + a, y + b, 3) - patterns.value(x - a, y - b, 3)) / (2 * e)
        assert np.abs(numeric - slope).max() < 2e-3


def test_any_seed_and_shape_will_do():
    x, y = np.meshgrid(np.arange(3) + 0.5, np.arange(2) + 0.25)
    assert patterns.value(x, y[:, :1], -1).shape == (2, 3)
    assert np.array_equal(patterns.value(x, y, -1), patterns.value(x, y, 2**32 - 1))
    assert patterns.value(0.5, 0.5, 1).shape == ()


def test_one_place_gives_what_it_gives_among_many():
    x, y = points(200)
    among = np.array(patterns.slope(x, y, 9))
    alone = np.array([patterns.slope(float(a), b, 9) for a, b in zip(x, y, strict=True)]).T
    assert np.abs(among - alone).max() < 1e-14
    assert np.isnan(patterns.value(np.nan, 0.0, 1))


def test_hash_is_a_uint32_of_the_place_modulo_its_range():
    h = hash_lattice(np.arange(1000), np.zeros(1000, int), 0)
    assert h.dtype == np.uint32 and len(np.unique(h)) == 1000
    assert hash_lattice(np.array([-1]), np.array([2]), 5) == hash_lattice(
        np.array([2**32 - 1]), np.array([2]), 5
    )
