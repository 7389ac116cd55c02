"""The ring: when it is made anew, that it shows what sprites would, and costs less."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

import fallstreak as fs
from fallstreak.clouds.sprites.ring.plan import FADE, SIDES, Plan, Ring, slices

RADIUS = 10e3


def seen(east=0.0, height=1000.0, time=0.0, sun=40.0):
    angle = np.radians(sun)
    place = np.array([east, 0.0])
    key = np.array([0.0, np.cos(angle), np.sin(angle)])
    return Ring(np.array([east, 0.0, height]), place, height, key, time, 0)


def complete(wind=(0.0, 0.0), lifetime=np.inf, steps=1):
    plan = Plan(RADIUS, np.array([wind]), lifetime, steps)
    for _ in range(SIDES * steps + 1):
        plan.update(seen())
    assert plan.shown is not None
    assert plan.next is None
    return plan


@pytest.mark.parametrize("steps", [1, 8])
def test_every_part_of_every_side_is_drawn_once_one_a_frame(steps):
    plan = Plan(RADIUS, np.zeros((1, 2)), np.inf, steps)
    drawn = []
    for _ in range(SIDES * steps):
        plan.update(seen())
        assert plan.shown is None
        assert plan.weight == 0.0
        drawn.append((plan.side, plan.step))
    assert drawn == [(side, step) for side in range(SIDES) for step in range(steps)]
    plan.update(seen())
    assert plan.side is None
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
    plan = complete()
    plan.update(now)
    assert (plan.side is not None) == anew


def test_clouds_that_drift_or_age_make_it_anew():
    drifting, ageing = complete(wind=(30.0, 0.0)), complete(lifetime=1000.0)
    drifting.update(seen(time=49.0))
    ageing.update(seen(time=29.0))
    assert drifting.side is None
    assert ageing.side is None
    drifting.update(seen(time=51.0))
    ageing.update(seen(time=31.0))
    assert drifting.side == 0
    assert ageing.side == 0


def test_a_new_one_comes_in_slowly_and_takes_the_other_pictures():
    plan = complete()
    first = plan.shown
    weights = []
    for _ in range(SIDES + FADE):
        plan.update(seen(east=2000.0))
        weights.append(plan.weight)
        if plan.next is not None:
            assert plan.shown is first
            assert plan.next.set != first.set
    assert weights[:SIDES] == [0.0] * SIDES
    rising = weights[SIDES:-1]
    assert np.allclose(np.diff(rising), 1.0 / FADE)
    assert plan.shown.position[0] == 2000.0
    assert plan.next is None


def test_after_a_cut_there_is_none():
    plan = complete()
    plan.update(seen(east=6000.0))
    assert plan.shown is None
    assert plan.side == 0
    plan = complete()
    plan.update(seen(time=-1.0))
    assert plan.shown is None


def test_slices_cover_all_distances_far_first():
    parts = slices(RADIUS, 160e3, 8)
    assert len(parts) == 8
    assert parts[-1][0] == 0.0
    assert parts[0][1] == 1e9
    assert all(near[1] == far[0] for far, near in itertools.pairwise(parts))
    assert slices(RADIUS, 160e3, 1) == [(0.0, 1e9)]


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
    frames = 12 if update == "side" else 67
    ring, counts = played(sky(clouds__sprites__ring_update=update), frames)
    direct, of_direct = played(sky(clouds__sprites__ring=False), 12)
    difference = np.abs(ring.astype(float) - direct).mean()
    print(f"\nmean difference {difference:.2f}/255, clouds drawn {counts['clouds']} of {of_direct['clouds']}")
    assert counts["clouds"] < 0.3 * of_direct["clouds"]
    assert counts["ring_side"] == 0
    assert difference <= 2.0


def test_frames_repeat():
    first, second = (played(sky(), 14, (64, 36))[0] for _ in range(2))
    np.testing.assert_array_equal(first, second)


def test_stills_are_drawn_without_it():
    with_ring, without = (
        fs.render(sky(clouds__sprites__ring=on), (96, 54), "low", samples=1).ldr for on in (True, False)
    )
    np.testing.assert_array_equal(with_ring, without)
