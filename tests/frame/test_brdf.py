"""Light on surfaces keeps its energy, and the shader agrees with the model."""

import numpy as np
import pytest

from fallstreak.frame import model
from fallstreak.frame.lighting import add_brdf_table
from fallstreak.gpu import FrameGraph

from .probes import evaluate

ROUGHNESSES = (0.3, 0.6, 1.0)


def hemisphere(side):
    """Directions with the density of the cosine, (side², 3): their mean of f * pi is the reflected share."""
    u, w = np.meshgrid(*[(np.arange(side) + 0.5) / side] * 2)
    r, phi = np.sqrt(u.ravel()), 2 * np.pi * w.ravel()
    return np.stack([r * np.cos(phi), r * np.sin(phi), np.sqrt(1 - r * r)], 1)


def geometry(light, n_v):
    view = np.array([np.sqrt(1 - n_v**2), 0, n_v])
    half = light + view
    half /= np.linalg.norm(half, axis=1, keepdims=True)
    return np.stack([light[:, 2], half[:, 2], half @ view, light @ view], 1)


@pytest.mark.parametrize("roughness", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("n_v", [0.1, 0.5, 0.95])
def test_white_diffuse_stays_white(roughness, n_v):
    n_l, _, _, l_v = geometry(hemisphere(128), n_v).T
    for albedo, least in ((1.0, 0.995), (0.5, 0.4)):
        reflected = np.pi * model.eon_diffuse(albedo, roughness, n_l, n_v, l_v).mean()
        assert least < reflected <= albedo * 1.005


def test_diffuse_is_reciprocal():
    a, b = model.eon_diffuse(0.7, 0.8, 0.3, 0.9, 0.5), model.eon_diffuse(0.7, 0.8, 0.9, 0.3, 0.5)
    assert a == pytest.approx(b, rel=1e-9)


def test_the_mirror_never_gives_more_than_it_gets():
    for roughness in (0.05, 0.3, 0.7, 1.0):
        for n_v in (0.05, 0.4, 1.0):
            scale, bias = model.ggx_albedo(n_v, roughness, 48)
            assert bias >= 0 and scale + bias <= 1.0005
    # smooth and head on it loses nothing
    assert sum(model.ggx_albedo(1.0, 0.05)) == pytest.approx(1, abs=1e-3)


def test_the_mirror_integrates_to_its_albedo():
    n_l, n_h, v_h, _ = geometry(hemisphere(512), 0.6).T
    scale, bias = model.ggx_albedo(0.6, 0.7)
    integral = np.pi * model.ggx_specular(n_l, 0.6, n_h, v_h, 0.7**2, 0.04).mean()
    assert integral == pytest.approx(0.04 * scale + bias, rel=0.01)


def test_the_table_on_the_gpu(device):
    graph = FrameGraph(device)
    add_brdf_table(graph)
    graph.output("frame.brdf")
    graph.compile()
    graph.execute()
    table = graph.read("frame.brdf") / 255.0
    for y in (3, 12, 31):
        for x in (5, 9, 20, 31):
            scale, bias = model.ggx_albedo(((x + 0.5) / 32) ** 2, (y + 0.5) / 32, 128)
            assert table[y, x, 0] == pytest.approx(scale, abs=0.008)
            assert table[y, x, 1] ** 2 == pytest.approx(bias, abs=0.008)


@pytest.mark.parametrize("roughness", ROUGHNESSES)
@pytest.mark.parametrize("n_v", [0.15, 0.7])
def test_the_shader_agrees_with_the_model_and_passes_the_furnace(device, roughness, n_v):
    scale, bias = model.ggx_albedo(n_v, roughness)
    angles = geometry(hemisphere(192), n_v)
    got = evaluate(
        device,
        "brdf",
        angles,
        constants={"N_V": n_v, "ROUGHNESS": roughness, "TABLE": (scale, np.sqrt(bias))},
    )[:, 0]
    n_l, n_h, v_h, l_v = angles.T
    lost = 1 / (scale + bias) - 1
    mirror = (0.04 * scale + bias) * (1 + 0.04 * lost)
    expected = model.ggx_specular(n_l, n_v, n_h, v_h, roughness**2, 0.04)
    expected = expected + model.eon_diffuse(1 - mirror, roughness, n_l, n_v, l_v)
    assert np.allclose(got, expected, rtol=2e-3, atol=2e-5)
    # a white, dielectric surface under a white sky: nothing is gained, at most 3 % is lost
    assert 0.97 < np.pi * got.mean() < 1.01
