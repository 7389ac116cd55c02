"""Daylight to starlight: what falls on level ground, against the twilight tables of USNO Circular 171."""

from math import radians

import numpy as np
import pytest

from fallstreak.sky.light import twilight_lux
from fallstreak.world import World

from .stage import Stage

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


@pytest.fixture(scope="module")
def stage(device):
    return Stage(device, World(sky={"moon": False, "night_glow": 0.0}), size=(32, 18))


def level_lux(stage, elevation):
    stage.frame(sun=(elevation, 180.0))
    records = np.frombuffer(np.asarray(stage.graph.read("sky.irradiance")).tobytes(), np.float32)
    return float(records.reshape(-1, 4)[:3, 3] @ LUMINANCE)


@pytest.mark.parametrize("elevation", [0, -3, -6, -9, -12])
def test_twilight_illuminance(stage, elevation):
    """From 760 lx to 0.008 lx. Clear air stays within a factor of 2.5."""
    ratio = level_lux(stage, elevation) / twilight_lux(radians(elevation))
    assert 1 / 2.5 < ratio < 2.5


def test_dusk_falls_smoothly(stage):
    levels = np.log([level_lux(stage, e) for e in np.arange(2.0, -14.0, -0.5)])
    steps = np.diff(levels)
    assert np.all(steps < 0)
    assert np.abs(steps).max() < 1.2  # half a degree takes two thirds at most
    assert np.abs(np.diff(steps)).max() < 0.35
