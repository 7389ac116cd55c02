"""Heights on the CPU: true to the file, without seams, like the file beyond it."""

from __future__ import annotations

import time

import numpy as np
import pytest

import fallstreak as fs
from fallstreak.terrain import spline
from fallstreak.terrain.elevation import read_elevation
from fallstreak.terrain.model import shipped_path, terrain_model
from fallstreak.terrain.pyramid import MAX_LEVELS, SIZE
from fallstreak.world.errors import WorldError


@pytest.fixture(scope="module")
def jacksboro():
    return fs.load("jacksboro")


@pytest.fixture(scope="module")
def model(jacksboro):
    return terrain_model(jacksboro)


def smooth(model, east, north):
    """Heights without the bumps below the elevations' own resolution."""
    return model.shape(east, north, model.land.pyramid.spacing).height


def samples(world, inset):
    """Map positions and heights of the file's own samples, `inset` samples from the border."""
    grid = read_elevation(shipped_path("jacksboro"))
    rows, columns = np.mgrid[inset : grid.heights.shape[0] - inset, inset : grid.heights.shape[1] - inset]
    place = (world.place.latitude, world.place.longitude)
    e, n = grid.map_position(columns.ravel(), rows.ravel(), place, world.planet.radius)
    return e, n, grid.heights[rows, columns].ravel()


def test_heights_go_through_the_file_s_samples(jacksboro, model):
    e, n, heights = samples(jacksboro, 60)
    inside = np.maximum(np.abs(e), np.abs(n)) < 0.75 * SIZE / 2 * model.land.pyramid.spacing
    error = smooth(model, e, n)[inside] - heights[inside]
    assert inside.sum() > 40_000
    assert np.sqrt(np.mean(error**2)) < 0.6
    assert np.abs(error).max() < 8.0


def test_bumps_stay_small_and_mean_nothing(jacksboro, model):
    e, n, _ = samples(jacksboro, 100)
    bumps = model.height(e, n) - smooth(model, e, n)
    assert abs(bumps.mean()) < 0.05 and bumps.std() < 1.5 and np.abs(bumps).max() < 8.0


def test_query_answers_numbers_and_arrays(jacksboro):
    height = jacksboro.terrain.height(0.0, 0.0)
    assert isinstance(height, float) and 236 < height < 1076
    grid = jacksboro.terrain.height(np.linspace(0, 1000, 5)[None, :], np.linspace(0, 1000, 3)[:, None])
    assert grid.shape == (3, 5) and grid.dtype == np.float64 and grid[0, 0] == height
    assert fs.load("orbit").terrain.height(5.0, 6.0) == 0.0


def test_no_step_anywhere_along_the_way_out(model):
    """Across the file's border, joins of levels, the fade into the globe: no slope that the land lacks."""
    for angle in np.linspace(0.0, 2 * np.pi, 7)[:-1]:
        d = np.arange(0.0, 165e3, 10.0)
        h = smooth(model, d * np.cos(angle), d * np.sin(angle))
        assert np.abs(np.diff(h)).max() / 10.0 < 1.2
        # a step would show as a kink: second differences stay like those inside the file
        kink = np.abs(np.diff(h, 2))
        assert kink[d[1:-1] > 12e3].max() < 1.6 * kink[d[1:-1] < 12e3].max() + 0.5


def test_land_beyond_the_file_is_like_the_file(model):
    rng = np.random.default_rng(3)
    far = rng.uniform(-110e3, 110e3, (2, 60_000))
    far = far[:, (np.abs(far).max(0) > 25e3)]
    out = smooth(model, *far)
    file = read_elevation(shipped_path("jacksboro")).heights
    assert abs(out.mean() - file.mean()) < 60.0
    assert out.std() == pytest.approx(file.std(), rel=0.25)
    assert out.min() > 200.0 and out.max() < 1110.0
    # no repetition: the land 31 km further (the file's width) is other land
    a, b = out, smooth(model, far[0] + 31e3, far[1])
    assert abs(np.corrcoef(a, b)[0, 1]) < 0.25


def test_slope_of_the_levels_is_their_derivative(model):
    """`Levels` scales its bumps by it."""
    rng = np.random.default_rng(4)
    e, n = rng.uniform(-60e3, 60e3, (2, 500))
    step = np.full(500, model.land.pyramid.spacing)
    _, de, dn, _ = model.land._form(e, n, step)
    for slope, (x, y) in ((de, (0.5, 0)), (dn, (0, 0.5))):
        numeric = smooth(model, e + x, n + y) - smooth(model, e - x, n - y)
        # mixing levels adds a little that the mixed slopes leave out
        assert np.abs(numeric - slope).max() < 0.02


def test_bounds_hold_every_height(model):
    """At every step; the horizon and the selection rely on it."""
    low, high = model.land.bounds()
    low, high = min(low, model.land.outside), max(high, model.land.outside)
    rng = np.random.default_rng(5)
    e, n = rng.uniform(-158e3, 158e3, (2, 100_000))
    e[:50_000] *= 0.1
    n[:50_000] *= 0.1
    for step in (0.25, 30.0, 200.0, 1500.0):
        h = model.shape(e, n, step).height
        assert low <= h.min() and h.max() <= high
    assert high - low < 2.0 * (h.max() - h.min())  # and are not idle


def test_coarse_samples_are_the_mean_of_fine_ones(model):
    """What a step leaves out has no mean and the slope that `lost` reports."""
    rng = np.random.default_rng(7)
    corner = rng.uniform(-8e3, 8e3, (60, 2))
    for step in (100.0, 200.0, 400.0):
        x = np.linspace(-2.0 * step, 2.0 * step, 33)
        east, north = corner[:, 0, None, None] + x, corner[:, 1, None, None] + x[:, None]
        fine, coarse = model.shape(east, north, step / 8), model.shape(east, north, step)
        assert np.abs((fine.height - coarse.height).mean((1, 2))).mean() < 0.01 * step
        gap = x[1] - x[0]
        square = [
            (np.stack(np.gradient(h, gap, axis=(1, 2))) ** 2).sum(0).mean()
            for h in (fine.height, coarse.height)
        ]
        left = np.sqrt(max(square[0] + (fine.lost**2).mean() - square[1], 0.0))
        assert np.sqrt((coarse.lost**2).mean()) == pytest.approx(left, rel=0.2)


def test_memory_and_time_are_bounded(model):
    assert model.land.pyramid.levels <= MAX_LEVELS and model.land.pyramid.nbytes < 48 * 2**20
    start = time.perf_counter()
    assert terrain_model(fs.load("jacksboro", overrides=["camera.heading=10"])) is model
    assert time.perf_counter() - start < 1.0


@pytest.mark.parametrize(("surroundings", "height"), [("flat", None), ("sea", 0.0)])
def test_other_surroundings(surroundings, height):
    model = terrain_model(fs.load("jacksboro", overrides=[f"terrain.surroundings={surroundings}"]))
    far = smooth(model, np.array([40e3, -90e3, 159e3]), np.array([30e3, 10e3, 0.0]))
    edge = read_elevation(shipped_path("jacksboro")).heights
    expected = edge[[0, -1]].mean() if height is None else height
    assert np.allclose(far, far[0], atol=1e-3) and far[0] == pytest.approx(
        expected, abs=80.0 if height is None else 1e-3
    )


def test_a_map_inside_of_the_file(jacksboro, model):
    small = terrain_model(fs.load("jacksboro", overrides=["terrain.extent=2e3"]))
    e = np.linspace(-1500.0, 1500.0, 50)
    assert small.land.pyramid.levels == 1
    assert np.abs(smooth(small, e, 0.5 * e) - smooth(model, e, 0.5 * e)).max() < 3.0


def test_a_file_far_from_the_place_is_refused():
    with pytest.raises(WorldError, match="set place"):
        terrain_model(fs.load("jacksboro", overrides=["place.latitude=-30.0"]))


@pytest.mark.parametrize("material", ["temperate", "mars"])
def test_fractal_land_follows_seed_and_relief(material):
    def land(seed, relief=800.0):
        world = fs.load(
            "mars" if material == "mars" else "orbit",
            overrides=[
                "terrain.source=fractal",
                f"seed={seed}",
                f"terrain.relief={relief}",
                "terrain.extent=40e3",
                f"terrain.material={material}",
                "terrain.base_height=300.0",
            ],
        )
        e, n = np.meshgrid(np.linspace(-30e3, 30e3, 121), np.linspace(-30e3, 30e3, 121))
        return smooth(terrain_model(world), e, n)

    a = land(1)
    assert np.array_equal(a, land(1)) and np.abs(a - land(2)).mean() > 20.0
    spread = np.percentile(a, 98) - np.percentile(a, 2)
    assert 250.0 < spread < 2500.0 and abs(a.mean() - 300.0) < 500.0


def test_spline_interpolates_and_derives():
    rng = np.random.default_rng(6)
    grid = rng.normal(size=(20, 24))
    c = spline.coefficients(grid)
    j, i = np.meshgrid(np.arange(2, 22), np.arange(2, 18))
    assert np.abs(spline.evaluate(c, j, i) - grid[2:18, 2:22]).max() < 1e-9
    x, y = rng.uniform(3, 15, (2, 100))
    _, dx, dy = spline.evaluate_with_slopes(c, x, y)
    assert (
        np.abs((spline.evaluate(c, x + 1e-5, y) - spline.evaluate(c, x - 1e-5, y)) / 2e-5 - dx).max() < 1e-6
    )
    assert (
        np.abs((spline.evaluate(c, x, y + 1e-5) - spline.evaluate(c, x, y - 1e-5)) / 2e-5 - dy).max() < 1e-6
    )
    wave = np.tile(np.sin(np.arange(200) * 0.02), (200, 1))
    assert np.abs(spline.blur(wave, 5.0) - wave)[:, 50:150].max() < 0.01
