"""Sprites: what is drawn is what the field has, every time the same, with as many calls for any sky."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

import fallstreak as fs
from fallstreak.clouds.field import field_of
from fallstreak.clouds.grain import STEEPEST, grain
from fallstreak.world.state import map_coordinates

SIZE = (96, 54)
SKY = fs.World.model_validate(
    {
        "name": "sprites",
        "time": "2025-06-21T12:00:00+00:00",
        "planet": {"surface": "ocean"},
        "camera": {"height": 1500.0, "above": "sea", "heading": 40.0, "pitch": 2.0, "fov": 50.0},
        "clouds": {"technique": "sprites", "layers": [{"genus": "cumulus_mediocris", "coverage": 0.3}]},
    }
)


def test_the_grain_is_the_noise_and_its_slope():
    look = (1.0, 0.0, 0.0, 0.0)
    made = grain([look, (0.0, 1.0, 0.0, 0.0)]).astype(float) / 255.0
    assert made.shape == (132, 64, 64, 4)
    value = made[1:65, ..., 3]
    assert value.mean() == pytest.approx(0.5, abs=0.01)
    slope = 0.5 * 64 * (np.roll(value, -1, 2) - np.roll(value, 1, 2))
    told = (made[1:65, ..., 0] - 0.5) * 2 * STEEPEST
    kept = np.abs(slope) < STEEPEST - 1
    assert np.abs(told - slope)[kept].max() < 0.2
    # the texel beyond either end is the other end's
    np.testing.assert_array_equal(made[0], made[64])
    np.testing.assert_array_equal(made[65], made[1])


def optical_depth(world: fs.World, reach: float) -> np.ndarray:
    """Of the field, along the rays of a picture's pixels."""
    with fs.Renderer(world, SIZE, "low", still=True) as renderer:
        state = renderer.state(0)
    camera, radius = state.camera, state.planet_radius
    eye = np.array([*map_coordinates(camera.position, radius), state.altitude])
    y, x = np.mgrid[0 : SIZE[1], 0 : SIZE[0]] + 0.5
    tangent = np.tan(camera.fov / 2.0)
    across = (2.0 * x / SIZE[0] - 1.0) * tangent * SIZE[0] / SIZE[1]
    rays = np.stack([across, (1.0 - 2.0 * y / SIZE[1]) * tangent, -np.ones_like(x)], -1) @ camera.rotation.T
    rays /= np.linalg.norm(rays, axis=-1, keepdims=True)
    depth = np.zeros(SIZE[::-1])
    cuts = np.append(0.0, np.geomspace(3e3, reach, 5))
    ends = [eye + s * rays for s in cuts]
    for end, s in zip(ends, cuts, strict=True):
        end[..., 2] += 0.5 * s * s * (1.0 - rays[..., 2] ** 2) / radius
    for a, b in itertools.pairwise(ends):
        depth += np.where(a[..., 2] > 0.0, world.clouds.optical_depth(a, b), 0.0)
    return depth


@pytest.mark.parametrize("pose", [{}, {"camera.height": 300.0, "camera.pitch": 30.0}])
def test_drawn_is_what_the_field_has(pose):
    world = SKY.updated({**pose, "clouds.visibility": 25e3})
    opacity = fs.render(world, SIZE, "medium", samples=1, layers=("clouds",)).clouds
    there, drawn = optical_depth(world, 25e3) > 1.0, opacity > 0.6
    agree = (there & drawn).sum() / (there | drawn).sum()
    print(f"\nIoU {agree:.3f}, of the picture {there.mean():.3f} are cloud, {drawn.mean():.3f} drawn")
    assert 0.05 < there.mean() < 0.9
    assert agree >= 0.7


@pytest.mark.parametrize("sky", ["usual", "artist"])
def test_a_frame_repeats_on_another_device(sky):
    world = SKY if sky == "usual" else SKY.updated({"clouds.colours": "artist"})
    first, second = (fs.render(world, SIZE, "low").ldr for _ in range(2))
    np.testing.assert_array_equal(first, second)


def test_more_clouds_are_more_sprites_but_not_more_calls():
    found = []
    for coverage in (0.05, 0.8):
        layers = [{"genus": "cumulus_humilis", "coverage": coverage}]
        with fs.Renderer(SKY.updated({"clouds.layers": layers}), SIZE, "low", still=True) as renderer:
            renderer.render(0)
            counts = renderer.pipeline.clouds.technique.counts()
            found.append((counts["clouds"], counts["sprites"], renderer.stats()["calls"]))
    (few, fewer, calls), (many, more, calls_of_many) = found
    assert few < many
    assert fewer < more <= 32768
    assert calls == calls_of_many


def test_from_inside_of_a_cloud_nothing_else_is_seen():
    field = field_of(SKY)
    cells = np.stack(np.meshgrid(np.arange(-6, 6), np.arange(-6, 6)), -1).reshape(-1, 2)
    clouds = field.clouds(0, cells, 0.0)
    cloud = clouds[np.argmax(clouds["formation"] * (clouds["top"] - clouds["base"]))]
    height = cloud["base"] + 0.25 * (cloud["top"] - cloud["base"])
    steps = np.stack(np.meshgrid(*[np.linspace(-400, 400, 17)] * 2), -1).reshape(-1, 2)
    places = np.column_stack([cloud["place"] + steps, np.full(len(steps), height)])
    dense = SKY.clouds.extinction(places)
    place = places[np.argmax(dense)]
    assert SKY.clouds.inside(place)
    pose = {"camera.east": place[0], "camera.north": place[1], "camera.height": place[2]}
    opacity = fs.render(SKY.updated(pose), SIZE, "low", samples=1, layers=("clouds",)).clouds
    assert np.quantile(opacity, 0.02) > 0.95  # nor between its boxes


def test_light_changes_slowly_over_a_cloud():
    """From pixel to pixel by an eighth; where noise bends normals as much as it can, by a quarter: stone."""
    pose = {"east": -1300.0, "north": -8900.0, "height": 1500.0, "heading": 300.0, "pitch": 18.0}
    world = fs.load("towering", ["time=2025-03-09T15:30:00-10:00", "clouds.technique=sprites"])
    world = world.updated({f"camera.{key}": value for key, value in pose.items()})
    frame = fs.render(world, (320, 180), "high", samples=1, layers=("hdr", "clouds"))
    level = np.log(frame.hdr[..., :3] @ [0.2126, 0.7152, 0.0722] + 1e-6)
    step = np.hypot(np.diff(level, axis=0)[:, 1:], np.diff(level, axis=1)[1:])
    cloud = frame.clouds > 0.99
    within = cloud[1:, 1:] & cloud[:-1, 1:] & cloud[1:, :-1]
    print(f"\nmean step {step[within].mean():.3f} of {within.mean():.2f} of the picture")
    assert within.mean() > 0.15
    assert step[within].mean() < 0.16
