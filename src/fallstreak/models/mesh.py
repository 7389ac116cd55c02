"""Triangles as the GPU reads them, and the normals of those that come without any."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

VERTEX = np.dtype(
    [
        ("position", "<f4", 3),  # m, the model's own axes
        ("normal", "<u4"),  # octahedral, two snorm16
        ("uv", "<f4", 2),
        ("color", "<u4"),  # rgba8 unorm, linear
        ("material", "<u4"),
    ]
)
"""32 bytes a vertex, as `Vertex` in draw.wesl."""


@dataclass
class Part:
    """Triangles of one material.

    Attributes
    ----------
    positions : (n, 3) float64
        Metres in the model's axes: x left, y up, z forward.
    triangles : (m, 3) int64
        Vertices, counter-clockwise seen from outside.
    normals : (n, 3) float64 or None
        Unit; None: those of the triangles.
    uv : (n, 2) float64
    colors : (n, 4) float64
        Linear, 0..1.
    material : int
    """

    positions: np.ndarray
    triangles: np.ndarray
    normals: np.ndarray | None = None
    uv: np.ndarray | None = None
    colors: np.ndarray | None = None
    material: int = 0


@dataclass
class Mesh:
    """What one draw takes.

    Attributes
    ----------
    vertices : (n,) of `VERTEX`
    indices : (3 m,) uint32
    low, high : (3,) float64
        The box around all vertices, m.
    """

    vertices: np.ndarray
    indices: np.ndarray
    low: np.ndarray = field(default_factory=lambda: np.zeros(3))
    high: np.ndarray = field(default_factory=lambda: np.zeros(3))


def faceted(part: Part) -> Part:
    """The part with each triangle's own normal at its three corners, shared where neighbours lie in a plane.

    It is what glTF asks of meshes without normals (section 3.7.2.1).
    """
    corners = part.positions[part.triangles]
    across = unit(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]))
    codes = np.repeat(encode_octahedral(across).astype(np.uint64), 3)
    keys = part.triangles.ravel().astype(np.uint64) << np.uint64(32) | codes
    _, first, which = np.unique(keys, return_index=True, return_inverse=True)
    order = part.triangles.ravel()[first]
    return Part(
        part.positions[order],
        which.reshape(-1, 3),
        np.repeat(across, 3, axis=0)[first],
        None if part.uv is None else part.uv[order],
        None if part.colors is None else part.colors[order],
        part.material,
    )


def unit(vectors: np.ndarray) -> np.ndarray:
    """Vectors of length 1; up where there was none."""
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.where(length > 1e-12, vectors / np.maximum(length, 1e-300), (0.0, 1.0, 0.0))


def encode_octahedral(normals: np.ndarray) -> np.ndarray:
    """Unit vectors -> two snorm16 in a uint32: Cigolle et al. 2014, 0.003 degrees at most.

    The GPU's half is `decode_octahedral` in draw.wesl.
    """
    n = normals / np.abs(normals).sum(1, keepdims=True)
    sign = np.where(n[:, :2] >= 0.0, 1.0, -1.0)
    folded = np.where(n[:, 2:] >= 0.0, n[:, :2], (1.0 - np.abs(n[:, 1::-1])) * sign)
    code = np.round(np.clip(folded, -1.0, 1.0) * 32767.0).astype(np.int16).view(np.uint16).astype(np.uint32)
    return code[:, 0] | (code[:, 1] << 16)


def join(parts: list[Part]) -> Mesh:
    """All parts as one mesh: one draw, whatever the number of materials."""
    vertices = np.zeros(sum(len(p.positions) for p in parts), VERTEX)
    indices = []
    start = 0
    for part in parts:
        end = start + len(part.positions)
        here = vertices[start:end]
        here["position"] = part.positions
        assert part.normals is not None
        here["normal"] = encode_octahedral(unit(part.normals))
        if part.uv is not None:
            here["uv"] = part.uv
        here["color"] = 0xFFFFFFFF if part.colors is None else _rgba8(part.colors)
        here["material"] = part.material
        indices.append((part.triangles + start).astype(np.uint32).ravel())
        start = end
    positions = vertices["position"].astype(np.float64)
    return Mesh(vertices, np.concatenate(indices), positions.min(0), positions.max(0))


def _rgba8(colors: np.ndarray) -> np.ndarray:
    bytes4 = np.round(np.clip(colors, 0.0, 1.0) * 255.0).astype(np.uint8)
    return np.ascontiguousarray(bytes4).view("<u4").ravel()
