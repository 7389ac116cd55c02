"""Crowns: what comes through them, and that nothing else lets it through."""

from __future__ import annotations

import numpy as np
import pytest
from shadow_stage import Stage

import fallstreak as fs

SIZE = (160, 90)
EDGE = {  # of a wood, its crowns in sight
    "time": "2025-10-18T15:00:00-04:00",
    "camera": {"east": -821.0, "north": -7385.0, "height": 25.0, "heading": 60.0, "pitch": -25.0},
    "shadows.contact": 0.0,
    "clouds.layers": [],
}


def light_of(device, models=()):
    """Share of the sun's light within 100 m of the camera, its way, and the camera."""
    stage = Stage(device, fs.load("jacksboro").updated(EDGE | {"models": list(models)}), SIZE)
    camera = stage.camera()
    picture, _ = stage.render(camera)
    return picture.light[picture.along < 100.0], stage.key, stage.pose()


@pytest.fixture(scope="module")
def bare(device):
    return light_of(device)


def test_leaves_in_the_shade_of_crowns_have_a_little_of_the_sun(bare):
    light, *_ = bare
    assert len(light) > 5000
    assert (np.abs(light - 0.15) < 0.01).mean() > 0.02
    assert (light > 0.9).mean() > 0.2


def test_nothing_comes_through_a_ship(device, bare):
    """All that is in sight lies in the shadow of one 5 km long; leaves, too, have none of the sun."""
    without, key, pose = bare
    east, north, up = 6e3 * key
    ship = {"file": "ship", "above": "sea", "height": pose.height + up}
    light, *_ = light_of(device, [ship | {"east": pose.east + east, "north": pose.north + north}])
    assert len(light) == len(without)
    assert light.max() == 0.0
