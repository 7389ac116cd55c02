"""Baked textures: what is in them, that they repeat, that their mips are means and their faces meet."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from fallstreak import noise
from fallstreak.gpu import FrameGraph
from fallstreak.noise import bake as baking
from fallstreak.noise.bake import BakeSpec, Layer, bake, bake_pass, cloud_shapes, sample

from . import reference

CELLS = Layer("cellular_f1", octaves=2, frequency=4, seed=3)


def centres(shape):
    """(…, D) of the texel centres of a plane or volume, x first, in widths."""
    axes = [(np.arange(n) + 0.5) / n * n / shape[0] for n in shape]
    return np.stack(np.meshgrid(*axes[::-1], indexing="ij")[::-1], -1)


@pytest.mark.parametrize("shape", [(24, 12), (12, 6, 18)])
@pytest.mark.parametrize("tiling", [False, True])
def test_texels_hold_the_noise_of_their_centres(device, shape, tiling):
    got = bake(device, BakeSpec(shape, CELLS, "r32float", tiling=tiling)).array()
    period = [4 * n // shape[0] for n in shape] if tiling else None
    want = reference.fbm(centres(shape), 2, "cellular_f1", seed=3, frequency=4, period=period)
    np.testing.assert_allclose(got, want, atol=1e-5)


def test_a_tiling_volume_repeats_exactly(device):
    points = np.random.default_rng(0).integers(0, 256, (500, 3)) / 256
    here = sample(device, points, CELLS, period=4)
    for shift in ((1, 0, 0), (0, -3, 0), (5, 7, -2)):
        np.testing.assert_array_equal(sample(device, points + shift, CELLS, period=4), here)


def test_the_seam_of_a_tile_is_like_the_rest(device):
    tile = bake(device, BakeSpec((32, 32, 32), CELLS, "r32float", tiling=True)).array()
    for axis in range(3):
        step = np.abs(np.diff(tile, axis=axis)).max()
        assert np.abs(tile.take(0, axis) - tile.take(-1, axis)).max() <= step


def test_mips_are_means(device):
    baked = bake(device, replace(cloud_shapes(16), format="rgba32float"))
    volume = baked.array().astype(np.float64)
    assert baked.spec.levels == 5
    for level in range(1, 5):
        n = 16 >> level
        volume = volume.reshape(n, 2, n, 2, n, 2, 4).mean((1, 3, 5))
        np.testing.assert_allclose(baked.array(level).reshape(volume.shape), volume, atol=1e-6)


def test_faces_of_a_cube_are_parts_of_one_field(device):
    """Each texel holds the 3-D noise at its direction, so faces meet; directions as WebGPU has them."""
    n, radius = 12, 3.0
    got = bake(device, BakeSpec(n, Layer("value", octaves=2, frequency=radius), "r32float")).array()
    t, s = np.meshgrid(*[(2 * np.arange(n) + 1) / n - 1] * 2, indexing="ij")
    one = np.ones_like(s)
    faces = [(one, -t, -s), (-one, -t, s), (s, one, t), (s, -one, -t), (s, -t, one), (-s, -t, -one)]
    p = np.stack([np.stack(face, -1) for face in faces])
    p *= radius / np.linalg.norm(p, axis=-1, keepdims=True)
    np.testing.assert_allclose(got, reference.fbm(p, 2, "value"), atol=1e-5)


def test_cubes_are_those_of_the_cpu(device):
    layer = Layer("perlin", octaves=4, frequency=3, seed=5)
    got = bake(device, BakeSpec(16, layer, "r32float")).array()
    np.testing.assert_allclose(got, noise.cube(16, octaves=4, frequency=3, seed=5), atol=1e-5)


def test_volumes_are_those_of_the_cpu(device):
    layer = Layer("perlin", octaves=3, frequency=4, seed=5)
    got = bake(device, BakeSpec((16, 16, 8), layer, "r32float", tiling=True)).array()
    want = noise.grid(
        (8, 16, 16), step=1 / 16, origin=1 / 32, octaves=3, frequency=4, seed=5, period=(4, 4, 2)
    )
    np.testing.assert_allclose(got, want, atol=1e-5)


@pytest.mark.parametrize(
    ("size", "fmt"), [((16, 8), "rg32float"), ((8, 8, 4), "rgba32float"), (8, "rgba32float")]
)
def test_flows(device, size, fmt):
    layer = Layer("curl", octaves=2, frequency=4, seed=6)
    spec = BakeSpec(size, layer, fmt, tiling=not isinstance(size, int))
    got = bake(device, spec).array()
    if spec.cube:
        points, period = noise.cube_directions(size) * 4, None
    else:
        points, period = centres(spec.shape) * 4, [4 * n // spec.shape[0] for n in spec.shape]
    want = reference.curl(points, 2, seed=6, period=period)
    np.testing.assert_allclose(got[..., : want.shape[-1]], want, atol=1e-4)
    with pytest.raises(ValueError, match="channels has"):
        BakeSpec(size, [layer, layer], fmt)


def test_channels_and_blends(device):
    a, b = Layer("value", frequency=3, range=(-1, 1)), Layer("cellular_f1", frequency=5, range=(1, 0))
    va, vb = (bake(device, BakeSpec((16, 16), layer, "r32float")).array() for layer in (a, b))
    blends = {
        "add": va + vb,
        "multiply": va * vb,
        "screen": va + vb - va * vb,
        "min": np.minimum(va, vb),
        "max": np.maximum(va, vb),
        "set": vb,
    }
    for blend, want in blends.items():
        spec = BakeSpec((16, 16), [b, (a, replace(b, blend=blend))], "rg32float")
        got = bake(device, spec).array()
        np.testing.assert_allclose(got[..., 0], vb, atol=1e-6)
        np.testing.assert_allclose(got[..., 1], want, atol=1e-6)


@pytest.mark.parametrize("fmt", ["r8unorm", "rg8unorm", "rgba8unorm", "r16float", "rg16float", "rgba16float"])
def test_formats(device, fmt):
    layer = replace(CELLS, range=(0.0, 1.2))
    want = bake(device, BakeSpec((15, 9), layer, "r32float")).array()
    got = bake(device, BakeSpec((15, 9), layer, fmt)).array()
    got = got / 255 if got.dtype == np.uint8 else got.astype(np.float32)
    first = got if got.ndim == 2 else got[..., 0]
    np.testing.assert_allclose(first, want, atol=2.1e-3 if fmt.endswith("8unorm") else 1e-3)
    assert got.ndim == 2 or not got[..., 1:].any()


def test_any_number_of_points(device, monkeypatch):
    points = np.random.default_rng(0).uniform(-9, 9, (1000, 3))
    want = sample(device, points, CELLS)
    monkeypatch.setattr("fallstreak.noise.baker._PART", 300)
    np.testing.assert_array_equal(sample(device, points, CELLS), want)
    assert sample(device, points[:0], CELLS).shape == (0,)


@pytest.mark.parametrize("kind", ["perlin", "simplex", "value", "cellular_f2", "improved", "table"])
def test_what_is_no_place_has_no_value(device, kind):
    points = np.array([[0.5, np.nan, 0.5], [np.inf, 0.5, 0.5], [0.5, 0.25, 0.5]])
    got = sample(device, points, Layer(kind, frequency=1))
    np.testing.assert_array_equal(np.isnan(got), [True, True, False])


def test_parts_make_the_same_whole(device, monkeypatch):
    specs = [
        BakeSpec(10, CELLS, "r16float"),
        replace(cloud_shapes(16), format="rgba8unorm"),
        BakeSpec((70, 30), CELLS),
    ]
    whole = [bake(device, spec).array() for spec in specs]
    monkeypatch.setattr("fallstreak.noise.baker._PART", 100)
    for spec, want in zip(specs, whole, strict=True):
        np.testing.assert_array_equal(bake(device, spec).array(), want)


def test_octaves_finer_than_texels_fade_out(device):
    """At 8 texels and 4 cells the second octave has one texel a wavelength: nothing of it is left."""
    two = replace(CELLS, spacing=True)
    got = bake(device, BakeSpec((16, 8), two, "r32float")).array()
    want = reference.fbm(centres((16, 8)), 2, "cellular_f1", seed=3, frequency=4, spacing=1 / 16)
    np.testing.assert_allclose(got, want, atol=1e-5)


def test_a_pass_bakes_once_and_keeps(device):
    graph = FrameGraph(device)
    spec = cloud_shapes(8)
    assert bake_pass(graph, "clouds.shapes", spec) == "clouds.shapes"
    graph.output("clouds.shapes")
    graph.compile()
    for _ in range(3):
        graph.execute()
    want = bake(device, spec)
    for level in range(4):
        np.testing.assert_array_equal(graph.read("clouds.shapes", mip=level), want.array(level))
    assert not graph.stats()["passes"][0]["ran"]


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: BakeSpec((8, 8), Layer("perlyn")), "kind='perlyn'.*perlin"),
        (lambda: BakeSpec((8, 8), Layer("simplex", frequency=3), tiling=True), "period.*simplex.*even"),
        (lambda: BakeSpec((8, 8), Layer(frequency=2.5), tiling=True), r"frequency=2.5.*2.5 x 2.5 cells"),
        (lambda: BakeSpec((8, 8), Layer(lacunarity=2.5, octaves=2), tiling=True), "lacunarity=2.5"),
        (lambda: BakeSpec((8, 8), Layer(fractal="foam")), "fractal='foam'"),
        (lambda: BakeSpec((8, 8), Layer("curl", "ridged")), "kind='curl'"),
        (lambda: BakeSpec((8, 8), [(Layer("curl"), Layer())]), "kind='curl'"),
        (lambda: BakeSpec((8, 8), Layer(blend="over")), "blend='over'"),
        (lambda: BakeSpec((8, 8), Layer(range=(1, 1))), "range="),
        (lambda: BakeSpec((8, 8), Layer(octaves=0)), "octaves=0"),
        (lambda: BakeSpec((8,), Layer()), "size="),
        (lambda: BakeSpec((8, 9000), Layer()), "size=9000"),
        (lambda: BakeSpec((8, 8), [Layer()] * 3, "rg8unorm"), "channels has 3"),
        (lambda: BakeSpec(8, Layer(), tiling=True), "tiling"),
        (lambda: BakeSpec((8, 8), Layer(), "r4unorm"), "r4unorm"),
    ],
)
def test_what_is_not_allowed_is_said(make, words):
    with pytest.raises(ValueError, match=words):
        make()


def test_throughput_gives_a_time_per_round(device):
    seconds = baking.throughput(device, "value", dimensions=2, octaves=2, count=4096, rounds=3)
    assert len(seconds) == 3 and min(seconds) > 0.0
