"""Canyons: the GPU's land is the CPU's, walls stand and lean over without crossing, rivers flow."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from fallstreak.gpu import FrameGraph, shader
from fallstreak.terrain.land.canyons import Canyons
from fallstreak.terrain.land.shape import LAND, land_values

PROBE = Path(__file__).with_name("canyons_probe.wesl")
SEED = 104
DEFAULTS = {
    "base_height": 1600.0,
    "relief": 350.0,
    "feature_size": 3e3,
    "roughness": 0.5,
    "water_level": None,
}


def parameters(**changes):
    return SimpleNamespace(vertical_exaggeration=1.0, **(DEFAULTS | changes))


@pytest.fixture(scope="module")
def land():
    return Canyons(parameters(), SEED)


@pytest.fixture
def probe(monkeypatch):
    """The GPU finds the shader beside this file as a module of the package."""
    package = shader._resolve

    class WithProbe:
        def __call__(self, path):
            if path == ("canyons_probe",):
                return PROBE.read_text(encoding="utf-8"), PROBE.name
            return package(path)

        def names(self):
            return [*package.names(), "canyons_probe"]

    monkeypatch.setattr(shader, "_resolve", WithProbe())


def on_gpu(device, terrain, east, north, step):
    """Height, water, shift east and north, lost, open; (n, 6)."""
    count = -(-len(east) // 64) * 64
    places = np.zeros(count, [("tile", "<i4", 2), ("local", "<f4", 2), ("step", "<f4"), ("unused", "<f4")])
    for axis, x in enumerate((east, north)):
        places["tile"][: len(east), axis] = np.floor(x / 4096.0) * 4096
        places["local"][: len(east), axis] = x - places["tile"][: len(east), axis]
    places["step"][: len(east)] = step
    graph = FrameGraph(device)
    graph.uniform("land", LAND).set(**land_values(terrain))
    graph.buffer_data("places", places.view(np.uint8))
    graph.buffer("found", count * 32)
    graph.compute(
        "shapes", "package::canyons_probe", entry="shapes", groups=(count // 64, 1, 1), structs=[LAND],
        bind={"land": "land", "places": "places", "found": "found"},
    )  # fmt: skip
    graph.output("found")
    graph.compile()
    graph.execute()
    return graph.read("found").view(np.float32).reshape(-1, 8)[: len(east), :6].astype(float)


def scattered(count=2000, seed=0):
    rng = np.random.default_rng(seed)
    east, north = np.round(rng.uniform(-150e3, 150e3, (2, count)) * 4096.0) / 4096.0
    return east.round(3), north.round(3), 0.3 * (500.0 / 0.3) ** rng.uniform(0.0, 1.0, count)


def test_the_gpu_s_land_is_the_cpu_s(device, probe, land):
    east, north, step = scattered()
    # places that single precision knows exactly within their tile
    east, north = np.round(east * 1024.0) / 1024.0, np.round(north * 1024.0) / 1024.0
    found = on_gpu(device, parameters(), east, north, step.astype(np.float32))
    want = land.shape(east, north, step.astype(np.float32).astype(float))
    for i, name in enumerate(("height", "water", "shift_east", "shift_north", "lost", "open")):
        error = np.abs(found[:, i] - getattr(want, name))
        print(
            f"{name}: median {np.median(error):.1e}, 99 % {np.quantile(error, 0.99):.1e}, largest {error.max():.1e}"
        )
        assert np.quantile(error, 0.99) < 5e-3, name
