"""Surfaces from which build_models.py makes models, and the writer of .glb files."""

from __future__ import annotations

import io
import json
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np


@dataclass
class Surface:
    """Triangles: positions (n, 3) m, triangles (m, 3), uv (n, 2), normals (n, 3) or None for flat ones."""

    positions: np.ndarray
    triangles: np.ndarray
    uv: np.ndarray
    normals: np.ndarray | None = None

    def mirrored(self) -> Surface:
        """The other side's twin: x negated."""
        flip = np.array([-1.0, 1.0, 1.0])
        normals = None if self.normals is None else self.normals * flip
        return Surface(self.positions * flip, self.triangles[:, ::-1], self.uv, normals)


def join(surfaces: list[Surface]) -> Surface:
    """All as one; either all or none have normals."""
    starts = np.cumsum([0, *(len(s.positions) for s in surfaces)])
    normals = [s.normals for s in surfaces]
    return Surface(
        np.concatenate([s.positions for s in surfaces]),
        np.concatenate([s.triangles + start for s, start in zip(surfaces, starts, strict=False)]),
        np.concatenate([s.uv for s in surfaces]),
        None if normals[0] is None else np.concatenate(normals),
    )


def grid(points: np.ndarray, uv: np.ndarray, *, smooth: bool = True, weld: bool = False) -> Surface:
    """A grid of points (rows, columns, 3) as a surface, its outside to the right of a row seen along rows.

    `weld`: places that coincide (a seam, a tip) share their normal.
    """
    rows, columns = points.shape[:2]
    j, i = np.meshgrid(np.arange(rows - 1), np.arange(columns - 1), indexing="ij")
    a = (j * columns + i).ravel()
    b, c, d = a + 1, a + columns + 1, a + columns
    triangles = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])
    flat = points.reshape(-1, 3)
    corners = flat[triangles]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    triangles = triangles[area > 1e-12]  # a tip's have none
    normals = smooth_normals(flat, triangles, weld) if smooth else None
    return Surface(flat, triangles, uv.reshape(-1, 2), normals)


def smooth_normals(positions: np.ndarray, triangles: np.ndarray, weld: bool) -> np.ndarray:
    """Unit normals: the mean of the triangles about a vertex, weighted by area."""
    which = np.arange(len(positions))
    if weld:
        _, which = np.unique(np.round(positions, 5), axis=0, return_inverse=True)
        which = which.ravel()
    corners = positions[triangles]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    sums = np.zeros((which.max() + 1, 3))
    for corner in range(3):
        np.add.at(sums, which[triangles[:, corner]], across)
    normals = sums[which]
    return normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)


def steps(count: int, low: float = 0.0, high: float = 1.0) -> np.ndarray:
    """Evenly spaced numbers."""
    return np.linspace(low, high, count)


@dataclass
class Glb:
    """A binary glTF file in the making; `save` writes it."""

    name: str
    tree: dict = field(default_factory=dict)
    data: bytearray = field(default_factory=bytearray)

    def __post_init__(self) -> None:
        self.tree = {
            "asset": {"version": "2.0", "generator": "Fallstreak script/build_models.py"},
            "scene": 0,
            "scenes": [{"nodes": [0]}],
            "nodes": [{"name": self.name, "mesh": 0}],
            "meshes": [{"name": self.name, "primitives": []}],
            "materials": [],
            "buffers": [],
            "bufferViews": [],
            "accessors": [],
        }

    def _view(self, data: bytes, stride: int = 0, target: int = 0) -> int:
        self.data += b"\0" * (-len(self.data) % 4)
        view = {"buffer": 0, "byteOffset": len(self.data), "byteLength": len(data)}
        view |= {"byteStride": stride} if stride else {}
        view |= {"target": target} if target else {}
        self.data += data
        self.tree["bufferViews"].append(view)
        return len(self.tree["bufferViews"]) - 1

    def _accessor(self, array: np.ndarray, kind: str, **more: object) -> int:
        codes = {"int8": 5120, "int16": 5122, "uint16": 5123, "uint32": 5125, "float32": 5126}
        count, width = (*array.shape, 1)[:2]
        row = array.dtype.itemsize * width
        stride = 0
        if kind != "SCALAR" and row % 4:  # rows of a vertex attribute begin on four bytes
            stride = row + -row % 4
            padded = np.zeros((count, stride // array.dtype.itemsize), array.dtype)
            padded[:, :width] = array
            array = padded
        target = 34963 if kind == "SCALAR" else 34962
        view = self._view(np.ascontiguousarray(array).tobytes(), stride, target)
        code = codes[array.dtype.name]
        accessor = {"bufferView": view, "componentType": code, "count": count, "type": kind, **more}
        self.tree["accessors"].append(accessor)
        return len(self.tree["accessors"]) - 1

    def texture(self, picture: np.ndarray, quality: int = 0) -> int:
        """A PNG of (height, width, 3) uint8, or a JPEG of a quality; returns the texture's index."""
        from PIL import Image

        stream = io.BytesIO()
        if quality:
            Image.fromarray(picture).save(stream, "JPEG", quality=quality, subsampling=0)
        else:
            Image.fromarray(picture).save(stream, "PNG", optimize=True)
        kind = "image/jpeg" if quality else "image/png"
        image = {"bufferView": self._view(stream.getvalue()), "mimeType": kind}
        self.tree.setdefault("images", []).append(image)
        self.tree.setdefault("textures", []).append({"source": len(self.tree["images"]) - 1})
        return len(self.tree["textures"]) - 1

    def material(self, **values: object) -> int:
        """A material; returns its index."""
        self.tree["materials"].append(values)
        return len(self.tree["materials"]) - 1

    def add(self, surface: Surface, material: int, quantum: float = 0.0) -> None:
        """A primitive. `quantum`: positions are stored as whole multiples of so many metres (int16)."""
        positions = surface.positions
        if quantum:
            stored = np.round(positions / quantum).astype(np.int16)
            self.tree["nodes"][0]["scale"] = [quantum] * 3
            self.tree["extensionsUsed"] = self.tree["extensionsRequired"] = ["KHR_mesh_quantization"]
        else:
            stored = positions.astype(np.float32)
        bounds = {"min": stored.min(0).tolist(), "max": stored.max(0).tolist()}
        attributes = {"POSITION": self._accessor(stored, "VEC3", **bounds)}
        if surface.normals is not None:
            normals = np.round(surface.normals * 127.0).astype(np.int8) if quantum else surface.normals
            kept = normals if quantum else normals.astype(np.float32)
            more = {"normalized": True} if quantum else {}
            attributes["NORMAL"] = self._accessor(kept, "VEC3", **more)
        attributes["TEXCOORD_0"] = self._accessor(surface.uv.astype(np.float32), "VEC2")
        small = np.uint16 if len(positions) < 65535 else np.uint32
        indices = self._accessor(surface.triangles.ravel().astype(small), "SCALAR")
        primitive = {"attributes": attributes, "indices": indices, "material": material}
        self.tree["meshes"][0]["primitives"].append(primitive)

    def save(self, path: Path) -> None:
        """Write the file."""
        self.data += b"\0" * (-len(self.data) % 4)
        self.tree["buffers"] = [{"byteLength": len(self.data)}]
        text = json.dumps(self.tree, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        chunks = len(text).to_bytes(4, "little") + b"JSON" + text
        chunks += len(self.data).to_bytes(4, "little") + b"BIN\0" + self.data
        path.write_bytes(
            b"glTF" + (2).to_bytes(4, "little") + (12 + len(chunks)).to_bytes(4, "little") + chunks
        )
