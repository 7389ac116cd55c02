"""The driver: sources of points, threads, the change to float64 far away."""

import os
import signal

import numpy as np
import pytest

from fallstreak import noise
from fallstreak.noise import hashing, sources, tiles


def _fbm(points, count, **options):
    out = np.empty(count, np.float32)
    tiles.fbm(points, out, kind="perlin", octaves=3, **options)
    return out


@pytest.mark.parametrize("count", [1, 255, 256, 257, 1000])
def test_tiles_that_are_not_full(count):
    points = np.random.default_rng(0).uniform(-9, 9, (1000, 3)).astype(np.float32)
    np.testing.assert_array_equal(
        _fbm([points[:count, d] for d in range(3)], count),
        _fbm([points[:, d] for d in range(3)], 1000)[:count],
    )


def test_threads_give_the_same_and_each_point_once():
    axes = list(np.random.default_rng(0).uniform(-9, 9, (3, 50_001)).astype(np.float32))
    np.testing.assert_array_equal(_fbm(axes, 50_001, threads=7), _fbm(axes, 50_001))


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork here")
@pytest.mark.filterwarnings("ignore:This process:DeprecationWarning")
def test_a_forked_process_has_threads_of_its_own():
    axes = list(np.random.default_rng(0).uniform(-9, 9, (3, 50_000)).astype(np.float32))
    _fbm(axes, 50_000, threads=4)
    child = os.fork()
    if child == 0:
        signal.alarm(20)  # rather than wait for ever for threads that are not there
        _fbm(axes, 50_000, threads=4)
        os._exit(0)
    assert os.waitpid(child, 0)[1] == 0


def test_far_away_float32_points_are_placed_in_float64():
    near = np.random.default_rng(0).uniform(-9, 9, (500, 3)).astype(np.float32)
    far = near.copy()
    far[7, 1] = 3e7  # one such point sends all of them the other way
    expected = _fbm(list(far.astype(np.float64).T), 500)
    np.testing.assert_array_equal(_fbm(list(far.T), 500), expected)
    np.testing.assert_allclose(np.delete(expected, 7), np.delete(_fbm(list(near.T), 500), 7), atol=5e-7)


def test_grids_are_float32_where_that_loses_nothing():
    assert not sources.grid((5, 8), (0.0, 1e3), (1 / 64, 0.25)).double
    assert sources.grid((5, 8), (0.0, 1e3), (1 / 60, 0.25)).double


def test_the_plain_integers_are_what_the_loops_compute():
    """At a lattice point's neighbour along x, Perlin noise is the gradient there times the way, faded out."""
    from fallstreak.noise.directions import EDGES3

    words, cell, step = hashing.axis_words(9, 0), (5, -3, 70_000), 2.0**-9
    x, y, z = EDGES3[hashing.index(*hashing.corner(cell, words), 16)]
    for axis, slope in enumerate((x, y, z)):
        point = np.array(cell, np.float64)
        point[axis] += step
        assert noise.sample(point[None], seed=9)[0] == pytest.approx(slope * step, abs=20 * step**3)
