"""Water: where it lies, how steep its waves are near and far, and what colour depth has."""

from __future__ import annotations

import numpy as np
import pytest
from ground import Ground

import fallstreak as fs
from fallstreak.terrain.water import SCALES, STEEPEST, slope_variance, wave_picture

LEVEL = 380.0
WATER_ID = 1
LAKE = (16_500.0, -12_250.0)  # 40 m of water over jacksboro's valleys


@pytest.fixture(scope="module")
def lake(device):
    return Ground(device, quality="high", overrides=[f"terrain.water_level={LEVEL}", "terrain.wind=5"])


def decoded(ground):
    """Material, roughness, normal (world) of every pixel."""
    surface = ground.read("gbuffer.surface").astype(float)
    code = ground.read("gbuffer.normal")
    p = (np.stack([code & 1023, code >> 10 & 1023], -1) - 511.0) / 511.0
    z = 1.0 - np.abs(p).sum(-1)
    fold = np.maximum(-z, 0.0)[..., None]
    normal = np.concatenate([p - np.where(p >= 0.0, fold, -fold), z[..., None]], -1)
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    return np.round(surface[..., 3]).astype(int), surface[..., 0] / 255.0, normal


def test_waves_keep_their_slope_at_every_scale():
    picture, kept = wave_picture(0)
    slopes = (picture[..., :2] / 255.0 - 0.5) * 2.0 * STEEPEST
    assert (slopes**2).sum(-1).mean() == pytest.approx(1.0, rel=0.03)
    assert kept[0] == pytest.approx(1.0) and kept[-1] == 0.0 and (np.diff(kept) <= 0.0).all()
    # waves run with the wind: more slope along than across, and none of one direction alone
    assert 1.5 < (slopes[..., 0] ** 2).mean() / (slopes[..., 1] ** 2).mean() < 6.0
    # neighbouring scales join: the shortest wave of one is the longest of the next
    assert SCALES[1] / 64.0 == SCALES[0] / 4.0
    assert slope_variance(5.0) == pytest.approx(0.0286) and slope_variance(0.0) == 0.003


def test_water_lies_level_where_the_land_is_lower(lake):
    state = lake.draw(18_500.0, -12_250.0, 2000.0, 262.0, -25.0)
    east, north, height, distance, x, y = lake.points(state)
    material = decoded(lake)[0][y, x]
    land = lake.terrain.model.shape(east, north, 1.0)
    sure = np.abs(land.water - land.height) > 0.003 * distance  # a pixel or the mesh's error from the shore
    wet = land.height < land.water
    assert sure.mean() > 0.8 and 0.1 < wet[sure].mean() < 0.95
    assert (material[sure] == WATER_ID).mean() == pytest.approx(wet[sure].mean(), abs=0.01)
    # far from any shore for the mesh of so small a picture
    open_water = land.water - land.height > 0.008 * distance
    assert (
        open_water.sum() > 1000 and np.percentile(np.abs(height[open_water] - LEVEL), 99) < 0.15
    )  # chords of the sphere
    # what stands in the picture's depth is what the query says
    assert (lake.world.terrain.height(east, north)[sure & wet] == LEVEL).all()


def test_slopes_and_roughness_together_are_cox_and_munks(lake):
    """From the boat to the plane: what the picture no longer resolves is in the roughness."""
    sums, resolved = [], []
    for above in (3.0, 30.0, 300.0, 3000.0):
        slopes, rough = [], []
        for i in range(6):  # gusts differ from place to place
            lake.draw(LAKE[0] + 130.0 * i, LAKE[1] - 90.0 * i, above, 60.0 * i, -89.9, 20.0)
            material, roughness, normal = decoded(lake)
            water = material == WATER_ID
            assert water.mean() > 0.8
            slopes.append(((normal[water, :2] / normal[water, 2:]) ** 2).sum(-1).mean())
            rough.append((roughness[water] ** 4).mean())
        resolved.append(np.mean(slopes))
        sums.append(np.mean(slopes) + np.mean(rough))
    assert np.allclose(sums, slope_variance(5.0), rtol=0.2)
    assert resolved[0] > 0.4 * sums[0] and resolved[-1] < 0.1 * sums[-1]
    assert (np.diff(resolved) < 0.0).all()


def test_deep_water_is_darker_than_its_shore(lake):
    state = lake.draw(14_000.0, -12_900.0, 120.0, 300.0, -35.0)
    east, north, _, _, x, y = lake.points(state)
    land = lake.terrain.model.shape(east, north, 1.0)
    depth = land.water - land.height
    albedo = ((lake.read("gbuffer.albedo")[..., :3] / 255.0) ** 2)[y, x].mean(-1)
    water = decoded(lake)[0][y, x] == WATER_ID
    shallow, deep = water & (depth > 0.2) & (depth < 0.8), water & (depth > 8.0)
    assert shallow.sum() > 20 and deep.sum() > 200
    assert albedo[shallow].mean() > 1.3 * albedo[deep].mean()
    assert np.ptp(albedo[deep]) < 0.01  # no bed shows


def test_waves_move_and_come_back_the_same(device):
    pictures = []
    world = fs.load(
        "jacksboro",
        [
            f"terrain.water_level={LEVEL}",
            f"camera.east={LAKE[0]}",
            f"camera.north={LAKE[1]}",
            "camera.height=5",
            "camera.pitch=-20",
        ],
    )
    with fs.Renderer(world, size=(96, 54), quality="low", layers=("normal",)) as renderer:
        for index in (0, 12, 0):
            pictures.append(np.array(renderer.render(index).normal))
    assert np.array_equal(pictures[0], pictures[2], equal_nan=True)
    assert np.nanmean(np.abs(pictures[0] - pictures[1])) > 0.01


def test_worlds_without_water_do_not_pay_for_it(device):
    dry, wet = Ground(device), Ground(device, overrides=["terrain.water_level=300"])
    flags = [
        request["flags"]["WATER"]
        for ground in (dry, wet)
        for request in ground.graph.shader_requests
        if request["module"] == "package::terrain::draw"
    ]
    assert flags == [False, True]
    assert fs.load("jacksboro", ["terrain.surroundings=sea"]).terrain.has_water
    assert not fs.load("orbit").terrain.has_water
