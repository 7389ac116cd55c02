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


def opacity(world):
    with fs.Renderer(world, SIZE, "low", still=True, samples=1) as renderer:
        renderer.render()
        layer = np.array(renderer.graph.read("clouds.layer")).view(np.float16)
    return layer.reshape(SIZE[1] // 2, SIZE[0] // 2, 4)[..., 3].astype(float)


@pytest.mark.parametrize("height", [200.0, 4000.0])
def test_a_closed_deck_has_no_holes(height):
    """What is left out because others hide it is hidden: above, and below, where matter sets in slowly."""
    layer = {"genus": "stratocumulus", "coverage": 1.0, "base": 1500.0, "lifetime": 0.0}
    camera = {"above": "sea", "height": height, "pitch": 40.0 if height < 1500.0 else -40.0}
    world = fs.World(
        planet={"surface": "ocean"}, camera=camera, clouds={"layers": [layer], "technique": "puffs"}
    )
    found = opacity(world)
    # asked for all of the sky, the field covers nearly that (test_field_coverage)
    open_part = (found < 0.9).mean()
    print(f"\nopen: {open_part:.3f}, mean opacity {found.mean():.3f}")
    assert open_part < 0.04
    assert found.mean() > 0.97
