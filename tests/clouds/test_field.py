"""The cloud field: the shaders against the float64 twin, wind, life, and that there are no jumps."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

import fallstreak as fs
from fallstreak.clouds.field import field_of, volume
from fallstreak.clouds.field.cells import clouds_of
from fallstreak.clouds.field.model import neighbours
from fallstreak.clouds.genera import GENERA
from fallstreak.clouds.shapes import shipped

from .stage import Stage

FRAMES = [(0.0, 0.0, 0.0), (-53_210.0, 18_000.0, 1234.5), (400e3, -200e3, 259_200.0)]


def world(*genera, coverage=0.5, **more):
    layers = [{"genus": genus, "coverage": coverage, **more} for genus in genera]
    return fs.World(seed=3, clouds={"layers": layers})


def around(east, north, count=4000, reach=6000.0, heights=(300.0, 9000.0)):
    random = np.random.default_rng(1)
    spread = random.uniform(-reach, reach, (count, 2)) + np.array([east, north])
    return np.column_stack([spread, random.uniform(*heights, count)])


@pytest.fixture(scope="module")
def stages(device):
    """All genera in two skies, and one of overcast, where clouds are wider than their models."""
    names = list(GENERA)
    overcast = world("altocumulus", "cumulus_humilis", coverage=0.95)
    return [Stage(device, w) for w in (world(*names[:6]), world(*names[6:]), overcast)]


# ---- shaders and twin ------------------------------------------------------------------------------------


@pytest.mark.parametrize("frame", FRAMES)
def test_the_shaders_find_the_clouds_of_the_twin(stages, frame):
    east, north, time = frame
    for stage in stages:
        records, _ = stage.look(*frame)
        for index, layer in enumerate(stage.field.layers):
            cells = stage.window_cells(index, east, north, time)
            want, got = stage.field.clouds(index, cells, time), records[index].ravel()
            np.testing.assert_array_equal(got["seed"], want["seed"])
            np.testing.assert_array_equal(got["model"], want["model"])
            # a coverage may lie on the edge between none and a cloud: in 24-bit numbers by 1e-5 of it
            np.testing.assert_allclose(got["formation"], want["formation"], atol=2e-5)
            offset = want["place"] - np.array([east, north])
            np.testing.assert_allclose(got["offset"], offset, atol=4e-6 * layer.cell)
            np.testing.assert_allclose(got["base"], want["base"], rtol=1e-6)
            np.testing.assert_allclose(got["yaw"], want["yaw"], atol=1e-6)
            for name in ("scale", "extinction", "radius"):
                np.testing.assert_allclose(got[name], want[name], rtol=2e-5)
            np.testing.assert_allclose(got["swell"], want["swell"], rtol=2e-5, atol=0.01)
            np.testing.assert_allclose(got["top"], want["top"], atol=0.1)


@pytest.mark.parametrize("frame", FRAMES)
def test_the_shaders_give_the_extinction_of_the_twin(stages, frame):
    """Within 3 % of the layers' extinction, as GPUs know places between texels in 8 bits."""
    points = around(*frame[:2])
    for stage in stages:
        _, found = stage.look(*frame, points)
        want = stage.field.extinction(points, frame[2])
        assert (want > 0.0).mean() > 0.03
        error = np.abs(found[:, 0] - want) / max(layer.extinction for layer in stage.field.layers)
        assert error.max() < 0.03 and error.mean() < 0.001


def test_clouds_get_fewer_towards_the_end_of_the_window(device):
    stage = Stage(device, world("altocumulus", "cumulus_humilis", coverage=0.95), ends=True)
    for index, layer in enumerate(stage.field.layers):
        records = stage.look(0.0, 0.0, 0.0)[0][index].ravel()
        away = np.hypot(*records["offset"].T) / ((0.5 * stage.passes.window - 1.0) * layer.cell)
        shares = [
            (records["formation"][(away > low) & (away <= low + 0.1)] > 0.0).mean()
            for low in (0.55, 0.75, 0.85, 1.0)
        ]
        assert shares[0] > shares[1] > shares[2] > shares[3] == 0.0
        np.testing.assert_array_equal(records["radius"] > 0.0, records["formation"] > 0.0)


def test_the_window_ends_without_clouds(stages):
    stage = stages[0]
    layer = stage.field.layers[0]
    far = np.array([[0.6 * stage.passes.window * layer.cell, 0.0, layer.base + 100.0]])
    assert stage.look(0.0, 0.0, 0.0, far)[1][0, 0] == 0.0


# ---- a function of world, time and seed ------------------------------------------------------------------


def test_the_same_world_has_the_same_clouds_and_another_seed_others():
    points = around(0.0, 0.0, 2000, heights=(1000.0, 2000.0))
    sky = world("cumulus_mediocris")
    here = sky.clouds.extinction(points, 77.0)
    np.testing.assert_array_equal(
        here, fs.loads(sky.to_toml(), {"clouds": sky._given["clouds"]}).clouds.extinction(points, 77.0)
    )
    np.testing.assert_array_equal(here[::-1], sky.clouds.extinction(points[::-1], 77.0))
    for changes in ({"seed": 4}, {"clouds.layers": [{"genus": "cumulus_mediocris", "seed": 9}]}):
        assert np.abs(sky.updated(changes).clouds.extinction(points, 77.0) - here).mean() > 1e-4


def test_two_layers_of_one_genus_differ():
    field = field_of(world("cirrus", "cirrus"))
    assert field.layers[0].seed != field.layers[1].seed


def test_clouds_drift_with_the_wind_and_keep_their_shape():
    sky = world("stratus", wind_speed=12.0, wind_from=250.0)
    points = around(0.0, 0.0, 3000, heights=(280.0, 700.0))
    here = sky.clouds.extinction(points, 0.0)
    towards = np.radians(270.0 - 250.0)
    moved = points + 600.0 * 12.0 * np.array([np.cos(towards), np.sin(towards), 0.0])
    assert here.max() > 0.02
    np.testing.assert_allclose(sky.clouds.extinction(moved, 600.0), here, atol=1e-9)


def test_clouds_form_and_dissolve_without_a_jump():
    """Formation changes by no more than its fastest ramp, all else only while there is no cloud."""
    layer = field_of(world("cumulus_humilis")).layers[0]
    i, j = np.meshgrid(np.arange(20), np.arange(20))
    cells = np.stack([i.ravel(), j.ravel()], 1)
    times = np.linspace(0.0, 2.0 * layer.lifetime, 801)
    still = replace(layer, wind=(0.0, 0.0))
    frames = [clouds_of(still, cells, t, np.full(len(cells), 0.8)) for t in times]
    formation = np.stack([f["formation"] for f in frames])
    # 1.5 is the steepest slope of smoothstep; .06 of coverage's step makes no difference to time
    assert np.abs(np.diff(formation, axis=0)).max() < 1.5 / 0.18 * 2.0 / 800 * 1.05
    assert formation.max() == 1.0 and (formation.max(0) > 0.0).mean() > 0.75
    for before, after in pairwise(frames):
        born_anew = before["seed"] != after["seed"]
        assert before["formation"][born_anew].max(initial=0.0) < 0.005
        assert after["formation"][born_anew].max(initial=0.0) < 0.005
        np.testing.assert_array_equal(before["place"][~born_anew], after["place"][~born_anew])
        change = np.abs(after["scale"] - before["scale"])[~born_anew] / before["scale"][~born_anew]
        assert change.max(initial=0.0) < 0.03


def test_extinction_does_not_jump_in_time():
    sky = world("cumulus_mediocris", wind_speed=0.0)
    points = around(0.0, 0.0, 4000, heights=(1000.0, 2000.0))
    full = GENERA["cumulus_mediocris"].extinction
    steps = [sky.clouds.extinction(points, t) for t in np.arange(500.0, 505.0, 0.25)]
    coarse = np.abs(np.diff(steps[::2], axis=0)).max()
    fine = np.abs(np.diff(steps, axis=0)).max()
    assert 0.0 < fine < 0.6 * coarse < 0.2 * full  # halving the step halves the change


# ---- what clouds are like --------------------------------------------------------------------------------


def test_the_noise_is_what_the_script_bakes():
    """If this fails, run script/calibrate_clouds.py."""
    difference = np.abs(volume.volume().astype(int) - volume.baked())
    assert difference.max() <= 1 and difference.mean() < 1e-3


def test_noise_repeats_and_is_as_often_dark_as_bright():
    points = np.random.default_rng(0).uniform(-3.0, 3.0, (500, 3))
    values = volume.sample(points)
    np.testing.assert_allclose(volume.sample(points + np.array([1.0, -2.0, 5.0])), values, atol=1e-9)
    np.testing.assert_allclose(values.mean(0), 0.5, atol=0.05)


def test_every_genus_has_models():
    names = shipped()
    for genus in GENERA:
        assert any(n == genus or n.startswith(f"{genus}_") for n in names)


@pytest.mark.parametrize("genus", GENERA)
def test_all_matter_lies_within_the_bounds_of_layer_and_clouds(genus):
    field = field_of(world(genus, coverage=0.6))
    layer = field.layers[0]
    low, high = layer.bounds
    i, j = np.meshgrid(np.arange(40), np.arange(40))
    clouds = field.clouds(0, np.stack([i.ravel(), j.ravel()], 1), 5000.0)
    clouds = clouds[clouds["formation"] > 0.0]
    assert clouds["top"].max() < high and clouds["base"].min() > low
    assert np.ptp(clouds["base"]) > 0.5 * layer.base_spread  # bases are not aligned to the metre
    # ellipsoids keep within their own cell and those around, so that nine cells are enough
    place = np.abs(clouds["place"] - np.asarray(layer.wind) * 5000.0 - layer.cell * 20.0)
    assert place.max() < 20.5 * layer.cell
    packed = field.packed.models["bounds"][clouds["model"]]
    reach = (packed[:, 0] + 1.15 * clouds["swell"]) * clouds["scale"][:, 0]
    assert reach.max() < 1.5 * layer.cell


def test_extinction_follows_from_water_and_drops():
    """shared/references: .3 g/m³ of drops of 10 µm have .045 1/m, 1 g/m³ of 12 µm .125 1/m."""
    genus = GENERA["cumulonimbus"]
    assert replace(genus, water=0.3, drop=10.0).extinction == pytest.approx(0.045)
    assert genus.extinction == pytest.approx(0.125)


@pytest.mark.parametrize("far", [10, 10_000_000])
def test_neighbours_are_the_cells_around(far):
    cells = np.array([[0, 0], [1, 0], [0, 0], [far, -far]])
    found, rows = neighbours(cells)
    assert len(np.unique(found, axis=0)) == len(found)
    offsets = np.stack(np.meshgrid(np.arange(-1, 2), np.arange(-1, 2)), -1).reshape(-1, 2)
    for cell, row in zip(cells, rows, strict=True):
        assert {tuple(c) for c in found[row]} == {tuple(cell + o) for o in offsets}
