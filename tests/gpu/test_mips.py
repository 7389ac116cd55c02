"""Mip chains of every kind of texture are the means of their level 0."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from fallstreak.gpu import FrameGraph, GpuError
from fallstreak.gpu.mips import TexelLayout, level_size, levels


def chain(device, data, fmt, dimension):
    """All levels of a texture with this level 0, as float64."""
    graph = FrameGraph(device)
    graph.texture_data("image", data, fmt, dimension=dimension, mips=True)
    graph.add_pass("look", reads=["image"], writes=[graph.buffer("seen", 16)], record=lambda ctx: None)
    graph.output("seen")
    graph.compile()
    graph.execute()
    return [graph.read("image", mip=i) for i in range(graph.textures["image"].mips)]


def share(size, above):
    """(size, above) matrix of the part each texel above has in each texel here: what it covers of it."""
    edges = np.arange(size + 1) * above / size
    low, high = edges[:-1, None], edges[1:, None]
    column = np.arange(above)
    covered = np.minimum(high, column + 1) - np.maximum(low, column)
    return np.maximum(covered, 0.0) * size / above


def halved(values, axes):
    for axis in axes:
        n = values.shape[axis]
        values = np.moveaxis(np.tensordot(share(max(1, n // 2), n), values, (1, axis)), 0, axis)
    return values


FORMATS = [("r8unorm", 1), ("rg8unorm", 2), ("rgba8unorm", 4), ("r16float", 1), ("rg16float", 2),
           ("rgba16float", 4), ("r32float", 1), ("rg32float", 2), ("rgba32float", 4)]  # fmt: skip


@pytest.mark.parametrize(("fmt", "count"), FORMATS)
@pytest.mark.parametrize(
    ("dimension", "shape"), [("2d", (12, 21)), ("3d", (8, 5, 6)), ("2d-array", (3, 4, 16))]
)
def test_levels_are_means(device, fmt, count, dimension, shape):
    rng = np.random.default_rng(1)
    values = rng.uniform(0.0, 1.0, shape if count == 1 else (*shape, count))
    eight = fmt.endswith("8unorm")
    data = np.round(values * 255).astype(np.uint8) if eight else values
    found = chain(device, data, fmt, dimension)
    axes = (0, 1, 2) if dimension == "3d" else (0, 1) if dimension == "2d" else (1, 2)
    for above, level in itertools.pairwise(found):
        above = above.reshape(*above.shape, 1) if count == 1 else above
        want = halved(above.reshape((-1, *above.shape[-3:])[-len(shape) - 1 :]).astype(np.float64), axes)
        # eight bits: half a step of rounding
        atol = 0.51 if eight else 1e-3 if fmt.endswith("16float") else 1e-6
        np.testing.assert_allclose(level.reshape(want.shape), want, atol=atol)
    assert len(found) == levels((shape[-1], shape[-2], shape[0] if len(shape) == 3 else 1), dimension)


def test_colours_of_srgb_are_averaged_as_light(device):
    data = np.zeros((2, 2, 4), np.uint8)
    data[0] = 255
    level = chain(device, data, "rgba8unorm-srgb", "2d")[1].reshape(4)
    np.testing.assert_allclose(level, [188, 188, 188, 128], atol=1)


def test_a_large_level_is_made_in_parts(device, monkeypatch):
    monkeypatch.setattr("fallstreak.gpu.mips._PART", 1024)
    for dimension, shape in (("2d", (40, 64)), ("3d", (16, 24, 64)), ("2d-array", (3, 24, 64))):
        data = np.random.default_rng(2).uniform(size=shape)
        found = chain(device, data, "r32float", dimension)[1]
        axes = (0, 1, 2) if dimension == "3d" else (0, 1) if dimension == "2d" else (1, 2)
        np.testing.assert_allclose(found, halved(data, axes), atol=1e-6)


def test_sizes_of_levels():
    assert level_size((20, 6, 8), 2, "3d") == (5, 1, 2) and level_size((20, 6, 8), 2, "2d-array") == (5, 1, 8)


def test_formats_that_cannot_have_mips_say_so():
    with pytest.raises(GpuError, match="rgba8uint"):
        TexelLayout("rgba8uint")
