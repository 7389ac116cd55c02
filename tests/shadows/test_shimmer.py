"""Shimmer: shadows stand still in the world while the camera moves by tenths of a texel and turns."""

from __future__ import annotations

import numpy as np
import pytest
from shadow_shimmer import land_steps, walk
from shadow_stage import Stage

import fallstreak as fs

SIZE = (320, 180)
SHIP = {"file": "ship", "above": "sea", "east": 6195.0, "north": -38e3, "height": 3480.0}


def stage_of(device, technique="stable", quality="low", **shadows):
    changes = {f"shadows.{name}": value for name, value in shadows.items()}
    world = fs.load("long_shadows").updated({"models": [SHIP], "shadows.technique": technique} | changes)
    return Stage(device, world, SIZE, quality)


@pytest.mark.parametrize(("quality", "contact"), [("low", 0.0), ("low", 0.3), ("high", 0.3)])
def test_nothing_flips(device, quality, contact):
    """Land, spruces, rocks and a ship at 3 degrees: the same places, and pixels beside the edges."""
    found = walk(stage_of(device, quality=quality, contact=contact), steps=8)
    assert found.places > 300_000
    assert found.pixels > 100_000
    assert 0.2 < found.dark < 0.8
    assert sum(found.flipped.values()) == 0
    assert found.pixels_flipped == 0


def test_nothing_flips_as_windows_of_land_step(device):
    """The narrow windows of a small picture: nothing is asked of them that they may not hold."""
    found = land_steps(stage_of(device, contact=0.0), farthest=200.0)
    assert len(found) > 3
    assert [flipped for *_, flipped in found] == [0] * len(found)


def test_the_journals_maps_flip(device):
    """What finds nothing in the stable maps finds something in those that are fitted to the view."""
    found = walk(stage_of(device, technique="infinity2007"), steps=4)
    assert found.flipped["things", True] > 500


def test_places_see_what_pixels_see(device):
    """The light at the pixels' places is the picture's, but for woods and leaves, which have their own."""
    stage = stage_of(device, contact=0.0)
    camera = stage.camera()
    picture, _ = stage.render(camera)
    seen = np.isfinite(picture.along)
    picture, light = stage.render(camera, picture.places[seen], picture.normals[seen])
    off = np.abs(light.prod(-1) - picture.light[seen])
    assert (off < 0.01).mean() > 0.8
    assert (picture.light[seen] < light.prod(-1) + 0.16).all()


@pytest.mark.parametrize("ahead", [3.0, 30.0])
def test_a_map_kept_on_the_way_is_that_drawn_afresh(device, ahead):
    """Among spruces: what is seen after some metres does not hang on where a map was drawn."""
    stage = stage_of(device, contact=0.0)
    east = stage.pose().east
    stage.begin()
    for n in range(9):
        kept, _ = stage.render(stage.camera(east + ahead * n / 8.0))
    assert len(stage.shadows.cascades.drawn) < 3, "something is kept"
    stage.begin()
    fresh, _ = stage.render(stage.camera(east + ahead))
    # a thing's edge may come to lie in the next texel by the rounding of single floats
    assert (np.abs(kept.light - fresh.light) > 0.02).mean() < 4e-4
