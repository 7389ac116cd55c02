"""The shipped scenes load, and go through TOML unchanged."""

import pytest

import fallstreak as fs


@pytest.mark.parametrize("name", fs.scene_names())
def test_shipped_scene_goes_through_toml_unchanged(name):
    world = fs.load(name)
    assert fs.loads(world.to_toml()) == world
