"""The highest ground over single places, which a camera in flight asks for in every frame."""

from __future__ import annotations

import numpy as np
import pytest

import fallstreak as fs
from fallstreak.terrain.above import CARRIED, Above, _Quads
from fallstreak.terrain.model import terrain_model

MIDDLE, HALF = (3025.0, 582.0), 60.0  # of the scene's gorge: floor, talus, walls that lean over


@pytest.fixture(scope="module")
def canyon():
    return fs.load("canyon")


@pytest.fixture(scope="module")
def places():
    return np.array(MIDDLE)[:, None] + np.random.default_rng(1).uniform(-HALF, HALF, (2, 60))


def test_heights_are_those_of_fine_samples(canyon, places):
    model, step = terrain_model(canyon), 0.5
    east, north = ((round((x - HALF - 60.0) / step), round((x + HALF + 60.0) / step)) for x in MIDDLE)
    land = _Quads(model, east, north, step, CARRIED)
    expected = np.array([land.highest(*place)[0] for place in places.T])  # type: ignore[index]
    found = np.array([canyon.terrain.height(*place) for place in places.T])
    error = np.abs(found - expected)
    assert np.ptp(expected) > 80.0
    assert np.median(error) < 0.02 and np.quantile(error, 0.9) < 0.2
    # many at once are asked by rays
    together = canyon.terrain.height(*places)
    assert np.median(np.abs(found - together)) < 0.02 and np.quantile(np.abs(found - together), 0.8) < 0.2


def test_a_height_depends_on_the_place_alone(canyon, places):
    there, back = (Above(terrain_model(canyon)) for _ in range(2))
    heights = [there.height(*place) for place in places.T[:25]]
    assert [back.height(*place) for place in places.T[:25][::-1]] == heights[::-1]


def test_beyond_the_land_the_globe_is_the_height(canyon):
    model = terrain_model(canyon)
    assert model.land is not None and Above(model).height(1.2 * model.extent, 0.0) is None
    assert canyon.terrain.height(1.2 * model.extent, 0.0) == pytest.approx(model.land.outside, abs=1e-3)
