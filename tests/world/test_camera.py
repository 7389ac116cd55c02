"""The camera's way through time."""

from __future__ import annotations

import itertools
import math

import pytest

import fallstreak as fs
from fallstreak.world import queries
from fallstreak.world.tracks import Track


def camera(*keyframes, **more):
    return fs.World(camera={"keyframes": list(keyframes), **more}).camera


def test_a_camera_without_keyframes_rests():
    rest = camera(east=3, heading=-90)
    assert rest.at(0) == rest.at(1e6)
    assert (rest.at(5).east, rest.at(5).heading, rest.at(5).above) == (3.0, -90.0, "ground")


def test_keyframes_are_reached_exactly_and_held_outside():
    moving = camera(
        {"at": 1, "east": 5, "fov": 20}, {"at": 3, "east": 9}, {"at": 4, "east": 0, "fov": 60}, roll=7
    )
    for at, east in ((0, 5), (1, 5), (3, 9), (4, 0), (99, 0)):
        assert moving.at(at).east == pytest.approx(east)
    assert moving.at(1).fov == 20 and moving.at(4).fov == 60 and 20 < moving.at(3).fov < 60
    assert moving.at(2).roll == 7.0  # what no keyframe states stays


def test_heading_turns_the_shorter_way():
    turning = camera({"at": 0, "heading": 350}, {"at": 10, "heading": 10}, {"at": 20, "heading": 355})
    assert turning.at(5).heading == pytest.approx(0, abs=1e-9)
    for i in range(201):
        heading = turning.at(i / 10).heading
        assert 0 <= heading < 360 and (heading >= 349.999 or heading <= 10.001)
    whole = camera(
        {"at": 0, "heading": 0},
        {"at": 1, "heading": 120},
        {"at": 2, "heading": 240},
        {"at": 3, "heading": 360},
    )
    assert whole.at(1.5).heading == pytest.approx(180)


def test_height_never_leaves_the_values_it_joins():
    heights = [2.0, 2.0, 500.0, 510.0, 3.0, 4e5]
    climbing = camera(*({"at": i * i, "height": h} for i, h in enumerate(heights)))
    for i in range(len(heights) - 1):
        low, high = sorted(heights[i : i + 2])
        values = [climbing.at(i * i + (2 * i + 1) * k / 50).height for k in range(51)]
        assert all(low - 1e-9 <= v <= high + 1e-9 for v in values)
        steps = [b - a for a, b in itertools.pairwise(values)]
        assert min(steps) > -1e-9 or max(steps) < 1e-9


@pytest.mark.parametrize("kind", ["through", "monotone", "turn"])
def test_speed_has_no_jumps(kind):
    track = Track([(0, 10), (1, 12), (3, 30), (3.5, 31), (8, 20)], kind)
    step = 1e-5
    for knot in (0, 1, 3, 3.5, 8):
        before = (track(knot) - track(knot - step)) / step
        after = (track(knot + step) - track(knot)) / step
        assert after == pytest.approx(before, abs=0.01)


def test_through_keeps_a_steady_pace_on_a_straight_way():
    track = Track([(0, 0), (1, 10), (3, 30), (4, 40)], "through")
    assert all(track(1 + 2 * k / 20) == pytest.approx(10 + k, abs=1e-9) for k in range(21))


def test_angles_in_radians():
    pose = fs.World(camera={"heading": 90, "pitch": -45, "roll": 0, "fov": 60}).camera.at(0)
    assert pose.angles == pytest.approx((math.pi / 2, -math.pi / 4, 0.0, math.pi / 3))


def test_upper_rooms_answer_queries(monkeypatch):
    monkeypatch.setattr(queries, "_entries", dict(queries._entries))
    monkeypatch.setattr(queries, "_resolved", {})
    queries.register("terrain.height", "world_helpers:height")
    import sys
    import types

    module = types.ModuleType("world_helpers")
    module.height = lambda world, east, north: (world.seed, east, north)  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "world_helpers", module)
    world = fs.World(seed=4)
    assert world.terrain.height(1, 2) == (4, 1, 2)
    assert world.updated({"seed": 5}).terrain.height(1, 2) == (5, 1, 2)
    with pytest.raises(fs.WorldError, match="belongs to no world"):
        type(world.terrain)().height(0, 0)
    with pytest.raises(LookupError, match="nonesuch"):
        queries.resolve("nonesuch")
