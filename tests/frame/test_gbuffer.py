"""The G-buffer keeps its budget of 28 bytes, and normals come back from 10 bits."""

import numpy as np

from fallstreak.frame import gbuffer, model

from .probes import evaluate

# WebGPU, "26.1.1 Texture format capabilities": render target pixel byte cost, and its alignment
COST = {"rgba8unorm": (8, 1), "rgb10a2unorm": (8, 4), "rg16float": (4, 2), "rgba16float": (8, 2)}


def test_colour_attachments_cost_28_bytes():
    total = 0
    for format, claimed in gbuffer.ATTACHMENTS.values():
        cost, alignment = COST[format]
        assert cost == claimed
        total = -(-total // alignment) * alignment + cost
    assert total == 28


def directions(n):
    rng = np.random.default_rng(1)
    v = rng.normal(size=(n, 3))
    return v / np.linalg.norm(v, axis=1, keepdims=True)


def angle(a, b):
    return np.degrees(2 * np.arcsin(np.clip(np.linalg.norm(a - b, axis=1) / 2, 0, 1)))


def test_normals_are_within_a_quarter_of_a_degree():
    v = directions(200_000)
    error = angle(v, model.decode_normal(model.encode_normal(v)))
    assert error.max() < 0.24
    assert error.mean() < 0.09


def test_the_axes_are_exact():
    axes = np.concatenate([np.eye(3), -np.eye(3)])
    assert np.allclose(model.decode_normal(model.encode_normal(axes)), axes, atol=1e-12)


def test_the_shader_encodes_as_the_model(device):
    v = np.concatenate([directions(5000), np.eye(3), -np.eye(3)])
    got = evaluate(device, "normals", v)[:, :3]
    # a code on the edge of rounding may fall to either side
    assert angle(v, got).max() < 0.24
    assert np.median(angle(got, model.decode_normal(model.encode_normal(v)))) < 1e-3
    assert np.allclose(got[-6:], v[-6:], atol=1e-6)
