"""Small glTF files, whole and broken, made byte by byte."""

from __future__ import annotations

import base64
import io
import json
from pathlib import Path
from typing import Any

import numpy as np

CODES = {"int8": 5120, "uint8": 5121, "int16": 5122, "uint16": 5123, "uint32": 5125, "float32": 5126}
KINDS = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4"}

# A cube of two metres about the origin: each side's own four corners, counter-clockwise from outside.
SIDES = {"x": (0, 1, 2), "y": (1, 2, 0), "z": (2, 0, 1)}


def cube() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Positions (24, 3), uv (24, 2) and triangles (12, 3)."""
    positions, uv, triangles = [], [], []
    for axis, right, up in SIDES.values():
        for sign in (1.0, -1.0):
            first = len(positions)
            for u, v in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
                corner = [0.0, 0.0, 0.0]
                corner[axis], corner[right], corner[up] = sign, u * sign, v
                positions.append(corner)
                uv.append((0.5 + 0.5 * u, 0.5 - 0.5 * v))
            triangles += [(first, first + 1, first + 2), (first, first + 2, first + 3)]
    return np.array(positions, np.float32), np.array(uv, np.float32), np.array(triangles, np.uint16)


class Maker:
    """A glTF in the making: `tree` may be changed at will before it is saved."""

    def __init__(self) -> None:
        self.data = bytearray()
        self.tree: dict[str, Any] = {
            "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": []}], "bufferViews": [], "accessors": [],
        }  # fmt: skip

    def view(self, data: bytes, **more: Any) -> int:
        self.data += b"\0" * (-len(self.data) % 4)
        place = {"buffer": 0, "byteOffset": len(self.data), "byteLength": len(data)}
        self.tree["bufferViews"].append(place | more)
        self.data += data
        return len(self.tree["bufferViews"]) - 1

    def array(self, array: np.ndarray, **more: Any) -> int:
        array = np.atleast_2d(array.T).T
        accessor = {
            "bufferView": self.view(array.tobytes()),
            "componentType": CODES[array.dtype.name],
            "count": len(array),
            "type": KINDS[array.shape[1]],
        }
        self.tree["accessors"].append(accessor | more)
        return len(self.tree["accessors"]) - 1

    def picture(self, texels: np.ndarray, **sampler: int) -> int:
        """A texture of (height, width, 3 or 4) uint8."""
        from PIL import Image

        stream = io.BytesIO()
        Image.fromarray(texels).save(stream, "PNG")
        images = self.tree.setdefault("images", [])
        images.append({"bufferView": self.view(stream.getvalue()), "mimeType": "image/png"})
        texture = {"source": len(images) - 1}
        if sampler:
            self.tree.setdefault("samplers", []).append(sampler)
            texture["sampler"] = len(self.tree["samplers"]) - 1
        self.tree.setdefault("textures", []).append(texture)
        return len(self.tree["textures"]) - 1

    def material(self, **values: Any) -> int:
        self.tree.setdefault("materials", []).append(values)
        return len(self.tree["materials"]) - 1

    def primitive(
        self, indices: Any = None, material: int | None = None, mode: int | None = None, **arrays: Any
    ):
        primitive: dict[str, Any] = {"attributes": {name: self.array(a) for name, a in arrays.items()}}
        if indices is not None:
            primitive["indices"] = self.array(np.ravel(indices))
        primitive |= {} if material is None else {"material": material}
        primitive |= {} if mode is None else {"mode": mode}
        self.tree["meshes"][0]["primitives"].append(primitive)
        return self

    def cube(self, material: int | None = None, **more: Any) -> Maker:
        positions, uv, triangles = cube()
        return self.primitive(triangles, material, POSITION=positions, TEXCOORD_0=uv, **more)

    def glb(self) -> bytes:
        self.tree.setdefault("buffers", [{"byteLength": len(self.data)}])
        text = json.dumps(self.tree).encode()
        text += b" " * (-len(text) % 4)
        data = bytes(self.data) + b"\0" * (-len(self.data) % 4)
        body = len(text).to_bytes(4, "little") + b"JSON" + text
        body += len(data).to_bytes(4, "little") + b"BIN\0" + data
        return b"glTF" + (2).to_bytes(4, "little") + (12 + len(body)).to_bytes(4, "little") + body

    def save(self, path: Path, buffer: str = "embedded") -> Path:
        """Write .glb or .gltf, by the ending; a .gltf's buffer is embedded or a file beside it."""
        if path.suffix == ".glb":
            path.write_bytes(self.glb())
            return path
        uri = "data:application/octet-stream;base64," + base64.b64encode(self.data).decode()
        if buffer != "embedded":
            (path.parent / buffer).write_bytes(self.data)
            uri = buffer.replace(" ", "%20")
        self.tree.setdefault("buffers", [{"byteLength": len(self.data), "uri": uri}])
        path.write_text(json.dumps(self.tree))
        return path
