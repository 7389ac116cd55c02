"""What a long sequence must not do: compile shaders again, or grow."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

import fallstreak as fs

pytestmark = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="reads /proc/self/maps")


def machine_code() -> int:
    """How many pieces of memory hold code that was made at run time: on a software adapter, its shaders."""
    lines = (line.split() for line in Path("/proc/self/maps").read_text().splitlines())
    return sum("x" in words[1] and len(words) < 6 for words in lines)


@pytest.mark.parametrize("scene", ["jacksboro", "orbit", "night", "mars"])
def test_shaders_are_compiled_once(scene):
    """lavapipe compiles a shader again for each value of a uniform in a branch; see gpu/shader.py."""
    with fs.Renderer(fs.load(scene), size=(64, 36), quality="low") as renderer:
        for index in range(4):
            renderer.render(index)
        before = machine_code()
        for index in range(4, 12):
            renderer.render(index)
        assert machine_code() <= before + 1


def test_calls_do_not_grow_with_what_is_drawn():
    """Recording costs the same for 2 km of ground and for 160, for ten stars and for nine thousand."""
    few = {"terrain.source": "fractal", "terrain.extent": 2e3, "sky.star_magnitude_limit": 1.0}
    calls = []
    for changes in (few, few | {"terrain.extent": 160e3, "sky.star_magnitude_limit": 6.5}):
        with fs.Renderer(fs.load("night").updated(changes), size=(64, 36), quality="low") as renderer:
            for index in range(3):
                renderer.render(index)
            calls.append(renderer.stats()["calls"])
    assert calls[0] == calls[1]
