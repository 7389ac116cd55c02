"""Light on clouds against published reflectances, against energy, and its shader against its twin."""

import numpy as np
import pytest
from shader_probes import find_probes

from fallstreak.clouds import light
from fallstreak.clouds.genera import GENERA
from fallstreak.clouds.shapes import load
from fallstreak.gpu import FrameGraph

# reflectance of a slab, overhead sun, Henyey-Greenstein 0.85: the project's Monte Carlo
TABLE = {1: 0.042, 2: 0.092, 5: 0.238, 10: 0.423, 20: 0.617, 50: 0.809}
SLANTING = {10: 0.604, 20: 0.739}  # at cosine 0.5


def slab(depth, cosine, streams=16, azimuths=16):
    """What a slab sends up and down of the light that enters, by integrating the source along all rays."""
    x, w = np.polynomial.legendre.leggauss(streams)
    mu, w = (x + 1) / 2, w / 2
    azimuth = (np.arange(azimuths) + 0.5) * 2 * np.pi / azimuths
    levels = int(np.clip(10 * depth, 80, 300))
    s = np.linspace(0, 1, levels + 1)
    t = depth * s * s * (3 - 2 * s)
    middle = (t[1:] + t[:-1]) / 2
    sent = []
    for side in (-1, 1):
        sines = np.sqrt((1 - mu**2) * (1 - cosine**2))
        angle = side * mu[:, None] * cosine + sines[:, None] * np.cos(azimuth)
        ahead = (middle / cosine)[:, None, None]
        source = light.key_light(ahead, depth / cosine - ahead, cosine, angle[None]).mean(-1)
        near, far = (t[:-1], t[1:]) if side < 0 else (depth - t[1:], depth - t[:-1])
        seen = np.exp(-near[:, None] / mu) - np.exp(-far[:, None] / mu)
        sent.append(2 * (w * mu * (source * seen).sum(0)).sum() / cosine)
    return sent


@pytest.mark.parametrize(("depth", "published"), TABLE.items())
def test_overhead_reflectance_is_the_table_s(depth, published):
    up, down = slab(depth, 1.0)
    assert up == pytest.approx(published, abs=0.01)
    assert up + down + np.exp(-depth) == pytest.approx(1.0, abs=0.04)
    assert 1 - light.layer_passes(depth, 1.0) == pytest.approx(published, abs=0.0065)


@pytest.mark.parametrize(("depth", "published"), SLANTING.items())
def test_slanting_reflectance_is_the_table_s(depth, published):
    up, down = slab(depth, 0.5)
    assert up == pytest.approx(published, abs=0.04)
    assert up + down + np.exp(-2 * depth) == pytest.approx(1.0, abs=0.05)
    assert 1 - light.layer_passes(depth, 0.5) == pytest.approx(published, abs=0.02)


@pytest.mark.parametrize("radius", [1.0, 3.0, 10.0, 25.0])
def test_a_sphere_sends_out_what_it_takes(radius):
    """Of an optical radius, in parallel light: rays in all directions through all of it."""
    b = (np.arange(24) + 0.5) / 12 - 1
    u, v = (a[np.hypot(*np.meshgrid(b, b)) < 1] for a in np.meshgrid(b, b))
    half = np.sqrt(1 - u * u - v * v)[:, None]
    s = np.linspace(-1, 1, 61)
    s = 1.5 * s - 0.5 * s**3
    along = half * (s[1:] + s[:-1]) / 2
    out = 0.0
    for m, w in zip(*np.polynomial.legendre.leggauss(12), strict=True):
        ray = np.array([np.sqrt(1 - m * m), 0.0, -m])  # of the photons that leave; light falls along -z
        aside = np.array([m, 0.0, np.sqrt(1 - m * m)])
        points = u[:, None, None] * aside + v[:, None, None] * [0.0, 1.0, 0.0] + along[..., None] * ray
        z, inside = points[..., 2], 1 - (points**2).sum(-1)
        root = np.sqrt(np.maximum(z * z + inside, 0))
        facing = np.abs(z) / np.maximum(np.linalg.norm(points, axis=-1), 1e-6)
        source = light.key_light(radius * (root - z), radius * (root + z), facing, m)
        depth = radius * half
        seen = np.exp(-depth * (1 - s[1:])) - np.exp(-depth * (1 - s[:-1]))
        out += w * 2 * (source * seen).sum() * (2 / 24) ** 2
    r = np.linspace(0, 1, 400)
    taken = np.trapezoid((1 - np.exp(-2 * radius * np.sqrt(1 - r * r))) * 2 * np.pi * r, r)
    assert out / taken == pytest.approx(1.0, abs=0.13)


def test_clouds_look_as_they_do():
    thick_top = light.key_light(1.0, 60.0, 1.0, -0.5)
    base = light.key_light(60.0, 0.5, 1.0, -0.5)
    assert 0.6 < thick_top < 0.95  # white
    assert base < 0.15  # grey
    lining, aside = light.key_light(0.5, 0.5, 0.5, [0.99, 0.0])
    assert lining > 10 * aside  # thin edges glow towards the sun
    deeper = light.key_light(np.arange(60.0), 60 - np.arange(60.0), 1.0, -0.3)
    assert np.all(np.diff(deeper[8:]) < 0)


def test_ambient_light_crosses_over():
    assert light.ambient_share(0.0, 0.0) == 0.5
    assert light.ambient_share(0.0, 80.0) > 0.93
    assert light.ambient_share(80.0, 0.0) < 0.07
    assert light.ambient_share(3.0, 7.0) + light.ambient_share(7.0, 3.0) == pytest.approx(1.0)
    far = light.ambient_share_of_three(3.0, 7.0, 1e9)
    assert far == pytest.approx(light.ambient_share(3.0, 7.0))
    assert light.ambient_share_of_three(200.0, 100.0, 0.0) == pytest.approx(0.5, abs=0.02)  # a flank


def model_density(model, points, edge, soft):
    """The field's density of one model without noise (clouds/field), at places of the model."""
    boxes = model.boxes
    v = points[..., None, :] - boxes["centre"].astype(float)
    c, s, size = boxes["cosine"], boxes["sine"], light.REACH * boxes["half"].astype(float)
    turned = (
        np.stack([c * v[..., 0] + s * v[..., 1], c * v[..., 1] - s * v[..., 0], v[..., 2] + 0 * c], -1) / size
    )
    field = np.maximum(1 - 0.5 * (turned**2).sum(-1), 0) ** 2
    t = np.clip(points[..., 2] / soft, 0, 1)
    x = np.clip((field.sum(-1) * t * t * (3 - 2 * t) - 0.25) / edge, 0, 1)
    return x * x * (3 - 2 * x) * (0.6 + 0.4 * points[..., 2] / model.top)


@pytest.mark.parametrize(
    ("name", "mean", "spread"),
    [
        ("cumulus_humilis_a", 0.5, 0.65),
        ("cumulus_mediocris_a", 0.3, 0.45),
        ("cumulus_congestus_a", 0.25, 0.4),
    ],
)
def test_depths_are_those_of_the_field(name, mean, spread):
    (model,) = load([name])
    genus = GENERA[name[:-2]]
    look = genus.edge, genus.soft
    rng = np.random.default_rng(3)
    points = np.column_stack(
        [rng.uniform(-model.radius, model.radius, (1500, 2)), rng.uniform(0, model.height, 1500)]
    )
    points = points[model_density(model, points, *look) > 0.3][:150]
    steps = (np.arange(300) + 0.5) / 300 * 2 * (model.reach + model.top)
    for elevation in (90.0, 35.0, 8.0):
        e = np.radians(elevation)
        key = np.array([0.6 * np.cos(e), 0.8 * np.cos(e), np.sin(e)])
        for sign, got in zip((1, -1), light.line_depths(model.boxes, points, key), strict=True):
            where = points[:, None] + sign * steps[:, None] * key
            true = model_density(model, where, *look).sum(1) * steps[0] * 2
            assert got.mean() == pytest.approx(true.mean(), rel=mean)
            assert np.sqrt(np.mean((got - true) ** 2)) < spread * true.mean()


def evaluate(device, entry, values, boxes, direction):
    n = len(values)
    padded = np.zeros((-(-n // 64) * 64, 4), np.float32)
    padded[:n, : values.shape[1]] = values
    graph = FrameGraph(device)
    graph.buffer_data("input", padded)
    graph.buffer_data("boxes", boxes)
    graph.buffer("output", padded.nbytes)
    bind = {"input": "input", "output": "output", "boxes": "boxes"}
    constants = {"DIRECTION": tuple(float(x) for x in direction), "COUNT": np.uint32(len(boxes))}
    groups = (len(padded) // 64, 1, 1)
    graph.compute("probe", "package::light_probe", entry=entry, bind=bind, groups=groups, constants=constants)
    graph.output("output")
    graph.compile()
    graph.execute()
    return graph.read("output").view(np.float32).reshape(-1, 4)[:n].astype(float)


def test_light_comes_upright_through_wide_layers():
    elevation = np.radians([90.0, 40.0, 10.0])
    assert light.facing_within(12.0, 12.0 / np.sin(elevation)) == pytest.approx(np.sin(elevation))
    # a ball, a tower, the lowest sun
    assert light.facing_within([12.0, 40.0, 1.0], [12.0, 10.0, 90.0]) == pytest.approx([1.0, 1.0, 0.1])


@pytest.fixture
def probe(monkeypatch):
    find_probes(monkeypatch, __file__)


def test_shader_agrees_with_the_twin(device, probe):
    (model,) = load(["cumulus_mediocris_a"])
    rng = np.random.default_rng(0)
    values = np.column_stack(
        [rng.uniform(0, 40, (500, 2)), rng.uniform(0, 1, 500), rng.uniform(-1, 1, 500)]
    ).astype(np.float32)
    got = evaluate(device, "lights", values, model.boxes, (0, 0, 1))
    ahead, behind, facing, cosine = values.astype(float).T
    assert got[:, 0] == pytest.approx(light.key_light(ahead, behind, facing, cosine), rel=1e-4, abs=2e-6)
    assert got[:, 1] == pytest.approx(light.ambient_share(ahead, behind), rel=1e-5)
    assert got[:, 2] == pytest.approx(light.layer_passes(ahead, facing), rel=1e-4)
    assert got[:, 3] == pytest.approx(light.ambient_share_of_three(ahead, behind, 9 * facing), rel=1e-5)

    points = np.column_stack([rng.uniform(-600, 600, (400, 2)), rng.uniform(0, 600, 400), np.full(400, 0.01)])
    direction = np.array([0.5, -0.6, 0.62])
    got = evaluate(device, "lines", points.astype(np.float32), model.boxes, direction)
    twin = light.line_depths(model.boxes, points[:, :3], direction, 0.01)
    assert got[:, :2] == pytest.approx(np.stack(twin, 1), rel=1e-3, abs=2e-3)
    assert got[:, 2] == pytest.approx(light.facing_within(got[:, 0], got[:, 1]), rel=1e-4)
