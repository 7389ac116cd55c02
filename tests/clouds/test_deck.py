"""A closed deck of clouds in all techniques: as bright below as what it lets down, and one fog within."""

from __future__ import annotations

import numpy as np
import pytest

import fallstreak as fs
from fallstreak.clouds.light import facing_within, key_light

TECHNIQUES = ("sprites", "puffs", "spheres")
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
HOURS = {"noon": "2025-10-20T12:55:00-04:00", "evening": "2025-10-20T18:15:00-04:00"}


def deck(technique: str, hour: str, **camera) -> fs.World:
    layer = {"genus": "stratocumulus", "coverage": 1.0, "base": 1500.0, "lifetime": 0.0}
    return fs.World(
        name="deck",
        time=HOURS[hour],
        place={"latitude": 36.6, "longitude": -84.2},
        planet={"surface": "ocean"},
        camera={"above": "sea", **camera},
        clouds={"technique": technique, "layers": [layer]},
    )


def test_all_techniques_let_down_as_much_light():
    light = {}
    for technique in TECHNIQUES:
        world = deck(technique, "noon", height=50.0, pitch=89.9, fov=100.0)
        hdr = fs.render(world, (48, 48), "low").hdr
        assert hdr is not None
        light[technique] = float((hdr @ LUMINANCE).mean())
    least, _, most = sorted(light.values())
    assert most < 1.6 * least


@pytest.mark.parametrize("hour", HOURS)
def test_fog_in_a_deck_is_lit_from_above(hour):
    """Its light from the sun is that of a slab at the slant of the sun, whatever draws it."""
    found = {}
    place = deck("spheres", hour)
    heading = {"noon": 0.0, "evening": 75.0}[hour]  # away from the sun
    heights = np.arange(1550.0, 1900.0, 25.0)
    matter = place.clouds.extinction([[0.0, 0.0, h] for h in heights], 0.0)
    height = float(heights[np.argmax(matter)])
    eye = np.array([0.0, 0.0, height])
    for technique in TECHNIQUES:
        world = deck(technique, hour, height=height, pitch=0.0, heading=heading)
        with fs.Renderer(world, (32, 32), "low", still=True, samples=1) as renderer:
            renderer.render()
            layer = np.array(renderer.graph.read("clouds.layer")).view(np.float16).reshape(-1, 4)
            key = renderer.pipeline.clouds.key
        mean = layer.astype(float).mean(0)
        assert mean[3] > 0.9
        found[technique] = mean[0] / mean[3]
    way = 4e3 * np.array([key, -key, [0, 0, 1], [0, 0, -1]])
    ahead, behind, above, below = (float(world.clouds.optical_depth(eye, eye + w, 0.0)) for w in way)
    slab = key_light(ahead, behind, facing_within(above + below, ahead + behind), np.linspace(-1.0, -0.5, 9))
    assert 0.6 * slab.min() < found["spheres"] < 1.4 * slab.max()
    assert max(found.values()) < 0.25 + 2.0 * min(found.values())


@pytest.mark.parametrize("technique", ("sprites", "spheres"))
def test_a_deck_goes_on_to_the_horizon(technique):
    """Beyond the last clouds that are drawn, a degree above the sea, there is no strip of blue sky."""
    world = deck(technique, "noon", height=50.0, pitch=0.8, fov=2.0)
    hdr = fs.render(world, (24, 64), "low").hdr
    assert hdr is not None
    rows = hdr.astype(float).mean(1)
    elevation = 0.8 + (31.5 - np.arange(64)) / 32.0
    above = rows[elevation > 0.05]
    bluish = above[:, 2] / above[:, 0]
    assert bluish.max() < 1.05
    bright = above @ LUMINANCE
    assert bright.max() < 1.5 * bright.min()
