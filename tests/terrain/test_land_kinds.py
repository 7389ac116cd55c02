"""Mountains, plains and dunes: the GPU's land is the CPU's, and each has the shape of its kind."""

from __future__ import annotations

from importlib import import_module
from types import SimpleNamespace

import numpy as np
import pytest
from shader_probes import find_probes

from fallstreak.gpu import FrameGraph
from fallstreak.terrain.land import character, erosion
from fallstreak.terrain.land.alpine import Alpine
from fallstreak.terrain.land.dunes import Dunes
from fallstreak.terrain.land.plains import Plains
from fallstreak.terrain.land.shape import LAND, NO_WATER
from fallstreak.terrain.model import TerrainModel
from fallstreak.terrain.queries import sites
from fallstreak.world.terrain import PRESETS

SEED = 104
KINDS = {"alpine": Alpine, "plains": Plains, "dunes": Dunes}


def land_of(kind, **changes):
    given = {"roughness": 0.5, "water_level": NO_WATER} | PRESETS[kind] | changes
    return {name: given[name] for name, _, _ in LAND.fields}


def make(kind, **changes):
    return KINDS[kind](SimpleNamespace(**land_of(kind, **changes)), SEED)


@pytest.fixture
def probe(monkeypatch):
    """The GPU finds the shader beside this file as a module of the package."""
    find_probes(monkeypatch, __file__)


def on_gpu(device, kind, east, north, step, **changes):
    """Height, water, shift east and north, lost, open; (n, 6)."""
    count = -(-len(east) // 64) * 64
    places = np.zeros(count, [("tile", "<i4", 2), ("local", "<f4", 2), ("step", "<f4"), ("unused", "<f4")])
    for axis, x in enumerate((east, north)):
        places["tile"][: len(east), axis] = np.floor(x / 4096.0) * 4096
        places["local"][: len(east), axis] = x - places["tile"][: len(east), axis]
    places["step"][: len(east)] = step
    graph = FrameGraph(device)
    graph.uniform("land", LAND).set(**land_of(kind, **changes))
    graph.buffer_data("places", places.view(np.uint8))
    graph.buffer("found", count * 32)
    graph.compute(
        "shapes", "package::land_probe", entry="shapes", groups=(count // 64, 1, 1), structs=[LAND],
        constants={"LAND": f"package::terrain::land::{kind}"},
        bind={"land": "land", "places": "places", "found": "found"},
    )  # fmt: skip
    graph.output("found")
    graph.compile()
    graph.execute()
    return graph.read("found").view(np.float32).reshape(-1, 8)[: len(east), :6].astype(float)


def scattered(count=2000, seed=0):
    """Places that single precision knows exactly, ±150 km; steps of 0.3 … 500 m."""
    rng = np.random.default_rng(seed)
    east, north = np.round(rng.uniform(-150e3, 150e3, (2, count)) * 64.0) / 64.0
    step = 0.3 * (500.0 / 0.3) ** rng.uniform(0.0, 1.0, count)
    return east, north, step.astype(np.float32).astype(float)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("changes", [{}, {"roughness": 1.0, "water_level": 900.0, "feature_size": 3e4}])
def test_the_gpu_s_land_is_the_cpu_s(device, probe, kind, changes):
    east, north, step = scattered()
    found = on_gpu(device, kind, east, north, step, **changes)
    want = make(kind, **changes).shape(east, north, step)
    for i, name in enumerate(("height", "water", "shift_east", "shift_north", "lost", "open")):
        error = np.abs(found[:, i] - getattr(want, name))
        print(
            f"{kind} {name}: median {np.median(error):.1e}, 99 % {np.quantile(error, 0.99):.1e}", error.max()
        )
        assert np.quantile(error, 0.99) < 8e-3 and error.max() < 0.05, name


@pytest.mark.parametrize("spacing", [30.0, 50.0, 90.0])
@pytest.mark.parametrize("slope", [0.05, 0.3, 0.9])
def test_detail_never_contradicts_the_elevation_model(spacing, slope):
    """Within its bound, and the mean over a cell of the model stays what it was, on winding slopes."""
    rng = np.random.default_rng(1)
    coarsest = character.first_octave(spacing)
    inside = (np.arange(16) + 0.5) / 16 * spacing
    corner = rng.uniform(-1e5, 1e5, (2, 400, 1, 1))
    east, north = corner[0] + inside, corner[1] + inside[:, None]
    turn = (
        rng.uniform(0.0, 2.0 * np.pi, (400, 1, 1)) + 0.3 * np.sin(east / 200.0) + 0.3 * np.cos(north / 170.0)
    )
    added = character.detail(
        east + 0.0 * north,
        north + 0.0 * east,
        slope * np.cos(turn),
        slope * np.sin(turn),
        coarsest,
        0.3,
        SEED,
    ).height
    most = character.bound(coarsest, slope)
    means = added.mean((1, 2))
    assert np.abs(added).max() < most and added.std() > 0.05 * most  # it is there
    assert abs(means.mean()) < 0.01 * most
    assert means.std() < 0.05 * most and np.abs(means).max() < 0.2 * most


def test_detail_leaves_flats_flat_and_runs_down_slopes():
    east, north = np.meshgrid(np.arange(0.0, 1500.0, 5.0), np.arange(0.0, 1500.0, 5.0))
    zero = np.zeros(east.shape)
    coarsest = character.first_octave(90.0)
    assert np.abs(character.detail(east, north, zero, zero, coarsest, 5.0, SEED).height).max() < 0.3
    added = character.detail(east, north, zero + 0.5, zero, coarsest, 5.0, SEED).height
    north_rise, east_rise = np.gradient(added, 5.0)
    # troughs run down the slope, so that heights change across it
    assert north_rise.std() > 2.0 * east_rise.std()


@pytest.mark.parametrize("kind", KINDS)
def test_what_steps_leave_out_is_counted(kind):
    """The slopes that are seen and those that are lost make the same, whatever the step."""
    land = make(kind)
    east, north = np.random.default_rng(1).uniform(-60e3, 60e3, (2, 3000))
    found = []
    for step in (0.5, 4.0, 16.0, 64.0, 128.0):
        rise = land.shape(east + step, north, step).height - land.shape(east - step, north, step).height
        climb = land.shape(east, north + step, step).height - land.shape(east, north - step, step).height
        seen = (rise**2 + climb**2) / (2.0 * step) ** 2
        found.append(np.sqrt((seen + land.shape(east, north, step).lost ** 2).mean()))
    assert np.ptp(found) < 0.25 * found[0], found


@pytest.mark.parametrize(
    ("kind", "material", "changes"),
    [
        ("alpine", "alpine", {}),
        ("dunes", "dunes", {}),
        ("plains", "coast", {"water_level": 195.0}),
        ("alpine", "coast", {"water_level": 1200.0}),
    ],
)
def test_land_has_the_same_mean_colour_in_texels_of_all_sizes(kind, material, changes):
    module = import_module(f"fallstreak.terrain.cover.{material}")
    model = TerrainModel(make(kind, **changes), 6.371e6, 160e3)
    place = np.linspace(0.0, 4000.0, 50)
    east, north = (x.ravel() for x in np.meshgrid(place, place))
    means = np.array(
        [
            module.cover(sites(model, 3, east, north, step)).tint.mean(0)
            for step in (0.5, 8.0, 64.0, 128.0, 500.0)
        ]
    )
    change = np.abs(means / means[0] - 1.0).max(1)
    assert change[:-1].max() < 0.12 and change[-1] < 0.2, change


def steepness(land, half, count=20_000, step=1.0):
    """Heights and slopes (rise over run) at random places."""
    east, north = np.random.default_rng(3).uniform(-half, half, (2, count))
    rise = land.shape(east + step, north, step).height - land.shape(east - step, north, step).height
    climb = land.shape(east, north + step, step).height - land.shape(east, north - step, step).height
    return land.shape(east, north, step).height, np.hypot(rise, climb) / (2.0 * step)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("changes", [{}, {"roughness": 1.0, "water_level": 300.0}])
def test_heights_keep_within_bounds(kind, changes):
    land = make(kind, **changes)
    height, _ = steepness(land, 150e3)
    low, high = land.bounds()
    assert low <= height.min() and height.max() <= high


def test_mountains_have_summits_at_4000_m_steep_sides_and_flat_valleys():
    height, slope = steepness(make("alpine"), 60e3)
    assert 3700.0 < height.max() < 4500.0 and 400.0 < np.quantile(height, 0.02) < 1400.0
    assert 0.5 < np.median(slope) < 1.0  # 27 to 45 degrees
    valleys = height < np.quantile(height, 0.05)
    assert np.median(slope[valleys]) < 0.5 * np.median(slope)


def test_gullies_run_down_the_slope_of_mountains():
    """Cut into a plane they change height across its slope, not along it."""
    east, north = np.meshgrid(np.arange(0.0, 8e3, 20.0), np.arange(0.0, 8e3, 20.0))
    zero = np.zeros(east.shape)
    gullies = erosion.Gullies(1.0, 0.98, 0.5, 0.75, 0.03, 0.08, 0.9)
    plane = erosion.Relief(0.5 * east, zero + 0.5, zero, zero, zero)
    cut = erosion.carve(plane, east, north, 10, 10, 20.0, SEED, gullies).height - 0.5 * east
    north_rise, east_rise = np.gradient(cut, 20.0)
    assert north_rise.std() > 2.0 * east_rise.std() > 0.0


def test_sand_rests_at_34_degrees():
    _, slope = steepness(make("dunes"), 20e3, step=0.5)
    assert 0.04 < ((slope > 0.6) & (slope < 0.78)).mean() < 0.3  # slip faces
    assert (slope > 0.85).mean() < 0.02 and (slope < 0.2).mean() > 0.5


def test_plains_are_gentle():
    _, slope = steepness(make("plains"), 40e3)
    assert 0.01 < np.median(slope) < 0.1 and np.quantile(slope, 0.99) < 0.25


def test_the_water_s_edge_is_a_shelf_and_behind_it_are_cliffs():
    height, slope = steepness(make("alpine", water_level=1500.0), 60e3, 60_000)
    edge, cliff = np.abs(height - 1500.0) < 2.0, np.abs(height - 1512.0) < 4.0
    assert np.median(slope[edge]) < 0.5 * np.median(slope) < np.median(slope[cliff])
