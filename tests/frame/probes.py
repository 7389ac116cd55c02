"""Helpers of the frame's tests: shaders of this folder, arrays through the GPU, a camera."""

from __future__ import annotations

from datetime import UTC, datetime

import numpy as np

from fallstreak.gpu import VIEW, FrameGraph
from fallstreak.world.state import CameraState, FrameState, camera_rotation, view_values

SIZE = (128, 72)
FLAGS = ("AGX", "GRADED", "NEUTRAL", "SRGB", "GAMMA", "NIGHT", "DITHER", "BLOOM", "DEEP", "NIGHT_VISION")


def evaluate(device, entry, values, *, flags=None, constants=None):
    """Run an entry of probe.wesl on an (n, ≤ 4) array; gives (n, 4) float64."""
    values = np.atleast_2d(np.asarray(values, np.float32))
    n = len(values)
    padded = np.zeros((-(-n // 64) * 64, 4), np.float32)
    padded[:n, : values.shape[1]] = values
    graph = FrameGraph(device)
    graph.buffer_data("input", padded)
    graph.buffer("output", padded.nbytes)
    defaults = {"F0": 0.04, "METAL": 0.0, "N_V": 0.5, "ROUGHNESS": 0.5, "WHITE": 1.0, "TABLE": (0.5, 0.1)}
    graph.compute(
        "probe",
        "package::probe",
        entry=entry,
        bind={"input": "input", "output": "output"},
        groups=(len(padded) // 64, 1, 1),
        flags={name: False for name in FLAGS} | (flags or {}),
        constants={**defaults, "SQUARE": 24.0, "LOOK": (1.0, 1.0), **(constants or {})},
    )
    graph.output("output")
    graph.compile()
    graph.execute()
    return graph.read("output").view(np.float32).reshape(-1, 4)[:n].astype(float)


def state(index=0, jitter=(0.0, 0.0), heading=0.0, before=0.0, size=SIZE, seed=1):
    """A level camera at the anchor, 100 m up; headings now and in the frame before, in radians."""

    def camera(angle):
        return CameraState(
            np.array([0.0, 0.0, 100.0]), camera_rotation(angle, 0.0, 0.0, np.eye(3)), np.radians(50)
        )

    now, then = camera(heading), camera(before)
    when = datetime(2025, 6, 21, 12, tzinfo=UTC)
    return FrameState(index, index / 30, when, 1 / 30, seed, size, 6.36e6, now, then, jitter)


def set_view(graph, **kwargs):
    graph.uniforms["view"].set(**view_values(state(**kwargs)))


def new_graph(device):
    graph = FrameGraph(device)
    graph.uniform("view", VIEW)
    return graph


def picture(graph, data, name="frame.hdr"):
    """Declare a fixed picture from an (h, w, 3) array."""
    rgba = np.concatenate([data, np.ones_like(data[..., :1])], -1)
    graph.texture_data(name, rgba, "rgba16float")
    return graph.textures[name].size[:2]
