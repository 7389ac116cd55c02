"""How far the camera is from the ground: what the level of detail goes by."""

from __future__ import annotations

import numpy as np
import pytest

import fallstreak as fs
from fallstreak.terrain.land.shape import NO_WATER, LandShape
from fallstreak.terrain.model import TerrainModel, terrain_model
from fallstreak.terrain.near import NearGround


class Wall:
    """300 m high at east = 0, level on either side."""

    outside, shift_bound = 0.0, 0.0

    def bounds(self):
        return 0.0, 300.0

    def shape(self, east, north, step) -> LandShape:
        e, _, _ = np.broadcast_arrays(east, north, step)
        zero = np.zeros(e.shape)
        return LandShape(np.where(e < 0.0, 300.0, 0.0), zero + NO_WATER, zero, zero, zero, zero + 1.0)


def test_level_ground_is_as_far_as_it_is_low():
    lake = NearGround(terrain_model(fs.load("jacksboro", ["terrain.water_level=380"])))
    for above in (1.0, 50.0, 400.0):
        assert lake.distance(16_500.0, -12_250.0, 380.0 + above) == pytest.approx(above)
    assert lake.distance(16_500.0, -12_250.0, 370.0) == 0.0


def test_a_wall_beside_counts():
    wall = NearGround(TerrainModel(Wall(), 6.371e6, 1e5))  # type: ignore[arg-type]
    # between samples at -16 m and 0 its edge is 5.3 m back where it is 100 m high
    assert wall.distance(10.0, 0.0, 100.0) == pytest.approx(15.3, abs=0.5)
    assert wall.distance(120.0, 0.0, 100.0) == 100.0
    assert wall.distance(-50.0, 0.0, 304.0) == pytest.approx(4.0)


def test_it_depends_on_the_place_alone_and_never_jumps():
    model = terrain_model(fs.load("jacksboro"))
    path = np.arange(0.0, 900.0, 0.25)
    ground = float(np.max(model.height(path, 0.3 * path)))
    there, back = NearGround(model), NearGround(model)
    out = [there.distance(x, 0.3 * x, ground + 20.0) for x in path]
    assert [back.distance(x, 0.3 * x, ground + 20.0) for x in path[::-1]] == out[::-1]
    assert np.abs(np.diff(out)).max() < 1.0 and np.ptp(out) > 20.0
