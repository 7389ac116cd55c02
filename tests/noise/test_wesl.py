"""The shaders of the noise: every kind links, validates at default limits, and gives the CPU's values."""

from __future__ import annotations

import itertools
import re
from pathlib import Path

import numpy as np
import pytest

from fallstreak import noise
from fallstreak.gpu.wesl import link, package_resolver
from fallstreak.noise import bake as gpu
from fallstreak.noise import hashing
from fallstreak.noise.bake import Layer
from fallstreak.noise.baker import LAYER, Baker
from fallstreak.noise.kinds import FRACTALS, KINDS

from . import reference

CASES = [(kind.name, d) for kind in KINDS.values() for d in kind.dimensions]
PERIODIC = [(name, d) for name, d in CASES if d in KINDS[name].periodic]
GRADIENTS = [(name, d) for name, d in CASES if KINDS[name].gradient]
TOLERANCE = 1e-5
ROOM = Path(noise.__file__).parent


def scattered(count, dimensions, reach=50.0, seed=0):
    return np.random.default_rng(seed).uniform(-reach, reach, (count, dimensions))


def constants(kind, **changes):
    return {
        "NOISE": f"package::noise::{kind}", "SHAPE": 0, "BLEND": 0, "CLAMPED": False, "WARPED": False,
    } | changes  # fmt: skip


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_validates_as_hardware_gets_it(device, kind):
    """In all dimensions, repeating or not, warped or not; all fractals and blends at once in the first."""
    entries = {2: ["points2", "plane"], 3: ["points3", "volume", "cube"], 4: ["points4"]}
    for dimensions in KINDS[kind].dimensions:
        names = list(entries[dimensions])
        if dimensions in KINDS[kind].periodic:
            names += [f"tiled_{name}" for name in names if name != "cube"]
        for name, warped in itertools.product(names, (False, True)):
            choice = constants(kind, WARPED=warped, CLAMPED=warped, SHAPE=4 * warped, BLEND=5 * warped)
            _, linked = device.shaders.get("package::noise::bake", [name], constants=choice, structs=[LAYER])
            device.native.create_shader_module(label=name, code=linked.code)


@pytest.mark.parametrize("kind", [name for name, kind in KINDS.items() if kind.gradient])
def test_derivatives_and_curls_validate(device, kind):
    entries = ["slopes2", "slopes3", "slopes4", "flow2", "flow3", "tiled_flow2", "tiled_flow3"]
    entries += ["flow_plane", "flow_volume", "flow_cube", "tiled_flow_plane", "tiled_flow_volume"]
    for name in entries:
        _, linked = device.shaders.get(
            "package::noise::bake", [name], constants=constants(kind), structs=[LAYER]
        )
        device.native.create_shader_module(label=name, code=linked.code)


MODULES = sorted(path.stem for path in ROOM.glob("*.wesl") if "@compute" not in path.read_text())


@pytest.mark.parametrize("module", MODULES)
def test_every_function_of_a_library_validates(device, module):
    """Each is called with zeros: what no pass uses yet must not be broken when somebody wants it."""
    calls = []
    for name, parameters in re.findall(
        r"^fn (\w+)\(([^)]*)\) ->", (ROOM / f"{module}.wesl").read_text(), re.M
    ):
        types = re.findall(r": (vec\d<bool>|\w+)", parameters)
        calls.append(f"_ = {module}::{name}({', '.join(zero(t) for t in types)});")
    assert calls
    text = f"import package::noise::{module};\n@compute @workgroup_size(1) fn main() {{ {' '.join(calls)} }}"
    find = package_resolver()
    linked = link(
        "package::probe",
        resolve=lambda path: (text, "probe.wesl") if path == ("probe",) else find(path),
        virtual={"constants": constants("perlin")},
    )
    device.native.create_shader_module(label=module, code=linked.code)


def zero(kind):
    """The zero of a type; that of a struct by the path of the module that declares it."""
    for path in ROOM.glob("*.wesl"):
        if f"struct {kind} {{" in path.read_text():
            return f"package::noise::{path.stem}::{kind}()"
    return f"{kind}()"


@pytest.mark.parametrize(("kind", "dimensions"), CASES)
def test_values_are_those_of_the_reference(device, kind, dimensions):
    points = scattered(3000, dimensions)
    for seed in (0, 7, 2**32 - 1):
        got = gpu.sample(device, points, Layer(kind, frequency=1, seed=seed))
        np.testing.assert_allclose(got, reference.sample(points, kind, seed), atol=TOLERANCE)


@pytest.mark.parametrize(("kind", "dimensions"), CASES)
def test_values_are_those_of_the_cpu(device, kind, dimensions):
    points = scattered(5000, dimensions)
    got = gpu.sample(device, points, Layer(kind, octaves=3, frequency=1, seed=9))
    want = noise.fbm(points, 3, kind=kind, seed=9)
    np.testing.assert_allclose(got, want, atol=TOLERANCE)


@pytest.mark.parametrize(("kind", "dimensions"), PERIODIC)
def test_repeating_values_are_those_of_the_reference(device, kind, dimensions):
    points = scattered(2000, dimensions)
    for period in (1, 2, tuple(range(3, 3 + dimensions))):
        if (kind, dimensions, period) == ("simplex", 2, 1):
            continue  # must be even along y
        got = gpu.sample(device, points, Layer(kind, frequency=1, octaves=2), period=period)
        np.testing.assert_allclose(got, reference.fbm(points, 2, kind, period=period), atol=TOLERANCE)


@pytest.mark.parametrize(("kind", "dimensions"), PERIODIC)
def test_what_repeats_does_so_exactly(device, kind, dimensions):
    points = np.random.default_rng(1).integers(-512, 512, (500, dimensions)) / 128
    layer = Layer(kind, frequency=1, octaves=3, lacunarity=3, seed=5)
    here = gpu.sample(device, points, layer, period=4)
    there = gpu.sample(device, points + np.array([4, -8, 12, 40])[:dimensions], layer, period=4)
    np.testing.assert_array_equal(there, here)


@pytest.mark.parametrize("fractal", FRACTALS)
@pytest.mark.parametrize(("kind", "dimensions"), [("perlin", 2), ("perlin", 3), ("perlin", 4), ("value", 3)])
def test_fractals_are_those_of_the_reference(device, fractal, kind, dimensions):
    points = scattered(1500, dimensions, 5.0)
    for options in ({}, {"lacunarity": 2.13, "gain": 0.7}, {"spacing": 0.011}):
        layer = Layer(
            kind, fractal, 7, frequency=1.7, seed=3,
            lacunarity=options.get("lacunarity", 2.0), gain=options.get("gain", 0.5),
        )  # fmt: skip
        got = gpu.sample(device, points, layer, spacing=options.get("spacing"))
        want = reference.fbm(points, 7, kind, fractal, seed=3, frequency=1.7, **options)
        np.testing.assert_allclose(got, want, atol=TOLERANCE)


@pytest.mark.parametrize(("kind", "dimensions"), [("perlin", 2), ("value", 3), ("simplex", 4)])
def test_warped_points(device, kind, dimensions):
    points = scattered(1000, dimensions, 5.0)
    got = gpu.sample(device, points, Layer(kind, octaves=3, frequency=1, warp=0.6, seed=2))
    np.testing.assert_allclose(got, reference.warp(points, 0.6, 3, kind=kind, seed=2), atol=TOLERANCE)


@pytest.mark.parametrize(("kind", "dimensions"), CASES)
def test_far_from_the_origin_nothing_is_lost(device, kind, dimensions):
    points = 1e7 + np.random.default_rng(2).integers(0, 4096, (1000, dimensions)) / 1024
    got = gpu.sample(device, points, Layer(kind, frequency=1, octaves=2))
    np.testing.assert_allclose(got, reference.fbm(points, 2, kind), atol=TOLERANCE)


@pytest.mark.parametrize(("kind", "dimensions"), PERIODIC)
def test_far_from_the_origin_it_repeats_as_well(device, kind, dimensions):
    for place in (-3e8, 1e7, 2e9):
        points = place + np.random.default_rng(3).integers(0, 65536, (500, dimensions)) / 1024
        for period in (2, 14, 1000, 2**31 - 2):
            got = gpu.sample(device, points, Layer(kind, frequency=1), period=period)
            np.testing.assert_allclose(got, reference.sample(points, kind, period=period), atol=TOLERANCE)


@pytest.mark.parametrize(("kind", "dimensions"), GRADIENTS)
def test_derivatives_are_differences(device, kind, dimensions):
    points = scattered(1000, dimensions, 5.0)
    value, slope = gpu.gradient(device, points, Layer(kind, octaves=3, frequency=1.5, seed=4))

    def noise(p):
        return reference.fbm(p, 3, kind, seed=4, frequency=1.5)

    np.testing.assert_allclose(value, noise(points), atol=TOLERANCE)
    np.testing.assert_allclose(slope, reference.differences(noise, points), atol=1e-3)


@pytest.mark.parametrize("dimensions", [2, 3])
@pytest.mark.parametrize("period", [None, 6])
def test_curls_are_those_of_the_reference(device, dimensions, period):
    points = scattered(800, dimensions, 5.0)
    got = gpu.curl(device, points, Layer(octaves=3, frequency=1.5, seed=4), period=period)
    want = reference.curl(points, 3, frequency=1.5, seed=4, period=period)
    np.testing.assert_allclose(got, want, atol=1e-4)


def test_octave_zero_of_seed_zero_moves_published_noise_by_nothing(device):
    """`permutation.wesl` holds the words of that octave as numbers."""
    points = scattered(200, 3)
    words = reference.axis_words(0, 0)
    assert tuple(int(w) for w in words) == hashing.axis_words(0, 0)
    got = gpu.sample(device, points, Layer("improved", frequency=1))
    np.testing.assert_allclose(got, reference.improved(points, words), atol=TOLERANCE)


def test_pipelines_are_made_once(device):
    baker = Baker.of(device)
    gpu.sample(device, scattered(10, 2), Layer("value"))
    count = len(baker._pipelines)
    gpu.sample(device, scattered(10, 2), Layer("value", seed=9, octaves=3))
    assert len(baker._pipelines) == count
