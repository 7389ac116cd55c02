"""Frames without a GPU, for the tests of this room."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np


@dataclass
class Frame:
    """A plain frame; see `fallstreak.output.FrameLike`."""

    hdr: np.ndarray
    ldr: np.ndarray
    ldr16: np.ndarray | None = None
    depth: np.ndarray | None = None
    normal: np.ndarray | None = None
    albedo: np.ndarray | None = None
    motion: np.ndarray | None = None
    metadata: dict[str, Any] = field(default_factory=dict)
    stats: dict[str, Any] = field(default_factory=dict)


def make_frame(width: int = 70, height: int = 50, seed: int = 1, **metadata: Any) -> Frame:
    """A sky-like gradient with noise over random ground, all layers present."""
    rng = np.random.default_rng(seed)
    ramp = np.linspace(0, 1, height)[:, None, None] * np.array([0.4, 0.7, 1.0]) * 0.8
    picture = np.broadcast_to(ramp, (height, width, 3)) + rng.uniform(0, 0.01, (height, width, 3))
    depth = rng.uniform(10, 1e5, (height, width)).astype(np.float32)
    depth[: height // 2] = np.inf
    normal = rng.normal(size=(height, width, 3))
    normal /= np.linalg.norm(normal, axis=2, keepdims=True)
    return Frame(
        hdr=(picture * 1e4).astype(np.float32),
        ldr=(picture * 255).astype(np.uint8),
        ldr16=(picture * 65535).astype(np.uint16),
        depth=depth,
        normal=normal.astype(np.float32),
        albedo=rng.uniform(0, 1, (height, width, 3)).astype(np.float32),
        motion=rng.normal(size=(height, width, 2)).astype(np.float32),
        metadata={
            "scene": "Jacksboro, évening",
            "time": "2026-05-01T18:30:00-05:00",
            "frame": 0,
            "seed": seed,
            "version": "0.1.0",
            "size": (width, height),
            "ev100": np.float32(13.25),
            **metadata,
        },
        stats={"gpu_ms": 1.0},
    )
