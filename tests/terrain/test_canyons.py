"""Canyons: the GPU's land is the CPU's, walls lean over without meeting, rivers flow, colours last."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from shader_probes import find_probes

from fallstreak.gpu import FrameGraph
from fallstreak.terrain.cover.canyon import PALETTE, cover
from fallstreak.terrain.cover.cover import Sites
from fallstreak.terrain.land.canyons import Canyons
from fallstreak.terrain.land.canyons_network import gorges
from fallstreak.terrain.land.canyons_strata import FALL
from fallstreak.terrain.land.shape import LAND
from fallstreak.terrain.materials import MATERIALS

SEED = 104  # as in the probe
VALUES = {"base_height": 1600.0, "relief": 350.0, "feature_size": 3e3, "roughness": 0.5, "water_level": -1e5}
PLACE = [
    ("tile", "<i4", 2), ("local", "<f4", 2), ("step", "<f4"), ("height", "<f4"), ("unused", "<f4", 2),
    ("normal", "<f4", 3), ("slope", "<f4"), ("water", "<f4"), ("open", "<f4"), ("unused2", "<f4", 2),
]  # fmt: skip


@pytest.fixture(scope="module")
def land():
    return Canyons(SimpleNamespace(**VALUES), SEED)


@pytest.fixture
def probe(monkeypatch):
    """The GPU finds the shaders beside this file as modules of the package."""
    find_probes(monkeypatch, __file__)


def on_gpu(device, entry, east, north, step, **fields):
    """What an entry of the probe says of places; (n, 12)."""
    count = -(-len(east) // 64) * 64
    places = np.zeros(count, PLACE)
    for axis, x in enumerate((east, north)):
        places["tile"][: len(east), axis] = np.floor(x / 4096.0) * 4096
        places["local"][: len(east), axis] = x - places["tile"][: len(east), axis]
    for name, values in {"step": step, **fields}.items():
        places[name][: len(east)] = values
    graph = FrameGraph(device)
    graph.uniform("land", LAND).set(**VALUES)
    graph.buffer_data("places", places.view(np.uint8))
    graph.buffer("found", count * 48)
    graph.compute(
        "probe", "package::canyons_probe", entry=entry, groups=(count // 64, 1, 1), structs=[LAND],
        bind={"places": "places", "found": "found"} | ({"land": "land"} if entry == "shapes" else {}),
    )  # fmt: skip
    graph.output("found")
    graph.compile()
    graph.execute()
    return graph.read("found").view(np.float32).reshape(-1, 12)[: len(east)].astype(float)


def scattered(count=2000, reach=150e3, seed=0):
    """Places that single precision knows exactly within their tile, and steps from 0.3 to 500 m."""
    rng = np.random.default_rng(seed)
    east, north = np.round(rng.uniform(-reach, reach, (2, count)) * 1024.0) / 1024.0
    return east, north, np.float32(0.3 * (500.0 / 0.3) ** rng.uniform(0.0, 1.0, count)).astype(float)


def patch(east, north, width, count, seed=0):
    """One place at random in each of count² squares."""
    rng = np.random.default_rng(seed)
    across = (np.arange(count) + rng.uniform(size=(count, count))) / count - 0.5
    along = (np.arange(count)[:, None] + rng.uniform(size=(count, count))) / count - 0.5
    return east + width * across, north + width * along


def sites(land, east, north, step):
    """Places as the surface pass shows them to the cover."""
    here, e, w, n, s = (
        land.shape(east + i * step, north + j * step, step)
        for i, j in ((0, 0), (1, 0), (-1, 0), (0, 1), (0, -1))
    )
    zero = np.zeros_like(here.height)

    def along(a, b, i, j):
        return np.stack(
            [
                2.0 * step * i + a.shift_east - b.shift_east,
                2.0 * step * j + a.shift_north - b.shift_north,
                a.height - b.height,
            ],
            -1,
        )

    normal = np.cross(along(e, w, 1, 0), along(n, s, 0, 1))
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    steep = np.hypot(normal[..., 0], normal[..., 1]) / np.maximum(normal[..., 2], 0.05)
    return Sites(
        east, north, step, SEED, here.height, normal, np.hypot(steep, here.lost), zero, zero,
        here.water - here.height, here.open, zero + 1.0,
    )  # fmt: skip


def test_the_gpu_s_land_is_the_cpu_s(device, probe, land):
    east, north, step = scattered(4000)
    found = on_gpu(device, "shapes", east, north, step)
    want = land.shape(east, north, step)
    bounds = {
        "height": 5e-3,
        "water": 1e-3,
        "shift_east": 2e-3,
        "shift_north": 2e-3,
        "lost": 1e-3,
        "open": 1e-3,
    }
    for i, (name, bound) in enumerate(bounds.items()):
        error = np.abs(found[:, i] - getattr(want, name))
        # on a cliff, where single precision's half millimetre along the map is several in height
        assert np.quantile(error, 0.99) < bound and error.max() < 0.1, name


def test_the_gpu_s_cover_is_the_cpu_s(device, probe, land):
    east, north, step = scattered(1500, seed=1)
    site = sites(land, east, north, step)
    found = on_gpu(
        device, "covers", east, north, step, height=site.height, normal=site.normal, slope=site.slope,
        water=site.water, open=site.open,
    )  # fmt: skip
    want = cover(site)
    both = (
        (found[:, :6], want.weights),
        (found[:, 6], want.wetness),
        (found[:, 7], want.growth),
        (found[:, 8:11], want.tint),
    )
    for a, b in both:
        error = np.abs(a - b)
        # a height in single precision is 0.1 mm off: a few places change beds
        assert np.quantile(error, 0.99) < 2e-3, error.max()


def test_everything_stays_within_what_is_promised(land):
    east, north, step = scattered(60_000, seed=2)
    found = land.shape(east, north, step)
    low, high = land.bounds()
    assert found.height.min() > low and found.height.max() < high
    assert np.hypot(found.shift_east, found.shift_north).max() < land.shift_bound
    assert found.open.min() > 0.02 and found.open.max() <= 1.0 + 1e-9 and found.lost.min() >= 0.0
    assert all(np.isfinite(getattr(found, name)).all() for name in vars(found))


def test_steps_of_all_lengths_have_the_same_mean_height(land):
    east, north = patch(0.0, 0.0, 48e3, 160)
    means = np.array(
        [land.shape(east, north, step).height.mean() for step in (1.0, 30.0, 120.0, 250.0, 500.0, 1000.0)]
    )
    assert np.abs(means - means[0]).max() < 0.04 * land.relief
    # what no step can hold is gone: a plain with hills
    assert land.shape(east, north, 1000.0).height.std() < 0.1 * land.relief


def test_walls_stand_upright_and_lean_over(land):
    east, north = patch(0.0, 0.0, 6e3, 240)
    down = sites(land, east, north, 0.5).normal[..., 2]
    wall = down < 0.5
    assert 0.03 < wall.mean() < 0.3
    assert 0.05 < (down[wall] < 0.0).mean() < 0.5 and (down[wall] < 0.2).mean() > 0.3


def test_gorges_are_wide_enough_to_fly(land):
    """Over the middle line of every river there is air: no drawn ground within 40 m, 60 m above the water."""
    east, north = patch(0.0, 0.0, 8e3, 500)
    found = land.shape(east, north, 4.0)
    middle = np.abs(gorges(east, north, land.power, SEED).line.value) < 4.0
    above = found.height > found.water + 60.0
    points = np.stack([(east + found.shift_east)[above], (north + found.shift_north)[above]])
    lines = np.stack([east[middle], north[middle]])[:, ::5]
    assert lines.shape[1] > 50
    nearest = np.array([np.hypot(*(points - line[:, None])).min() for line in lines.T])
    assert np.quantile(nearest, 0.05) > 40.0 and np.median(nearest) > 60.0


def test_rivers_run_in_all_gorges_and_fall_evenly(land):
    east, north = patch(0.0, 0.0, 10e3, 500, seed=3)
    middle = np.abs(gorges(east, north, land.power, SEED).line.value) < 60.0
    found = land.shape(east[middle], north[middle], 1.0)
    depth = found.water - found.height
    # a river 10 to 40 m wide somewhere in the 120 m about the middle line, nowhere deep
    assert 0.06 < (depth > 0.0).mean() < 0.35 and depth.max() < 5.0
    assert np.allclose(found.water - FALL * east[middle], found.water[0] - FALL * east[middle][0])
    # and no water anywhere else
    plateau = land.shape(east, north, 1.0)
    assert (plateau.water < plateau.height)[
        ~middle & (gorges(east, north, land.power, SEED).main.value > 200.0)
    ].all()


def test_a_country_keeps_its_colour_over_all_levels(land):
    east, north = patch(9e3, -4e3, 4e3, 100)
    tints = []
    for step in (0.3, 1.0, 3.0, 10.0, 30.0, 100.0, 250.0, 500.0):
        found = cover(sites(land, east, north, step))
        assert np.allclose(found.weights.sum(-1), 1.0) and found.weights.min() >= 0.0
        assert found.tint.min() > 0.005 and found.tint.max() < 0.8
        tints.append(found.tint.mean((0, 1)))
    assert np.abs(np.array(tints) / tints[0] - 1.0).max() < 0.08


def test_the_palette_s_materials_exist():
    assert len(PALETTE) == 6 and set(PALETTE) <= set(MATERIALS)


@pytest.mark.parametrize(
    ("relief", "feature_size", "base_height"), [(0.0, 100.0, -500.0), (3000.0, 2e5, 8000.0)]
)
def test_extreme_worlds_are_land_too(relief, feature_size, base_height):
    values = VALUES | {"relief": relief, "feature_size": feature_size, "base_height": base_height}
    extreme = Canyons(SimpleNamespace(**values), SEED)
    east, north, step = scattered(20_000, seed=4)
    found = extreme.shape(east, north, step)
    low, high = extreme.bounds()
    assert all(np.isfinite(getattr(found, name)).all() for name in vars(found))
    assert found.height.min() > low and found.height.max() < high
    assert np.hypot(found.shift_east, found.shift_north).max() < extreme.shift_bound
