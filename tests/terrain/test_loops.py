"""The compiled loops and NumPy find the same numbers."""

import numpy as np
import pytest

from fallstreak.terrain import loops, pyramid, spline
from fallstreak.terrain.elevation.tiff_codecs import _undo

SHAPES = ((4, 5), (17, 300), (130, 96))


@pytest.fixture
def both(monkeypatch):
    """A function's results by NumPy and by the loops."""

    def run(function, *arguments):
        out = []
        for module in (None, loops):
            for room in ("spline", "pyramid", "elevation.tiff_codecs"):
                monkeypatch.setattr(f"fallstreak.terrain.{room}.loops", lambda module=module: module)
            out.append(function(*arguments))
        return out

    return run


@pytest.mark.parametrize("shape", SHAPES)
def test_filters_and_means(both, shape):
    samples = np.random.default_rng(1).normal(800.0, 300.0, shape)
    for slow, quick in (both(spline.coefficients, samples), both(spline.blur, samples, 4.0)):
        np.testing.assert_allclose(quick, slow, rtol=1e-14)
    slow, quick = both(pyramid._slope_square, samples, 30.0)
    np.testing.assert_allclose(quick, slow, rtol=1e-14)


@pytest.mark.parametrize("shape", SHAPES)
def test_splines_also_beyond_the_edge(both, shape):
    rng = np.random.default_rng(2)
    grid = rng.normal(size=shape).astype(np.float32)
    column, row = (rng.uniform(-9.0, n + 9.0, (20, 30)) for n in reversed(shape))
    column[0, 0], row[0, 1] = 1e18, -1e18
    slow, quick = both(spline.evaluate, grid, column, row)
    np.testing.assert_array_equal(quick, slow)


@pytest.mark.parametrize("dtype", ["<i2", ">i2", "<u2", "<i4"])
def test_horizontal_predictor(both, dtype):
    packed = np.random.default_rng(3).integers(0, 256, (13, 64), np.uint8)
    slow, quick = both(_undo, packed, np.dtype(dtype), 2)
    assert quick.dtype == slow.dtype
    np.testing.assert_array_equal(quick, slow)


def test_halves_are_means_of_four():
    values = np.arange(35.0).reshape(5, 7)
    expected = values[:4, :6].reshape(2, 2, 3, 2).mean((1, 3))
    np.testing.assert_allclose(spline.halved(values), expected)
