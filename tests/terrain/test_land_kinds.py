"""Mountains, plains and dunes: the GPU's land is the CPU's, and each has the shape of its kind."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from fallstreak.gpu import FrameGraph, shader
from fallstreak.terrain.land.alpine import Alpine
from fallstreak.terrain.land.dunes import Dunes
from fallstreak.terrain.land.plains import Plains
from fallstreak.terrain.land.shape import LAND, NO_WATER
from fallstreak.world.terrain import PRESETS

PROBE = Path(__file__).with_name("land_probe.wesl")
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
    package = shader._resolve

    class WithProbe:
        def __call__(self, path):
            if path == ("land_probe",):
                return PROBE.read_text(encoding="utf-8"), PROBE.name
            return package(path)

        def names(self):
            return [*package.names(), "land_probe"]

    monkeypatch.setattr(shader, "_resolve", WithProbe())


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
