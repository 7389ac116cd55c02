"""What `world.clouds` answers, and extinction of blobs."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta

import numpy as np
import pytest

import fallstreak as fs
from fallstreak.clouds.field import field_of
from fallstreak.clouds.field.mean import mean_extinction, seen_through

from .stage import Stage

SKY = fs.World(
    time=datetime(2025, 6, 1, 12, tzinfo=UTC),
    clouds={"layers": [{"genus": "cumulus_mediocris", "coverage": 0.5}, {"genus": "cirrus"}]},
)


def in_cloud(count=400, time=0.0):
    """Places within clouds of the first layer."""
    random = np.random.default_rng(2)
    points = np.column_stack([random.uniform(-2e4, 2e4, (6000, 2)), random.uniform(1000, 2000, 6000)])
    points = points[SKY.clouds.inside(points, time)]
    assert len(points) >= count
    return points[:count]


def test_shapes_are_those_of_the_places():
    assert SKY.clouds.extinction([0.0, 0.0, 1500.0]).shape == ()
    assert SKY.clouds.extinction(np.zeros((4, 5, 3))).shape == (4, 5)
    assert SKY.clouds.inside(np.zeros((0, 3))).shape == (0,)
    assert SKY.clouds.optical_depth(np.zeros((7, 3)), [0.0, 0.0, 3000.0]).shape == (7,)
    assert SKY.clouds.inside([0.0, 0.0, 0.0]).dtype == bool


def test_time_is_seconds_or_a_moment():
    points = in_cloud()
    later = SKY.time + timedelta(seconds=300.0)
    np.testing.assert_array_equal(SKY.clouds.extinction(points, later), SKY.clouds.extinction(points, 300.0))
    assert np.abs(SKY.clouds.extinction(points, 300.0) - SKY.clouds.extinction(points)).max() > 0.01


def test_inside_is_where_there_is_cloud():
    points = in_cloud()
    assert SKY.clouds.extinction(points).min() > 0.005
    assert not SKY.clouds.inside(points * [1.0, 1.0, 0.0]).any()  # on the ground


def test_optical_depth_is_the_integral():
    points = in_cloud(60)
    low, high = points * [1, 1, 0] + [0, 0, 900.0], points * [1, 1, 0] + [0, 0, 2700.0]
    heights = np.linspace(900.0, 2700.0, 1801)
    line = np.repeat(low, len(heights), 0)
    line[:, 2] = np.tile(heights, len(low))
    fine = SKY.clouds.extinction(line).reshape(len(low), -1)
    want = (0.5 * (fine[:, 1:] + fine[:, :-1])).sum(1)
    found = SKY.clouds.optical_depth(low, high)
    assert np.abs(found - want).mean() < 0.02 * want.mean()
    np.testing.assert_allclose(SKY.clouds.optical_depth(high, low), found, rtol=1e-6)
    np.testing.assert_allclose(found, want, rtol=0.15, atol=0.5)


def test_lines_of_all_kinds_are_followed():
    points = in_cloud(20)
    along = points + np.array([3000.0, 0.0, 0.0])
    whole = SKY.clouds.optical_depth(points, along)
    middle = 0.5 * (points + along)
    halves = SKY.clouds.optical_depth(points, middle) + SKY.clouds.optical_depth(middle, along)
    np.testing.assert_allclose(whole, halves, rtol=0.08, atol=0.3)
    assert SKY.clouds.optical_depth(points, points).max() == 0.0
    assert SKY.clouds.optical_depth([0, 0, 0], [5e4, 0, 0]) == 0.0


def test_no_layers_no_clouds():
    sky = fs.World()
    assert sky.clouds.extinction([[0.0, 0.0, 1000.0]]) == 0.0
    assert not sky.clouds.inside([0.0, 0.0, 1000.0])
    assert sky.clouds.optical_depth([0, 0, 0], [0, 0, 1e4]) == 0.0


@pytest.mark.parametrize(
    ("points", "time", "told"),
    [
        (np.zeros(2), 0.0, "places must be"),
        (5.0, 0.0, "places must be"),
        ([0.0, np.nan, 0.0], 0.0, "finite"),
        ([0.0, 0.0, 0.0], np.inf, "time must be finite"),
        ([0.0, 0.0, 0.0], datetime(2025, 1, 1), "has no zone"),
    ],
)
def test_wrong_questions_are_told(points, time, told):
    with pytest.raises(ValueError, match=told):
        SKY.clouds.extinction(points, time)


# ---- blobs -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("genus", ["cumulus_mediocris", "stratocumulus", "cirrus"])
def test_a_blob_lets_through_what_its_clouds_let_through(genus):
    """Mean transmittance of upright lines through blobs of all sizes: bias below .05."""
    field = field_of(fs.World(clouds={"layers": [{"genus": genus, "coverage": 0.4}]}))
    low, high = field.layers[0].bounds
    random = np.random.default_rng(4)
    for size in (30.0, 150.0, 600.0, 2500.0, 10e3):
        places = np.column_stack([random.uniform(-5e4, 5e4, (300, 2)), random.uniform(low, high, 300)])
        want = seen_through(field, places, size, 6, 10, random)
        found = np.exp(-mean_extinction(field, places, size, 0.0) * size)
        assert np.mean(found - want) == pytest.approx(0.0, abs=0.05), size


def test_the_shaders_give_the_blobs_of_the_twin(device):
    """Transmittance within .01."""
    stage = Stage(device, SKY)
    points = np.column_stack(
        [
            np.random.default_rng(3).uniform(-8e3, 8e3, (2000, 2)),
            np.random.default_rng(4).uniform(900.0, 10e3, 2000),
        ]
    )
    for size in (10.0, 100.0, 300.0, 800.0, 2000.0, 1e4, 1e5, 1e6):
        found = stage.look(0.0, 0.0, 50.0, points, size)[1][:, 1]
        want = mean_extinction(stage.field, points, size, 50.0)
        assert want.max() > 0.0
        np.testing.assert_allclose(np.exp(-found * size), np.exp(-want * size), atol=0.012)


def test_blobs_far_outside_of_the_window_are_still_there(device):
    stage = Stage(device, SKY)
    points = np.array([[8e5, 2e5, 1400.0], [-1e6, 0.0, 1400.0]])
    found = stage.look(0.0, 0.0, 50.0, points, 1e5)[1][:, 1]
    assert (found > 1e-6).all()


def test_blobs_change_steadily_with_size():
    field = field_of(SKY)
    point = in_cloud(1)
    sizes = np.geomspace(1.0, 1e6, 400)
    through = np.array([np.exp(-mean_extinction(field, point, s, 0.0)[0] * s) for s in sizes])
    assert np.abs(np.diff(through)).max() < 0.12
