"""glTF 2.0 files -> triangles, materials and pictures in memory.

pygltflib reads the structure; here its arrays are cut out of the buffers, the tree of nodes is flattened into
the model's own axes, and everything that a broken or hostile file may claim is checked before memory is
asked for.

Source: Khronos Group 2021, "glTF 2.0 Specification". Sections are named where they decide something.
"""

from __future__ import annotations

import io
import logging
from base64 import b64decode
from collections.abc import Callable
from pathlib import Path
from typing import Any
from urllib.parse import unquote_to_bytes

import numpy as np

from ..world.errors import shorten
from .files import ModelError, read_beside, read_bytes
from .mesh import Part, faceted
from .textures import Picture, open_picture

MAX_VERTICES = 4_000_000
"""128 MiB of vertices: what WebGPU binds at once by default."""
MAX_TRIANGLES = 20_000_000
MAX_OBJECTS = 20_000
"""JSON objects of a file, and primitives that its nodes draw; pygltflib takes 0.3 ms for each."""
MAX_DEPTH = 100

_TYPES = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_COMPONENTS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}
_KNOWN = {"KHR_mesh_quantization"}


class Gltf:
    """One file's structure, with what its indices lead to.

    Parameters
    ----------
    path : Path
        A .glb or .gltf.

    Raises
    ------
    ModelError
        When it cannot be read or is not glTF 2.0.
    """

    def __init__(self, path: Path):
        self._folder = path.parent
        data = read_bytes(path, "it")
        self.tree = _structure(data)
        self._buffers: dict[int, bytes] = {}
        _check_version(self.tree)

    # ---- looking things up -----------------------------------------------------------------------------

    def _item(self, kind: str, index: Any) -> Any:
        """`tree.kind[index]`, for an index that a file claims."""
        items = getattr(self.tree, kind) or []
        if not isinstance(index, int) or isinstance(index, bool) or not 0 <= index < len(items):
            raise ModelError(f"it speaks of {kind}[{shorten(index)}], and there are {len(items)}")
        return items[index]

    def _buffer(self, index: int) -> bytes:
        if index not in self._buffers:
            buffer = self._item("buffers", index)
            if buffer.uri is None:
                data = self.tree.binary_blob()
                if index or data is None:
                    raise ModelError(f"buffers[{index}] has no data")
            else:
                data = self._load(buffer.uri)
            if len(data) < _whole(buffer.byteLength, "buffer.byteLength"):
                raise ModelError(f"buffers[{index}] ends early: {len(data):,} of {buffer.byteLength:,} bytes")
            self._buffers[index] = data
        return self._buffers[index]

    def _load(self, uri: Any) -> bytes:
        if not isinstance(uri, str):
            raise ModelError(f"a URI is {shorten(uri)}")
        if uri.startswith("data:"):
            header, _, text = uri.partition(",")
            try:
                return (
                    b64decode(text, validate=True) if header.endswith(";base64") else unquote_to_bytes(text)
                )
            except ValueError:
                raise ModelError(f"the data in {shorten(uri, 32)} cannot be decoded") from None
        return read_beside(uri, self._folder)

    def _view(self, index: int) -> tuple[memoryview, int]:
        """Bytes of a buffer view, and its stride (0: tight)."""
        view = self._item("bufferViews", index)
        start, length = _whole(view.byteOffset or 0, "byteOffset"), _whole(view.byteLength, "byteLength")
        data = self._buffer(view.buffer)
        if start + length > len(data):
            raise ModelError(f"bufferViews[{index}] reaches beyond its buffer's {len(data):,} bytes")
        return memoryview(data)[start : start + length], _whole(view.byteStride or 0, "byteStride")

    def accessor(self, index: int, components: int | None = None) -> np.ndarray:
        """The array of an accessor, (count, components) as stored; normalized integers become float64.

        Raises
        ------
        ModelError
            When it is sparse, of an unknown type, or reaches beyond its data.
        """
        accessor = self._item("accessors", index)
        where = f"accessors[{index}]"
        if accessor.sparse is not None:
            raise ModelError(
                f"{where} is sparse, which is not supported: export the mesh without sparse data"
            )
        kind, width = _TYPES.get(accessor.componentType), _COMPONENTS.get(accessor.type)
        if kind is None or width is None or (components and components != width):
            raise ModelError(
                f"{where} has the type {shorten(accessor.type)} of {shorten(accessor.componentType)}"
            )
        count = _whole(accessor.count, f"{where}.count")
        if accessor.bufferView is None:
            raise ModelError(f"{where} has no data (meshes compressed by an extension are not supported)")
        view, stride = self._view(accessor.bufferView)
        dtype = np.dtype(kind)
        start, row = _whole(accessor.byteOffset or 0, f"{where}.byteOffset"), dtype.itemsize * width
        step = stride or row
        if step < row or (count and start + step * (count - 1) + row > len(view)):
            raise ModelError(f"{where} reaches beyond its data: {count:,} elements in {len(view):,} bytes")
        array = np.ndarray((count, width), dtype, view, start, (step, dtype.itemsize))
        if accessor.normalized and dtype.kind in "iu":  # section 3.6.2.2
            return np.maximum(array / float(np.iinfo(dtype).max), -1.0)
        return array

    # ---- what there is ---------------------------------------------------------------------------------

    def parts(self) -> list[Part]:
        """All triangles of the file's scene, in the model's axes, each part with normals."""
        parts: list[Part] = []
        seen = vertices = triangles = 0
        for mesh, matrix in self._nodes():
            for primitive in self._item("meshes", mesh).primitives or []:
                seen += 1
                if seen > MAX_OBJECTS:
                    raise ModelError(f"it draws more than {MAX_OBJECTS:,} meshes: join them")
                vertices += self._claims(getattr(primitive.attributes, "POSITION", None))
                triangles += self._claims(primitive.indices) // 3
                if vertices > MAX_VERTICES or triangles > MAX_TRIANGLES:
                    raise ModelError(
                        f"it has more than {MAX_VERTICES:,} vertices or {MAX_TRIANGLES:,} triangles"
                    )
                part = self._part(primitive, matrix)
                if part is not None and len(part.triangles):
                    parts.append(part)
        if not parts:
            raise ModelError("it has no triangles")
        parts = [part if part.normals is not None else faceted(part) for part in parts]
        if sum(len(part.positions) for part in parts) > MAX_VERTICES:
            raise ModelError(f"it has more than {MAX_VERTICES:,} vertices, each flat triangle having its own")
        return parts

    def _claims(self, accessor: Any) -> int:
        return 0 if accessor is None else _whole(self._item("accessors", accessor).count, "accessor.count")

    def _nodes(self) -> list[tuple[int, np.ndarray]]:
        """(mesh, model from mesh) of every node of the scene; section 3.5.2."""
        scenes = self.tree.scenes or []
        if scenes:
            roots = self._item("scenes", self.tree.scene or 0).nodes or []
        else:
            roots = list(range(len(self.tree.nodes or [])))
            children = {c for n in self.tree.nodes or [] for c in n.children or []}
            roots = [r for r in roots if r not in children]
        found: list[tuple[int, np.ndarray]] = []
        stack = [(root, np.eye(4), 0) for root in reversed(roots)]
        seen = 0
        while stack:
            index, parent, depth = stack.pop()
            node = self._item("nodes", index)
            seen += 1
            if depth > MAX_DEPTH or seen > MAX_OBJECTS:
                raise ModelError(f"its nodes go in a circle or deeper than {MAX_DEPTH}")
            matrix = parent @ _local(node)
            if node.mesh is not None:
                found.append((node.mesh, matrix))
            stack += [(child, matrix, depth + 1) for child in reversed(node.children or [])]
        return found

    def _part(self, primitive: Any, matrix: np.ndarray) -> Part | None:
        mode = 4 if primitive.mode is None else primitive.mode
        attributes = primitive.attributes
        if mode not in (4, 5, 6) or getattr(attributes, "POSITION", None) is None:
            return None  # points and lines
        positions = self.accessor(attributes.POSITION, 3).astype(np.float64)
        if not np.isfinite(positions).all():
            raise ModelError("a vertex has a position that is not a number")
        count = len(positions)
        order = (
            np.arange(count)
            if primitive.indices is None
            else self.accessor(primitive.indices, 1).astype(np.int64).ravel()
        )
        if len(order) and not 0 <= int(order.min()) <= int(order.max()) < count:
            raise ModelError(f"an index is {int(order.max()):,}, and the mesh has {count:,} vertices")
        triangles = _triangles(order, mode)
        linear = matrix[:3, :3]
        determinant = float(np.linalg.det(linear))
        if determinant < 0.0:  # section 3.5.2: a mirrored mesh turns the other way round
            triangles = triangles[:, ::-1]
        normals = self._attribute(attributes.NORMAL, count, (3,))
        if normals is not None:
            normals = normals @ _cofactor(linear).T * (-1.0 if determinant < 0.0 else 1.0)
        moved = positions @ linear.T + matrix[:3, 3]
        if not np.isfinite(moved).all() or (count and np.abs(moved).max() > 1e9):
            raise ModelError("a vertex lies further than a million kilometres from the model's origin")
        colors = self._attribute(attributes.COLOR_0, count, (3, 4))
        if colors is not None and colors.shape[1] == 3:
            colors = np.hstack([colors, np.ones((count, 1))])
        material = -1 if primitive.material is None else primitive.material
        if material >= 0:
            self._item("materials", material)
        uv = self._attribute(attributes.TEXCOORD_0, count, (2,))
        return Part(moved, triangles, normals, uv, colors, material)

    def _attribute(self, index: int | None, count: int, widths: tuple[int, ...]) -> np.ndarray | None:
        if index is None:
            return None
        array = self.accessor(index).astype(np.float64)
        if len(array) != count or array.shape[1] not in widths:
            raise ModelError(f"accessors[{index}] does not fit the {count:,} vertices it belongs to")
        return np.nan_to_num(array, posinf=0.0, neginf=0.0)

    def picture(self, texture: int) -> tuple[Picture, int]:
        """The picture of a texture, not yet decoded, and how it wraps.

        Two bits each for u and v: 0 repeat, 1 clamp, 2 mirror.
        """
        found = self._item("textures", texture)
        if found.source is None:
            raise ModelError(f"textures[{texture}] has no picture that is read (PNG or JPEG)")
        image = self._item("images", found.source)
        if image.bufferView is not None:
            data = bytes(self._view(image.bufferView)[0])
        elif image.uri is not None:
            data = self._load(image.uri)
        else:
            raise ModelError(f"images[{found.source}] has no data")
        sampler = None if found.sampler is None else self._item("samplers", found.sampler)
        codes = {33071: 1, 33648: 2}
        wrap = 0
        if sampler is not None:
            wrap = codes.get(sampler.wrapS, 0) | codes.get(sampler.wrapT, 0) << 2
        return open_picture(io.BytesIO(data), f"images[{found.source}]"), wrap


def _structure(data: bytes) -> Any:
    """pygltflib's object tree of a .glb's or .gltf's bytes."""
    from pygltflib import GLTF2

    logging.getLogger("pygltflib").setLevel(logging.ERROR)
    binary = data[:4] == b"glTF"
    if binary and (len(data) < 20 or int.from_bytes(data[8:12], "little") > len(data)):
        raise ModelError("it is cut off: its header promises more bytes than there are")
    text = data[: 20 + int.from_bytes(data[12:16], "little")] if binary else data
    if text.count(b"{") > MAX_OBJECTS:
        raise ModelError(f"its JSON has more than {MAX_OBJECTS:,} objects")
    if not binary and data.lstrip(b"\xef\xbb\xbf \t\r\n")[:1] != b"{":
        raise ModelError("it is not glTF: a .glb begins with the letters glTF, a .gltf with {")
    read: Callable[..., Any] = GLTF2.load_from_bytes if binary else GLTF2.gltf_from_json
    try:
        tree = read(data if binary else data.decode("utf-8-sig"))
        if tree is None:
            raise ValueError("it has no JSON")
        return tree
    except RecursionError:
        raise ModelError("its JSON is nested too deeply") from None
    except Exception as error:  # whatever a library makes of a file that is not what it says
        raise ModelError(f"it is not glTF 2.0 ({shorten(str(error) or type(error).__name__, 80)})") from None


def _check_version(tree: Any) -> None:
    version = str(tree.asset.version if tree.asset else "")
    if not version.startswith("2."):
        raise ModelError(f"it is glTF {shorten(version)}, and glTF 2.0 is read")
    needed = [name for name in tree.extensionsRequired or [] if name not in _KNOWN]
    if needed:
        raise ModelError(f"it requires the extension {shorten(needed[0])}, which is not supported")


def _whole(value: Any, what: str) -> int:
    if not isinstance(value, int) or isinstance(value, bool) or not 0 <= value < 2**53:
        raise ModelError(f"{what} is {shorten(value)}")
    return value


def _numbers(value: Any, count: int, what: str) -> np.ndarray:
    try:
        array = np.array(value, np.float64)
    except (TypeError, ValueError):
        array = np.full(0, np.nan)
    if array.shape != (count,) or not np.isfinite(array).all():
        raise ModelError(f"a node's {what} is {shorten(value)}")
    return array


def _local(node: Any) -> np.ndarray:
    """Parent from node: its matrix, or translation · rotation · scale."""
    if node.matrix is not None:
        return _numbers(node.matrix, 16, "matrix").reshape(4, 4).T
    matrix = np.eye(4)
    if node.rotation is not None:
        quaternion = _numbers(node.rotation, 4, "rotation")
        x, y, z, w = quaternion / max(float(np.linalg.norm(quaternion)), 1e-12)
        matrix[:3, :3] = [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    if node.scale is not None:
        matrix[:3, :3] *= _numbers(node.scale, 3, "scale")
    if node.translation is not None:
        matrix[:3, 3] = _numbers(node.translation, 3, "translation")
    return matrix


def _cofactor(m: np.ndarray) -> np.ndarray:
    """What turns normals as `m` turns surfaces, for any matrix; not of unit size."""
    return np.stack([np.cross(m[1], m[2]), np.cross(m[2], m[0]), np.cross(m[0], m[1])])


def _triangles(order: np.ndarray, mode: int) -> np.ndarray:
    """Triples of a list, a strip or a fan; section 3.7.2.1."""
    if mode == 4:
        return order[: len(order) // 3 * 3].reshape(-1, 3)
    n = max(len(order) - 2, 0)
    i = np.arange(n)
    if mode == 5:
        flip = i & 1
        return (
            np.stack([order[i], order[i + 1 + flip], order[i + 2 - flip]], 1) if n else np.zeros((0, 3), int)
        )
    return np.stack([order[i + 1], order[i + 2], np.full(n, order[0])], 1) if n else np.zeros((0, 3), int)
