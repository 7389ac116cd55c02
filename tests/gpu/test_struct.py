"""Structs against WGSL's layout rules, and against the GPU itself."""

from __future__ import annotations

import numpy as np
import pytest

from fallstreak.gpu import FrameGraph, Struct

INNER = Struct("Inner", [("a", "vec2f", "two"), ("b", "u32", "one")])
OUTER = Struct(
    "Outer",
    [
        ("first", "f32", ""),
        ("direction", "vec3f", ""),
        ("tail", "f32", "shares the vec3f's padding"),
        ("turn", "mat3x3f", ""),
        ("place", "mat4x4f", ""),
        ("many", "array<vec4f, 3>", ""),
        ("inner", INNER, ""),
        ("last", "i32", ""),
    ],
)


def test_offsets_follow_the_specification():
    offsets = {n: OUTER.dtype.fields[n][1] for n in OUTER.dtype.names}
    assert offsets == {
        "first": 0,
        "direction": 16,
        "tail": 28,
        "turn": 32,
        "place": 80,
        "many": 144,
        "inner": 192,
        "last": 208,
    }
    assert OUTER.size == 224


def test_pack_refuses_what_does_not_fit():
    with pytest.raises(ValueError, match="lacks b"):
        INNER.pack(a=(1, 2))
    with pytest.raises(ValueError, match="no field 'c'"):
        INNER.pack(a=(1, 2), b=3, c=4)
    with pytest.raises(ValueError, match=r"Inner\.a"):
        INNER.pack(a=(1, 2, 3), b=3)
    with pytest.raises(ValueError, match="vec4f"):
        Struct("Bad", [("x", "array<f32, 3>", "")])


def test_the_gpu_reads_what_python_wrote(device):
    rng = np.random.default_rng(1)
    values = {
        "first": 1.5,
        "direction": (2, 3, 4),
        "tail": 5.0,
        "turn": rng.normal(size=(3, 3)),
        "place": rng.normal(size=(4, 4)),
        "many": rng.normal(size=(3, 4)),
        "inner": {"a": (6, 7), "b": 8},
        "last": -9,
    }
    graph = FrameGraph(device)
    graph.uniform("test.outer", OUTER).set(**values)
    graph.buffer("test.out", 4 * 24)
    graph.compute(
        "test",
        "package::gpu::selftest_struct",
        bind={"outer": "test.outer", "result": "test.out"},
        groups=(1, 1, 1),
        structs=[OUTER],
    )
    graph.output("test.out")
    graph.compile()
    graph.execute()
    got = graph.read("test.out").view(np.float32)
    v3, v4 = np.array([1.0, 2.0, 3.0]), np.array([1.0, 2.0, 3.0, 4.0])
    want = np.concatenate(
        [[1.5, 2, 3, 4, 5], values["turn"] @ v3, values["place"] @ v4, values["many"][2], [6, 7, 8, -9]]
    )
    np.testing.assert_allclose(got[: len(want)], want, rtol=1e-5, atol=1e-6)
