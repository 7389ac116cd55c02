"""Puffs of the shipped scene: how many are drawn wherever the camera is, and that frames repeat."""

from __future__ import annotations

import numpy as np
import pytest

import fallstreak as fs

SIZE = (128, 72)
PLACES = {
    "10 km": {"clouds.visibility": 10e3},
    "40 km": {"clouds.visibility": 40e3},
    "160 km": {"clouds.visibility": 160e3},
    "orbit": {"camera.height": 400e3, "camera.pitch": -35.0},
}


# there are gaps as wide as a short view: several places stand for the sky
CAMERAS = [
    (0.0, 0.0, 20.0),
    (90e3, 40e3, 110.0),
    (-80e3, 70e3, 200.0),
    (30e3, -100e3, 290.0),
    (-60e3, -50e3, 65.0),
]


def counts(changes, cameras=tuple(CAMERAS)):
    """Of one renderer, which looks from one camera a second."""
    way = [{"at": i, "east": e, "north": n, "heading": h} for i, (e, n, h) in enumerate(cameras)]
    world = fs.load("hundred_miles").updated({**changes, "camera.keyframes": way})
    found = []
    with fs.Renderer(world, SIZE, "low", fps=1.0, still=True) as renderer:
        for index in range(len(cameras)):
            renderer.render(index)
            found.append(renderer.pipeline.clouds.technique.counts())
    return found


def test_the_number_of_puffs_hardly_changes():
    drawn = {name: [c["drawn"] for c in counts(changes)] for name, changes in PLACES.items()}
    means = np.array([np.mean(numbers) for numbers in drawn.values()])
    print(f"\npuffs drawn, by place: {drawn}")
    assert max(max(numbers) for numbers in drawn.values()) <= 30_000
    middle = 0.5 * (means.min() + means.max())
    assert np.abs(means / middle - 1.0).max() <= 0.2


def test_counts_add_up():
    (found,) = counts({}, [(0.0, 0.0, 250.0)])
    assert found["buckets"] % 27 == 0
    assert found["buckets"] > 2 * found["buckets_in_sight"]
    assert found["evaluated"] > found["found"] >= found["drawn"] > 500
    assert sum(n for name, n in found.items() if name.endswith(" m")) == found["found"]


@pytest.mark.parametrize("height", [1400.0, 100e3])
def test_a_frame_repeats_on_another_device(height):
    world = fs.load("hundred_miles").updated({"camera.height": height})
    first, second = (fs.render(world, SIZE, "low").ldr for _ in range(2))
    np.testing.assert_array_equal(first, second)
