"""A finished frame in memory: the picture and, if asked for, what lies behind it, as numpy arrays."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

LAYERS = ("hdr", "depth", "normal", "albedo", "motion", "clouds")
"""What a frame can hold besides the picture itself."""


@dataclass(frozen=True)
class Frame:
    """One rendered frame. Layers that were not asked for are None.

    Attributes
    ----------
    ldr : (H, W, 3) uint8 or None
        The finished picture: exposed, tone-mapped, sRGB, dithered. None when 16 bits were asked for.
    ldr16 : (H, W, 3) uint16 or None
        The same in 16 bits.
    hdr : (H, W, 3) float32
        Luminance in cd/m², linear Rec. 709, without exposure.
    depth : (H, W) float32
        Distance from the camera along the ray in m; infinite where nothing is hit.
    normal : (H, W, 3) float32
        Unit normals, world axes (east, north, up); zero where nothing is hit.
    albedo : (H, W, 3) float32
        Linear Rec. 709, 0 to 1.
    motion : (H, W, 2) float32
        Position now minus position in the frame before, in pixels, right and down.
    clouds : (H, W) float32
        Opacity of the clouds in front of what lies behind, 0 to 1; at the clouds' own resolution, repeated.
    metadata : dict
        Scene, time, frame, seed, version, adapter, size, samples, ev100: the same for every run.
    stats : dict
        GPU and CPU times per pass, bytes of memory (see `Renderer.stats`). A frame of a `Renderer` has only
        `frame_ms`: to read the others would stop the sequence.
    """

    metadata: Mapping[str, Any]
    ldr: np.ndarray | None = None
    ldr16: np.ndarray | None = None
    hdr: np.ndarray | None = None
    depth: np.ndarray | None = None
    normal: np.ndarray | None = None
    albedo: np.ndarray | None = None
    motion: np.ndarray | None = None
    clouds: np.ndarray | None = None
    stats: Mapping[str, Any] = field(default_factory=dict)

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write a .png, .exr or .npz file; see `fallstreak.output.save`."""
        from fallstreak.output import save

        return save(self, path)


def decode_distance(depth: np.ndarray, near: float, fov: float) -> np.ndarray:
    """Distance along the ray in m from reverse-Z depth; infinite at depth 0."""
    height, width = depth.shape
    t = np.tan(fov / 2.0)
    y = (1.0 - 2.0 * (np.arange(height) + 0.5) / height) * t
    x = (2.0 * (np.arange(width) + 0.5) / width - 1.0) * t * width / height
    stretch = np.sqrt(1.0 + y[:, None] ** 2 + x[None, :] ** 2)
    with np.errstate(divide="ignore"):
        return (near / depth.astype(np.float64) * stretch).astype(np.float32)


def decode_normal(packed: np.ndarray, covered: np.ndarray) -> np.ndarray:
    """World normals of rgb10a2unorm octahedral texels, zero where nothing was drawn."""
    # Codes 0 to 1022 stand for -1 to 1; see gpu/gbuffer.wesl.
    x = (packed & 0x3FF).astype(np.float32) / 511.0 - 1.0
    y = (packed >> 10 & 0x3FF).astype(np.float32) / 511.0 - 1.0
    z = 1.0 - np.abs(x) - np.abs(y)
    fold = np.maximum(-z, 0.0)
    n = np.stack([x - np.copysign(fold, x), y - np.copysign(fold, y), z], -1)
    n /= np.linalg.norm(n, axis=-1, keepdims=True)
    return np.where(covered[..., None], n, 0.0).astype(np.float32)


def decode_albedo(packed: np.ndarray) -> np.ndarray:
    """Linear albedo of the G-buffer's square-rooted rgba8unorm."""
    return (packed[..., :3].astype(np.float32) / 255.0) ** 2


def decode_clouds(layer: np.ndarray | None, size: tuple[int, int]) -> np.ndarray:
    """Opacity (H, W) from ``clouds.layer``, which may be coarser than the picture of (width, height)."""
    width, height = size
    if layer is None:
        return np.zeros((height, width), np.float32)
    rows = (2 * np.arange(height) + 1) * layer.shape[0] // (2 * height)
    columns = (2 * np.arange(width) + 1) * layer.shape[1] // (2 * width)
    return np.clip(layer[..., 3].astype(np.float32)[rows[:, None], columns], 0.0, 1.0)


def decode_motion(motion: np.ndarray) -> np.ndarray:
    """Motion in pixels from motion in uv."""
    height, width = motion.shape[:2]
    return motion.astype(np.float32) * np.array([width, height], np.float32)
