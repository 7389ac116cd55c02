"""The ring: when it is made anew, that it shows what sprites would, and costs less."""

from __future__ import annotations

import itertools
from math import atan2, hypot, radians

import numpy as np
import pytest

import fallstreak as fs
from fallstreak.clouds.sprites.ring.parts import SIDES, SLICES, at_once, by_block, by_side
from fallstreak.clouds.sprites.ring.plan import FADE, PAUSE, Plan, Ring
from fallstreak.clouds.sprites.scope import BLOCK

RADIUS = 10e3
FARTHEST = 100e3
STEPS = by_side(RADIUS, FARTHEST)


def seen(east=0.0, height=1000.0, time=0.0, sun=40.0):
    angle = np.radians(sun)
    place = np.array([east, 0.0])
    key = np.array([0.0, np.cos(angle), np.sin(angle)])
    return Ring(np.array([east, 0.0, height]), place, height, key, time, 0)


def standing(wind=(0.0, 0.0), lifetime=np.inf):
    plan = Plan(RADIUS, np.array([wind]), lifetime, STEPS)
    plan.update(seen(), fresh=True)
    return plan


def test_the_first_one_is_made_at_once_and_shown():
    plan = standing()
    assert [part.side for part in plan.parts] == list(range(SIDES))
    assert plan.shown is plan.drawn
    plan.update(seen())
    assert plan.parts == ()
    assert plan.shown is not None


@pytest.mark.parametrize(
    ("now", "anew"),
    [
        (seen(east=0.14 * RADIUS), False),
        (seen(east=0.16 * RADIUS), True),
        (seen(height=1000.0 + 0.019 * RADIUS), False),
        (seen(height=1000.0 - 0.021 * RADIUS), True),
        (seen(sun=40.9), False),
        (seen(sun=41.1), True),
        (seen(time=50.0), False),
    ],
)
def test_thresholds(now, anew):
    plan = standing()
    plan.update(now)
    assert (plan.next is not None) == anew
    assert len(plan.parts) == anew


def test_clouds_that_drift_or_age_make_it_anew():
    drifting, ageing = standing(wind=(30.0, 0.0)), standing(lifetime=1000.0)
    drifting.update(seen(time=49.0))
    ageing.update(seen(time=29.0))
    assert drifting.next is None
    assert ageing.next is None
    drifting.update(seen(time=51.0))
    ageing.update(seen(time=31.0))
    assert drifting.next is not None
    assert ageing.next is not None


def test_a_new_one_is_drawn_part_by_part_comes_in_slowly_and_takes_the_other_pictures():
    plan = standing()
    first = plan.shown
    drawn, weights = [], []
    for _ in range(len(STEPS) + FADE):
        plan.update(seen(east=2000.0))
        drawn.extend(plan.parts)
        weights.append(plan.weight)
        if plan.next is not None:
            assert plan.shown is first
            assert plan.next.set != first.set
    assert drawn == [part for step in STEPS for part in step]
    assert weights[: len(STEPS)] == [0.0] * len(STEPS)
    assert np.allclose(np.diff(weights[len(STEPS) : -1]), 1.0 / FADE)
    assert plan.shown.position[0] == 2000.0
    assert plan.next is None


@pytest.mark.parametrize("now", [seen(east=5e3), seen(height=1700.0), seen(time=-1.0)])
def test_after_a_cut_another_is_made_at_once(now):
    plan = standing()
    for _ in range(PAUSE - 1):
        plan.update(seen())
    plan.update(now)
    assert len(plan.parts) == SIDES
    assert plan.shown.position is now.position


def test_who_travels_too_fast_has_none():
    plan = standing()
    made = 0
    for frame in range(1, 2 * PAUSE):
        plan.update(seen(height=1000.0 + 1000.0 * frame))
        made += len(plan.parts)
    assert made == SIDES


def test_a_beginning_is_never_without():
    plan = standing()
    for frame in range(5):
        plan.update(seen(east=7e3 * frame), fresh=True)
        assert plan.shown.position[0] == 7e3 * frame


def test_sides_are_drawn_far_first_and_whole():
    assert len(STEPS) == SIDES * SLICES
    for side in range(SIDES):
        parts = [part for step in STEPS for part in step if part.side == side]
        assert [part.first for part in parts] == [True, *[False] * (SLICES - 1)]
        assert parts[-1].distances[0] == 0.0
        assert parts[0].distances[1] == np.inf
        assert all(far.distances[0] == near.distances[1] for far, near in itertools.pairwise(parts))
    assert len(at_once()) == SIDES


def test_blocks_are_drawn_once_on_all_sides_they_are_on_and_what_hides_them_later():
    steps = by_block(RADIUS, FARTHEST, 2000.0)
    assert 40 <= len(steps) <= 100
    squares = [step[0].square for step in steps]
    assert all(part.square == square for step, square in zip(steps, squares, strict=True) for part in step)
    begun = [part.side for step in steps for part in step if part.first]
    assert sorted(begun) == list(range(SIDES))
    assert min(east - west for west, _, east, _ in squares) == BLOCK
    middles = (np.arange(-30, 30) + 0.5) * BLOCK
    for x in middles:
        for y in middles:
            hits = [k for k, (w, s, e, n) in enumerate(squares) if w <= x < e and s <= y < n]
            if not RADIUS < hypot(x, y) < FARTHEST:
                assert len(hits) <= 1
                continue
            assert len(hits) == 1
            side = round(atan2(x, y) / radians(45.0)) % SIDES
            assert side in [part.side for part in steps[hits[0]]]
            # on the way to it are only squares that come later
            way = np.linspace(0.0, 1.0, 200)[:, None] * [x, y]
            for k, (w, s, e, n) in enumerate(squares[: hits[0]]):
                assert not ((way > [w, s]) & (way < [e, n])).all(-1).any(), k


def sky(**changes):
    return fs.load("hundred_miles").updated(
        {
            "clouds.technique": "sprites",
            "camera.height": 1500.0,
            "camera.pitch": 1.0,
            "clouds.layers": [{"genus": "cumulus_mediocris", "coverage": 0.3, "lifetime": 0.0}],
            **{key.replace("__", "."): value for key, value in changes.items()},
        }
    )


def played(world, frames, size=(192, 108)):
    with fs.Renderer(world, size, "low", fps=30) as renderer:
        for index in range(frames):
            frame = renderer.render(index)
        return frame.ldr, renderer.pipeline.clouds.technique.counts()


@pytest.mark.parametrize("update", ["side", "block"])
def test_it_looks_like_the_sprites_it_stands_for(update):
    """After one that was made at once, one that was made part by part: the camera goes past the threshold."""
    way = [{"at": 0, "north": 0.0}, {"at": 0.1, "north": 1700.0}]
    frames = 5 + (8 * SLICES if update == "side" else 80) + FADE
    ring, counts = played(sky(clouds__sprites__ring_update=update, camera__keyframes=way), frames)
    direct, of_direct = played(sky(clouds__sprites__ring=False, camera__keyframes=way), frames)
    difference = np.abs(ring.astype(float) - direct).mean()
    print(f"\nmean difference {difference:.2f}/255, clouds drawn {counts['clouds']} of {of_direct['clouds']}")
    assert counts["clouds"] < 0.3 * of_direct["clouds"]
    assert counts["ring_parts"] == 0
    assert difference <= 2.0


def test_seams_of_the_octagon_are_not_seen():
    """With the ring and without: pictures differ no more where sides meet than beside it."""
    headings = [{"at": float(k), "heading": 22.5 + 45.0 * k} for k in range(8)]
    pictures = []
    for ring in (True, False):
        world = sky(camera__keyframes=headings, camera__fov=30.0, clouds__sprites__ring=ring)
        with fs.Renderer(world, (160, 90), "low", fps=1) as renderer:
            pictures.append([renderer.render(k).ldr.astype(float) for k in range(8)])
    columns = np.abs(np.subtract(*pictures)).mean((1, 3))
    seams = columns[:, 78:82].mean(1)
    beside = np.concatenate([columns[:, 60:76], columns[:, 84:100]], 1)
    print(f"\nseams {np.round(seams, 2)}, beside {np.round(beside.mean(1), 2)}")
    assert 0.02 < seams.mean() <= 1.2 * beside.mean()
    assert (seams <= beside.max(1) + 1.0).all()


def test_nobody_is_drawn_twice_while_one_comes_in():
    """Shares of two rings that make 1 leave nothing to draw one by one but what a ring does not show."""
    way = [{"at": 0, "north": 0.0}, {"at": 0.1, "north": 1700.0}]
    world = sky(camera__keyframes=way)
    drawn, weights = [], []
    with fs.Renderer(world, (64, 36), "low", fps=30) as renderer:
        for index in range(5 + 8 * SLICES + FADE):
            renderer.render(index)
            technique = renderer.pipeline.clouds.technique
            if 0.0 < technique.ring.plan.weight < 1.0:
                weights.append(technique.ring.plan.weight)
                drawn.append(technique.counts()["clouds"])
    _, direct = played(world.updated({"clouds.sprites.ring": False}), 4, (64, 36))
    assert len(weights) == FADE - 1
    assert max(drawn) < 0.3 * direct["clouds"]


def test_frames_repeat():
    first, second = (played(sky(), 14, (64, 36))[0] for _ in range(2))
    np.testing.assert_array_equal(first, second)


def test_it_stands_from_the_first_frame_on():
    """Whether a frame begins a sequence, follows a cut, or is far into it; stills do without."""
    cut = [{"at": t, "north": 0.0 if t < 4 else 9e3} for t in (0, 1, 2, 3, 3.8, 3.9, 4, 4.1, 5, 6)]
    with fs.Renderer(sky(camera__keyframes=cut), (64, 36), "low", fps=10) as renderer:
        for index in range(26, 43):
            renderer.render(index)
            ring = renderer.pipeline.clouds.technique.ring.plan.shown
            assert ring is not None and ring.place[1] == pytest.approx(9e3 if index >= 40 else 0.0, abs=50)
    with fs.Renderer(sky(), (64, 36), "low", fps=10) as renderer:
        for index in (0, 50, 51, 7):
            renderer.render(index)
            assert renderer.pipeline.clouds.technique.ring.plan.shown is not None
    with fs.Renderer(sky(), (64, 36), "low", still=True) as renderer:
        assert renderer.pipeline.clouds.technique.ring is None
