"""Where models are: on the curved planet, along keyframes, and as Python says."""

from __future__ import annotations

import numpy as np
import pytest

import fallstreak as fs
from fallstreak.models.passes import INSTANCE, pack_instances, split
from fallstreak.models.poses import PlacedModels, matrices
from fallstreak.world.state import camera_rotation, local_axes, position_on_planet

R = 6371e3
BODY = np.diag(
    [-1.0, 1.0, -1.0]
)  # a camera looks along -z with x to its right; a model's z is forward, x left


def test_a_model_stands_where_a_camera_would():
    rng = np.random.default_rng(0)
    n = 40
    east, north = rng.uniform(-9e5, 9e5, (2, n))
    east[0] = north[0] = 0.0
    height = rng.uniform(-100, 2e4, n)
    heading, pitch, roll = rng.uniform(-4, 4, (3, n))
    scale = rng.uniform(0.5, 3.0, n)
    got = matrices(east, north, height, heading, pitch, roll, scale, R)
    for i in range(n):
        axes = local_axes(east[i], north[i], R)
        turn = camera_rotation(heading[i], pitch[i], roll[i], axes) @ BODY
        np.testing.assert_allclose(got[i, :3, :3], turn * scale[i], atol=1e-12)
        np.testing.assert_allclose(
            got[i, :3, 3], position_on_planet(east[i], north[i], height[i], R), atol=1e-6
        )
    np.testing.assert_array_equal(got[:, 3], [(0, 0, 0, 1)] * n)


def test_the_nose_points_where_it_says():
    north, east, up, banked = matrices(
        0, 0, 0, *np.radians([(0, 90, 0, 0), (0, 0, 90, 0), (0, 0, 0, 90)]), 1, R
    )[:, :3, :3]
    np.testing.assert_allclose(north @ (0, 0, 1), (0, 1, 0), atol=1e-12)
    np.testing.assert_allclose(north @ (1, 0, 0), (-1, 0, 0), atol=1e-12)  # its x is to its left: west
    np.testing.assert_allclose(east @ (0, 0, 1), (1, 0, 0), atol=1e-12)
    np.testing.assert_allclose(up @ (0, 0, 1), (0, 0, 1), atol=1e-12)
    np.testing.assert_allclose(banked @ (-1, 0, 0), (0, 0, -1), atol=1e-12)  # right wing down


def test_packing_keeps_positions_to_micrometres():
    rng = np.random.default_rng(1)
    transforms = np.tile(np.eye(4), (1000, 1, 1))
    transforms[:, :3, 3] = rng.uniform(-1e9, 1e9, (1000, 3))
    packed = pack_instances(transforms)
    again = packed["tile"][:, :3] * 256.0 + packed["columns"][:, :, 3].astype(np.float64)
    assert np.abs(again - transforms[:, :3, 3]).max() < 1.6e-5
    assert INSTANCE.itemsize == 64
    tile, local = split(np.array([-0.5, 0.0, 1e6]))
    assert tile.tolist() == [-1, 0, 3906] and local.tolist() == [255.5, 0.0, 64.0]


@pytest.fixture
def gliders():
    return PlacedModels(fs.World(models=[{"file": "glider", "above": "sea", "height": 5.0, "capacity": 20}]))[
        "glider"
    ]


def test_the_scene_decides_until_python_does(gliders):
    assert gliders.transform is None
    gliders.latch(0, True)
    own = gliders.at(0, 0.0)
    np.testing.assert_allclose(own[0, :3, 3], (0, 0, 5))
    assert gliders.at(7, 1.0) is own, "what rests is one object, so that nothing is uploaded again"
    made = gliders.place(east=[1.0, 2.0, 3.0], height=10.0, above="sea")
    assert made.shape == (3, 4, 4) and gliders.at(0, 0.0) is own, "frame 0 keeps what it had"
    gliders.latch(1, False)
    assert gliders.at(1, 0.0) is made and gliders.at(0, 0.0) is own
    gliders.transform = None
    gliders.latch(2, False)
    assert gliders.at(2, 0.0) is own


def test_what_python_may_not_say(gliders):
    flat = np.eye(4)
    flat[0, 0] = 0.0
    mirrored = np.diag([-1.0, 1, 1, 1])
    for wrong in (flat, mirrored, np.full((4, 4), np.nan), np.diag([np.inf, 1, 1, 1])):
        with pytest.raises(ValueError, match="not finite, flat, or mirrors"):
            gliders.transform = wrong
    with pytest.raises(ValueError, match=r"shape \(1, 3, 3\)"):
        gliders.transform = np.eye(3)
    with pytest.raises(ValueError, match="its capacity is 20"):
        gliders.place(east=np.arange(21.0))
    with pytest.raises(ValueError, match='"ground" or "sea"'):
        gliders.place(above="air")
    assert gliders.transform is None, "what was refused has changed nothing"
    gliders.transform = np.eye(4)
    with pytest.raises(ValueError, match="read-only"):
        gliders.transform[0, 0, 3] = 1.0  # set it again instead, so that the change is seen


def test_no_copies_at_all(gliders):
    gliders.transform = np.zeros((0, 4, 4))
    assert gliders.transform.shape == (0, 4, 4)


def test_unknown_names_are_told():
    models = PlacedModels(fs.World(models=[{"file": "glider"}, {"file": "glider", "name": "tug"}]))
    assert list(models) == ["glider", "tug"] and len(models) == 2
    with pytest.raises(KeyError, match="there are: glider, tug"):
        models["ship"]


def test_instances_take_what_they_do_not_say_from_the_model():
    model = {"file": "glider", "above": "sea", "height": 7.0, "heading": 90.0,
             "instances": [{"east": 10.0}, {"north": 5.0, "heading": 0.0, "scale": 2.0}]}  # fmt: skip
    placed = PlacedModels(fs.World(models=[model]))["glider"]
    first, second = placed.at(0, 0.0)
    np.testing.assert_allclose(first[:3, 3], (10, 0, 7), atol=1e-4)
    np.testing.assert_allclose(first[:3, 2], (1, 0, 0), atol=1e-5)
    np.testing.assert_allclose(second[:3, 2], (0, 2, 0), atol=1e-5)


def test_keyframes_run_by_the_seconds_of_the_sequence():
    keyframes = [
        {"at": 0, "north": 0.0, "height": 100.0},
        {"at": 2, "north": 50.0, "height": 200.0, "roll": 30.0},
    ]
    placed = PlacedModels(fs.World(models=[{"file": "glider", "above": "sea", "keyframes": keyframes}]))[
        "glider"
    ]
    path = [placed.at(i, i / 4)[0, :3, 3] for i in range(9)]
    np.testing.assert_allclose(path[0], (0, 0, 100), atol=1e-6)
    np.testing.assert_allclose(path[4], (0, 25, 150), atol=5e-3)
    np.testing.assert_allclose(path[8], (0, 50, 200), atol=5e-3)
    assert placed.at(0, -5.0)[0, 2, 3] == 100.0, "before the first keyframe it rests"


def test_models_stand_on_the_ground():
    world = fs.load("jacksboro").updated(
        {"models": [{"file": "glider", "east": 300.0, "north": -200.0, "height": 0.6}]}
    )
    where = PlacedModels(world)["glider"].at(0, 0.0)[0, :3, 3]
    np.testing.assert_allclose(where[2], world.terrain.height(300.0, -200.0) + 0.6, atol=0.05)
