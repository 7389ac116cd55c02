"""Sphere clouds: groups, atlas, colours between light and shadow, the same clouds as the field, inside."""

from __future__ import annotations

import numpy as np
import pytest

import fallstreak as fs
from fallstreak.clouds import polar
from fallstreak.clouds.field import field_of
from fallstreak.clouds.shapes import load, shipped
from fallstreak.clouds.spheres.atlas import TILE, sections
from fallstreak.clouds.spheres.groups import MOST, filled, group
from fallstreak.clouds.spheres.passes import MOST_NEAR
from fallstreak.world import QUALITY

WORLD = {
    "place": {"latitude": 20.0, "longitude": -157.0},
    "time": "2025-06-21T12:00-10:00",
    "planet": {"surface": "ocean"},
    "camera": {"height": 250.0, "above": "sea", "heading": 40.0, "pitch": 16.0, "fov": 60.0},
    "clouds": {
        "technique": "spheres",
        "layers": [{"genus": "cumulus_mediocris", "coverage": 0.35, "lifetime": 0.0, "wind_speed": 0.0}],
    },
}


def world(**changes):
    return fs.World(name="spheres", **WORLD).updated(changes)


@pytest.mark.parametrize("model", load(list(shipped()), None), ids=lambda model: model.name)
def test_a_group_covers_its_model_and_stays_with_it(model):
    spheres = group(model)
    assert len(model.boxes) < len(spheres) <= MOST
    assert (spheres == group(model)).all()
    assert (spheres["axes"] > 0.0).all()
    turned = np.stack(
        [
            spheres["cosine"] * spheres["offset"][:, 0] - spheres["sine"] * spheres["offset"][:, 1],
            spheres["sine"] * spheres["offset"][:, 0] + spheres["cosine"] * spheres["offset"][:, 1],
        ],
        1,
    )
    middle = spheres["centre"][:, :2] + turned
    assert np.hypot(*middle.T).max() < model.radius
    assert (spheres["centre"][:, 2] + spheres["offset"][:, 2]).max() < model.height
    # sections hold it: about as much as the field's own bounds
    assert ((filled(model, spheres) > 0.8) & (filled(model, spheres) < 1.35)).all()


@pytest.mark.parametrize("quality", QUALITY.values(), ids=list(QUALITY))
def test_sections_fill_the_atlas_and_do_not_overlap(quality):
    table, height = sections(quality.cloud_sections, quality.cloud_atlas)
    assert max(height, quality.cloud_atlas) <= 4096
    used = np.zeros((height // TILE, quality.cloud_atlas // TILE), int)
    for x, y, size, _ in table // np.array([TILE, TILE, TILE, 1], np.uint32):
        used[y : y + size, x : x + size] += 1
    assert used.max() == 1


def test_oklch_there_and_back():
    colours = np.random.default_rng(1).random((1000, 3)) * 50.0 + 1e-3
    np.testing.assert_allclose(polar.from_oklch(polar.oklch(colours)), colours, rtol=1e-9)
    # white has no chroma; sRGB's red by Ottosson's own figures
    np.testing.assert_allclose(polar.oklch(np.ones(3))[:2], [1.0, 0.0], atol=1e-6)
    lightness, chroma, hue = polar.oklch(np.array([1.0, 0.0, 0.0]))
    np.testing.assert_allclose(
        [lightness, lightness * chroma, np.degrees(hue)], [0.62796, 0.25768, 29.234], rtol=1e-4
    )


def test_what_lies_between_shadow_and_light_is_saturated():
    shadow, full = np.array([0.10, 0.16, 0.30]), np.array([1.9, 1.2, 0.7])
    share = np.linspace(0.0, 1.0, 33)
    mixed = polar.blended(shadow, full, share)
    plain = shadow + share[:, None] * (full - shadow)
    luminance = np.array([0.2126, 0.7152, 0.0722])
    np.testing.assert_allclose(mixed @ luminance, plain @ luminance, rtol=1e-12)
    np.testing.assert_allclose(mixed[[0, -1]], plain[[0, -1]], rtol=1e-6)
    # the straight line passes grey, this one keeps away from it
    assert polar.oklch(mixed)[:, 1].min() > 1.1 * polar.oklch(plain)[:, 1].min()
    # and grows evenly: no step is larger than a few of the mean one
    steps = np.abs(np.diff(mixed, axis=0)).max(1)
    assert steps.max() < 4.0 * steps.mean()


def test_colours_of_one_hue_are_added_plainly():
    shadow = np.array([0.2, 0.1, 0.05])
    mixed = polar.blended(shadow, 5.0 * shadow, np.array([0.3]))
    np.testing.assert_allclose(mixed, [shadow * (1.0 + 0.3 * 4.0)], rtol=1e-6)


@pytest.fixture(scope="module")
def seen():
    """Alpha of the clouds' picture, and the field's optical depth along the same rays."""
    place = world()
    size = (96, 64)
    with fs.Renderer(place, size, "high", still=True, layers=("clouds",)) as renderer:
        renderer.render()
        alpha = np.array(renderer.graph.read("clouds.layer"))
        state = renderer.state(0)
    alpha = alpha.view(np.float16).reshape(size[1], size[0], 4)[..., 3].astype(float)
    f = 1.0 / np.tan(state.camera.fov / 2.0)
    x = (2.0 * (np.arange(size[0]) + 0.5) / size[0] - 1.0) * size[0] / size[1] / f
    y = (1.0 - 2.0 * (np.arange(size[1]) + 0.5) / size[1]) / f
    rays = np.stack(np.broadcast_arrays(x[None], y[:, None], -1.0), -1) @ state.camera.rotation.T
    rays /= np.linalg.norm(rays, axis=-1, keepdims=True)
    return place, alpha, rays


def test_the_same_clouds_as_the_field(seen):
    place, alpha, rays = seen
    start = np.array([0.0, 0.0, 250.0])
    up = rays[..., 2] > 0.06  # nearer than 40 km, where the earth is flat enough
    away = 6000.0 / np.maximum(rays[..., 2:], 0.06)
    depth = place.clouds.optical_depth(start, start + rays * away)
    field, drawn = (depth > 1.0) & up, (alpha > 0.6) & up
    overlap = (field & drawn).sum() / (field | drawn).sum()
    assert 0.1 < field[up].mean() < 0.9
    assert overlap > 0.7, f"IoU {overlap:.3f}"


def test_the_nearest_clouds_are_drawn_and_always_the_same():
    # within a closed layer more clouds are about the camera than there is room for
    place = world(
        clouds={
            "technique": "spheres",
            "layers": [{"genus": "stratocumulus", "coverage": 1.0, "size": 1.5}] * 4,
        },
        camera={"height": 1350.0},
    )
    pictures, near = [], []
    for _ in range(2):
        with fs.Renderer(place, (48, 32), "low", still=True, layers=("clouds",)) as renderer:
            renderer.render()
            pictures.append(np.array(renderer.graph.read("clouds.layer")))
            about = np.array(renderer.graph.read("clouds.spheres.counts")).view(np.uint32)[0]
            items = np.array(renderer.graph.read("clouds.spheres.items")).view(np.float32)[4:]
            near.append(items.reshape(-1, 12)[:MOST_NEAR, :3].copy())
    assert about > MOST_NEAR
    assert (np.diff(np.linalg.norm(near[0], axis=1)) >= 0.0).all()
    np.testing.assert_array_equal(*near)
    np.testing.assert_array_equal(*pictures)


def test_inside_agrees_with_the_picture():
    place = world()
    rng = np.random.default_rng(4)
    points = np.column_stack([rng.uniform(-4e3, 4e3, (4000, 2)), rng.uniform(1100.0, 1700.0, 4000)])
    share = place.clouds.extinction(points) / field_of(place).layers[0].extinction
    # the GPU's extinction is the twin's within .02 of the layer's: keep off the border by that
    deep = points[np.argsort(-share)[:1]]
    border = points[(share > 0.12) & (share < 0.2)][:1]
    outside = np.concatenate([points[share == 0.0][:1], points[(share > 0.02) & (share < 0.08)][:1]])
    for point in (*deep, *border, *outside):
        east, north, height = (float(v) for v in point)
        camera = {"east": east, "north": north, "height": height, "pitch": -20.0}
        expected = bool(place.clouds.inside(point))
        with fs.Renderer(
            place.updated({"camera": camera}), (32, 18), "low", still=True, layers=("clouds",)
        ) as renderer:
            renderer.render()
            layer = np.array(renderer.graph.read("clouds.layer")).view(np.float16).reshape(-1, 4)
            code = layer[:, 2].astype(float) / np.maximum(layer[:, 3], 1e-3)
            # fog is opaque and equally near all around
            fog = bool(
                (layer[:, 3] > 0.98).all() and np.ptp(code) < 0.01 and code.max() * 24.0 < np.log2(400.0)
            )
        assert fog == expected, point


def test_the_shadow_side_of_a_tower_tells_how_deep_it_is():
    """Against the light thin lobes glow and the thick middle is dark; crevices have less of the sky."""
    place = fs.load("towering", ["clouds.technique=spheres"])
    with fs.Renderer(place, (160, 90), "medium", still=True, samples=1, layers=("clouds",)) as renderer:
        renderer.render()
        size = renderer.pipeline.clouds.size
        layer = np.array(renderer.graph.read("clouds.layer")).view(np.float16).reshape(size[1], size[0], 4)
    tower = layer[size[1] // 6 : size[1] * 7 // 10, size[0] // 6 : size[0] * 11 // 20].astype(float)
    tower = tower[tower[..., 3] > 0.9]
    key, sky = (np.percentile(tower[:, i] / tower[:, 3], [10, 90]) for i in range(2))
    assert key[1] > 2.0 * key[0]
    assert sky[1] > 1.5 * sky[0]
