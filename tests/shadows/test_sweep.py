"""Shadows of the land: the swept heights against rays, the GPU against its twin, and in motion."""

from itertools import pairwise
from math import radians, tan

import numpy as np
import pytest

import fallstreak as fs
from fallstreak.shadows.sweep import model
from fallstreak.shadows.sweep.schedule import Schedule, key_near
from fallstreak.terrain.model import terrain_model

from .sweep_stage import Stage

AZIMUTHS = (20, 80, 140, 200, 260, 320)
RADIUS = 6_371_000.0


def iou(a, b):
    return (a & b).sum() / max((a | b).sum(), 1)


@pytest.fixture(scope="module")
def jacksboro():
    """Heights of the elevation model's middle, 16 km wide, every 32 m; and places on it."""
    along = (np.arange(512) - 256) * 32.0
    x, y = np.meshgrid(along, along)
    found = terrain_model(fs.load("jacksboro")).shape(x, y, 32.0)
    places = np.random.default_rng(3).uniform(100.0, 410.0, (6000, 2))
    return np.maximum(found.height, found.water), places


@pytest.mark.parametrize("azimuth", AZIMUTHS)
@pytest.mark.parametrize("elevation", [2, 3, 6, 12, 25])
def test_no_light_where_rays_find_none(jacksboro, azimuth, elevation):
    heights, places = jacksboro
    a, e = radians(azimuth), radians(elevation)
    dark, rays = model.dark_by_both(heights, 32.0, a, e, places)
    assert (dark != rays).mean() < 0.0125
    # at 25 degrees 1 to 4 % of this land is dark, in slivers about a sample wide
    assert iou(dark, rays) > (0.98 if elevation < 25 else 0.9)


@pytest.mark.parametrize("azimuth", [10, 100, 250])
@pytest.mark.parametrize("elevation", [2, 3, 6, 12])
def test_the_planet_curves_under_a_range_a_hundred_kilometres_wide(azimuth, elevation):
    n, spacing = 1000, 100.0
    along = (np.arange(n) - n // 2) * spacing
    x, y = np.meshgrid(along, along)
    heights = 1500.0 * (1 + np.sin(x / 9000.0 + np.sin(y / 13000.0))) * (0.6 + 0.4 * np.cos(y / 7000.0))
    heights += 400.0 * np.sin(x / 2100.0) * np.sin(y / 2500.0)
    a, e = radians(azimuth), radians(elevation)
    places = np.random.default_rng(4).uniform(40.0, 959.0, (8000, 2))
    dark, rays = model.dark_by_both(heights, spacing, a, e, places, RADIUS)
    at = np.column_stack([places, model.between(heights, *places.T) + 1e-3])
    flat = ~model.rays(heights, spacing, a, e, at=at)
    assert iou(dark, rays) > (0.98 if elevation < 12 else 0.97)
    assert elevation > 6 or iou(dark, rays) > iou(dark, flat)


def test_a_penumbra_is_as_wide_as_the_disc_makes_it():
    """Behind a wall 1000 m high the shade begins at 1000 / tan(e ± r)."""
    heights = np.zeros((600, 600))
    heights[:, 500] = 1000.0
    e = radians(5.0)
    upper, lower = model.swept(heights, 50.0, radians(90.0), e)
    share = model.land_light(0.0, upper[300], lower[300])
    away = (500 - np.arange(600)) * 50.0
    assert np.isclose(away[:500][share[:500] < 0.999].max(), 1000.0 / tan(e - model.DISC), atol=60.0)
    assert np.isclose(away[:500][share[:500] < 0.001].max(), 1000.0 / tan(e + model.DISC), atol=60.0)


def test_a_far_penumbra_lies_on_a_slope_that_nearly_faces_away():
    """Ground that rises almost as steeply as the light hides nothing, nor makes the shade deeper."""
    e, spacing = radians(5.0), 20.0
    away = (500 - np.arange(600)) * spacing
    slope = tan(e - 1.5 * model.DISC)
    heights = np.broadcast_to(-slope * away, (600, 600)).copy()
    heights[:, 500] += 60.0
    upper, lower = model.swept(heights, spacing, radians(90.0), e)
    share = model.land_light(heights, upper, lower)[300, 20:498]
    top = np.arctan(slope + 60.0 / away[20:498])  # of what hides, above the horizon
    t = np.clip((e + model.DISC - top) / (2.0 * model.DISC), 0.0, 1.0)
    np.testing.assert_allclose(share, t * t * (3.0 - 2.0 * t), atol=0.02)
    assert ((share > 0.1) & (share < 0.9)).sum() > 100


@pytest.fixture(scope="module")
def stage(device):
    with pytest.MonkeyPatch.context() as patch:
        yield Stage(device, patch, terrain_spacing=32.0)


@pytest.mark.parametrize(("azimuth", "elevation"), [(250, 6), (10, 3), (140, 2), (45, 12), (300, 25)])
def test_the_gpu_sweeps_as_its_twin_does(stage, azimuth, elevation):
    stage.look((0.0, 0.0, 900.0), stage.key(azimuth, elevation))
    level = stage.sweep.constants["SWEEP_LEVELS"] - 1  # the coarsest: nothing comes from outside
    n = stage.sweep.constants["SWEEP_WIDTH"]
    spacing = 32.0 * 2**level
    first = stage.sweep._schedule.firsts[level]
    clip = stage.terrain.profile.tiles * 32
    sample = [first[axis] + np.arange(n) for axis in (0, 1)]
    texels = np.array(stage.graph.read("terrain.shape"))[level, ..., 0].view(np.float32).reshape(clip, clip)
    heights = texels[np.ix_(sample[1] % clip, sample[0] % clip)].astype(float)
    away = np.hypot(sample[0][None] * spacing, sample[1][:, None] * spacing)
    heights[away > stage.terrain.model.extent] = stage.terrain.model.land.outside
    key = key_near(stage.key(azimuth, elevation))
    a, e = np.arctan2(key[0], key[1]), np.arcsin(key[2])
    twin = model.swept(heights, spacing, a, e, stage.radius, first=(first[0], first[1]))
    found = stage.at_samples(level)
    inner = np.s_[n // 8 : -n // 8, n // 8 : -n // 8]
    for mine, its in zip(found, twin, strict=True):
        near = (its > heights - 1500.0)[inner]
        off = np.abs(mine - its)[inner][near]
        assert near.mean() > 0.9
        # half floats, up to some hundred metres off the ground
        assert np.quantile(off, 0.5) < 0.6
        assert np.quantile(off, 0.99) < 2.5


def test_whoever_is_high_enough_is_lit_and_who_is_under_it_is_not(stage):
    rng = np.random.default_rng(5)
    places = np.column_stack([rng.uniform(-5000, 5000, (4000, 2)), np.zeros(4000)])
    places[:, 2] = stage.world.terrain.height(places[:, 0], places[:, 1])
    key = stage.key(250, 3)
    shares = [
        stage.look((0.0, 0.0, 900.0), key, places + np.array([0, 0, up])) for up in (0, 20, 100, 400, 4000)
    ]
    assert 0.1 < shares[0].mean() < 0.6
    for low, high in pairwise(shares):
        assert (high >= low - 1e-3).all()
    assert (shares[-1] == 1.0).all()


def test_shadows_reach_down_to_the_camera_from_fifty_kilometres(device, monkeypatch):
    """A summit's shadow is where the geometry says, levels away from the summit's own."""
    stage = Stage(device, monkeypatch, "alpine", terrain_spacing=8.0)
    rng = np.random.default_rng(6)
    places = np.column_stack([rng.uniform(-1200, 1200, (3000, 2)), np.full(3000, 0.0)])
    places[:, 2] = stage.world.terrain.height(places[:, 0], places[:, 1])
    key = stage.key(240, 2)
    share = stage.look((0.0, 0.0, 3000.0), key, places)
    spacing, n = 64.0, 1024
    along = (np.arange(n) - n // 2) * spacing
    heights = stage.terrain.model.shape(*np.meshgrid(along, along), spacing)
    heights = np.maximum(heights.height, heights.water)
    at = np.column_stack([places[:, :2] / spacing + n // 2, places[:, 2]])
    at[:, 2] = np.maximum(at[:, 2], model.between(heights, at[:, 0], at[:, 1]))  # not under these samples
    seen = model.rays(heights, spacing, radians(240), radians(2), stage.radius, at=at)
    assert ((share > 0.5) != seen).mean() < 0.1


def test_in_motion_the_picture_is_that_of_a_fresh_one(stage):
    rng = np.random.default_rng(7)
    offsets = rng.uniform(-5000, 5000, (4000, 2))
    key = stage.key(250, 4)
    stage.look((0.0, 0.0, 900.0), key)
    for frame in range(1, 40):
        camera = (90.0 * frame, 40.0 * frame, 900.0)
        stage.look(camera, key, fresh=False)
    places = np.column_stack([offsets + camera[:2], np.zeros(4000)])
    places[:, 2] = stage.world.terrain.height(places[:, 0], places[:, 1])
    moved = stage.look(camera, key, places, fresh=False)
    fresh = stage.look(camera, key, places, fresh=True)
    assert ((moved > 0.5) != (fresh > 0.5)).mean() < 0.005
    assert np.abs(moved - fresh).mean() < 0.005


def test_from_beyond_the_map_nothing_is_swept_again_and_again(stage):
    camera = (1.5 * stage.terrain.model.extent, 0.0, 9000.0)
    key = stage.key(250, 20)
    stage.look(camera, key)
    stage.look(camera, key, fresh=False)
    assert not stage.sweep._due


def test_what_is_swept_depends_on_camera_and_light_alone():
    key = key_near(np.array([0.9, 0.0, 0.1]))
    there = np.array([[704, -96], [352, -64], [160, -32], [96, 0]])
    straight, astray = Schedule(4), Schedule(4)
    assert straight.due(there, key, 0, fresh=True) == [3, 2, 1, 0]
    for step in (0, 1, 2):
        astray.due(there + 32 * step, key_near(key + 0.01 * step), step, fresh=False)
    astray.due(there, key, 0, fresh=False)
    np.testing.assert_array_equal(straight.firsts, astray.firsts)
    assert straight.known.all() and astray.known.all()


def test_a_level_is_swept_again_with_the_coarser_one_and_none_when_nothing_changes():
    schedule = Schedule(4)
    key = key_near(np.array([0.9, 0.0, 0.1]))
    firsts = np.zeros((4, 2), np.int64)
    assert schedule.due(firsts, key, 0, fresh=True) == [3, 2, 1, 0]
    assert schedule.due(firsts, key, 0, fresh=False) == []
    moved = np.array([[64, 0], [32, 0], [0, 0], [0, 0]])
    assert schedule.due(moved, key, 0, fresh=False) == [1, 0]
    # levels that are not held do not wait for anybody, and are swept when they come back
    assert schedule.due(moved, key, 2, fresh=False) == []
    assert schedule.due(moved, key, 0, fresh=False) == [1, 0]
    assert schedule.due(moved, key_near(key + 0.001), 0, fresh=False) == [3, 2, 1, 0]
