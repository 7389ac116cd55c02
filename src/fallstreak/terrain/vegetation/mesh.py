"""Triangles of plants: how they are gathered and how they lie in memory.

A vertex is 24 bytes: place (plant heights), how much sky it sees, how it bends (0 stiff … 1 a tip), the phase
of its flutter, leaf or wood, normal, texture coordinates. `plant.wesl` reads the same.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

VERTEX = np.dtype(
    [
        ("place", np.float32, 3),
        ("look", np.uint8, 4),  # sky, bend, phase, leaf
        ("normal", np.int8, 4),
        ("uv", np.uint16, 2),  # 16384 is one picture
    ]
)
UV_ONE = 16384


@dataclass(frozen=True)
class Mesh:
    """Vertices as `VERTEX`, indices as uint32 triangles."""

    vertices: np.ndarray
    indices: np.ndarray

    @property
    def triangles(self) -> int:
        """How many there are."""
        return len(self.indices) // 3

    @property
    def reach(self) -> float:
        """Radius of the sphere about (0, 0, 0.5) that holds all vertices, plant heights."""
        away = self.vertices["place"] - np.array([0.0, 0.0, 0.5], np.float32)
        return float(np.sqrt((away**2).sum(-1)).max())


class Builder:
    """Gathers parts of a mesh."""

    def __init__(self):
        self._vertices: list[np.ndarray] = []
        self._indices: list[np.ndarray] = []
        self._count = 0

    def add(
        self,
        places: np.ndarray,
        normals: np.ndarray,
        uv: np.ndarray,
        triangles: np.ndarray,
        *,
        sky: np.ndarray | float,
        bend: np.ndarray | float,
        phase: np.ndarray | float,
        leaf: float,
    ) -> None:
        """A part: (n, 3) places and normals, (n, 2) uv, (m, 3) triangles."""
        made = np.zeros(len(places), VERTEX)
        made["place"] = places
        length = np.maximum(np.linalg.norm(normals, axis=-1, keepdims=True), 1e-9)
        made["normal"][:, :3] = np.round(127 * normals / length)
        made["uv"] = np.round(np.asarray(uv) * UV_ONE)
        for i, value in enumerate((sky, bend, phase, leaf)):
            made["look"][:, i] = np.round(255 * np.clip(value, 0.0, 1.0))
        self._vertices.append(made)
        self._indices.append(np.asarray(triangles, np.uint32).ravel() + np.uint32(self._count))
        self._count += len(made)

    def tube(
        self, points: np.ndarray, radii: np.ndarray, sides: int, bend: np.ndarray, sky: float = 0.6
    ) -> None:
        """A stem of wood through (n, 3) points."""
        along = np.gradient(points, axis=0)
        along /= np.linalg.norm(along, axis=1, keepdims=True)
        first = np.cross(along, [0.31, 0.95, 0.05])
        first /= np.linalg.norm(first, axis=1, keepdims=True)
        second = np.cross(along, first)
        turn = np.linspace(0, 2 * np.pi, sides + 1)
        out = first[:, None] * np.cos(turn)[:, None] + second[:, None] * np.sin(turn)[:, None]
        places = points[:, None] + out * np.asarray(radii)[:, None, None]
        length = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
        uv = np.stack(np.broadcast_arrays(turn / (2 * np.pi), 2.0 * length[:, None]), -1)
        self.add(
            places.reshape(-1, 3),
            out.reshape(-1, 3),
            uv.reshape(-1, 2),
            grid(len(points), sides + 1),
            sky=sky,
            bend=np.repeat(bend, sides + 1),
            phase=0.0,
            leaf=0.0,
        )

    def mesh(self) -> Mesh:
        """All parts together."""
        return Mesh(np.concatenate(self._vertices), np.concatenate(self._indices))


def repeated(triangles: np.ndarray, vertices: int, count: int) -> np.ndarray:
    """The triangles of `count` parts with `vertices` vertices each, one after the other."""
    return (triangles[None] + vertices * np.arange(count)[:, None, None]).reshape(-1, 3)


def grid(rows: int, columns: int) -> np.ndarray:
    """Triangles of a grid of vertices, (m, 3)."""
    j, i = np.meshgrid(np.arange(rows - 1), np.arange(columns - 1), indexing="ij")
    a = (j * columns + i).ravel()
    return np.concatenate(
        [np.stack([a, a + 1, a + columns + 1], 1), np.stack([a, a + columns + 1, a + columns], 1)]
    )
