"""Shadows of the land in the air and on clouds: against rays, and none where nothing throws any."""

from __future__ import annotations

import numpy as np
import pytest

import fallstreak as fs
from fallstreak.world.state import height_of, map_coordinates, position_on_planet

EVENING = "2025-07-18T20:50:00+02:00"  # 3 degrees of sun
VALLEY = {"time": EVENING, "models": [], "terrain.vegetation": 0.0}
FLAT = {"terrain": {"source": "fractal", "relief": 0.0}, "camera.height": 40.0}


def slices(world):
    """Share of sunlight in slices of the air (n,); their middles (n, 3), way to the sun; world axes."""
    with fs.Renderer(world, (64, 36), "low") as renderer:
        renderer.render(0)
        shares = renderer.graph.read("sky.shares")[..., 0].astype(float)
        view = renderer.graph.uniforms["view"].record
        sun = np.asarray(renderer.graph.uniforms["sky.light"].record["sun_direction"], float)
        columns, altitude = np.asarray(view["world_from_clip"], float), float(view["altitude"])
    shares /= 255.0 if shares.max() > 1.0 else 1.0
    depth, height, width = shares.shape
    x, y = np.meshgrid(np.linspace(-1, 1, width), np.linspace(1, -1, height))
    ways = (np.stack([x, y, 0 * x, 0 * x + 1], -1) @ columns)[..., :3]
    ways /= np.linalg.norm(ways, axis=-1, keepdims=True)
    radius = world.planet.radius
    reach = 160e3 + np.sqrt(altitude * (2 * radius + altitude))
    distance = reach * ((np.arange(depth) + 0.5) / depth) ** 2
    pose = world.camera.at(0.0)
    eye = position_on_planet(pose.east, pose.north, altitude, radius)
    return shares.ravel(), (eye + distance[:, None, None, None] * ways).reshape(-1, 3), sun


@pytest.mark.parametrize("time", ["2025-07-18T16:36:00+02:00", EVENING])
def test_a_plain_leaves_the_air_all_its_light(time):
    shares, places, _ = slices(fs.load("long_shadows").updated({**VALLEY, **FLAT, "time": time}))
    near = np.linalg.norm(places, axis=1) < 200e3  # beyond, the planet's own shadow begins
    assert shares[near].min() > 0.99


def test_from_where_no_table_is_asked_the_air_is_whole():
    above = {"camera.above": "sea", "camera.height": 26e3, "camera.pitch": -30.0}
    shares, *_ = slices(fs.load("long_shadows").updated({**VALLEY, **above}))
    assert shares.min() == 1.0


def test_air_is_dark_where_rays_meet_the_land():
    towards_sun = {"camera.heading": 300.0, "camera.pitch": -3.0, "camera.height": 100.0}
    world = fs.load("long_shadows").updated({**VALLEY, **towards_sun})
    radius = world.planet.radius
    shares, places, sun = slices(world)
    heights = np.array([height_of(p, radius) for p in places])
    ground = world.terrain.height(*np.array([map_coordinates(p, radius) for p in places]).T)
    dark, lit = ((heights > ground + 20.0) & which for which in (shares < 0.1, shares > 0.99))
    assert dark.sum() > 40
    hidden = [
        np.isfinite(world.terrain.ray(places[which], sun, 100e3).distance).mean() for which in (dark, lit)
    ]
    assert hidden[0] > 0.97  # shares are of slices, rays from their middles
    assert hidden[1] < 0.04


@pytest.mark.parametrize("technique", ["sprites", "puffs", "spheres"])
def test_mountains_shade_clouds(technique):
    """Clouds in a valley lose the sun behind its ridge, clouds over the peaks do not."""
    camera = {"height": 3300.0, "above": "sea", "heading": 0.0, "pitch": -12.0}
    low = {"genus": "cumulus_humilis", "base": 1750.0, "coverage": 0.5, "thickness": 300.0}
    high = {**low, "base": 6000.0}
    found = []
    for layer, pitch in ((low, -12.0), (high, 25.0)):
        changes = {
            **VALLEY,
            "time": "2025-07-18T20:40:00+02:00",
            "camera": {**camera, "pitch": pitch},
            "clouds": {"technique": technique, "shadows": False, "layers": [layer]},
            "film.exposure": "fixed",
        }
        light = []
        for shadows in ("none", "stable"):
            world = fs.load("long_shadows").updated({**changes, "shadows.technique": shadows})
            frame = fs.render(world, size=(160, 90), quality="low", layers=("hdr", "clouds"))
            opaque = frame.clouds > 0.95
            light.append(frame.hdr[opaque].mean())
        assert opaque.sum() > 100
        found.append(light[1] / light[0])
    assert found[0] < 0.7
    assert found[1] == pytest.approx(1.0, abs=0.03)
