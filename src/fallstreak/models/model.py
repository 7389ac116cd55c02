"""A model in memory, and the shipped ones: what the GPU is given, read once per file."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from ..world.errors import shorten
from .files import ModelError
from .gltf import Gltf
from .mesh import Mesh, join
from .textures import NONE, Layers, Picture

DATA = Path(__file__).parent / "data"

MATERIAL = np.dtype(
    [
        ("base", "<f4", 4),  # linear colour and alpha
        ("finish", "u1", 4),  # metal, roughness, strength of occlusion, cutoff of alpha (0: opaque), of 255
        ("layers", "u1", 3),  # of the colour, normal and surface maps; 255: none
        ("both", "u1"),  # 1 where both sides show
        ("wraps", "<u4"),  # how the three maps wrap, 4 bits each
        ("bump", "<f4"),  # scale of the normal map
    ]
)
"""32 bytes a material, as `Material` in draw.wesl."""


@dataclass(eq=False)
class LoadedModel:
    """A model ready for the GPU.

    Attributes
    ----------
    mesh : Mesh
    materials : (n,) of `MATERIAL`
    color, normal, surface : (layers, height, width, channels) uint8 or None
        See `Layers.array`.
    masked : bool
        Some material has holes.
    sides : set of bool
        Whether materials show both sides: {False}, {True} or both.
    """

    mesh: Mesh
    materials: np.ndarray
    color: np.ndarray | None
    normal: np.ndarray | None
    surface: np.ndarray | None
    masked: bool
    sides: set[bool]

    @property
    def triangles(self) -> int:
        """How many there are."""
        return len(self.mesh.indices) // 3


def load_model(path: Path | None, name: str) -> LoadedModel:
    """A model by its file, or a shipped one by its name.

    Raises
    ------
    ModelError
        With the file and the reason, when it cannot be used.
    """
    file = path or DATA / f"{name}.glb"
    try:
        status = file.stat()
        key = (status.st_mtime_ns, status.st_size)
    except (OSError, ValueError):
        key = (0, 0)
    try:
        with np.errstate(all="ignore"):  # what overflows is looked for, and told
            return _load(file, key)
    except ModelError as error:
        raise ModelError(f"{shorten(str(path or name), 120)}: {error}") from None
    except (AttributeError, TypeError, ValueError, LookupError, ArithmeticError) as error:
        # The structure holds whatever the file says: a word where there should be a list of numbers.
        reason = shorten(str(error), 80)
        raise ModelError(f"{shorten(str(path or name), 120)}: it is not glTF 2.0 ({reason})") from None


@lru_cache(8)
def _load(path: Path, key: tuple[int, int]) -> LoadedModel:
    gltf = Gltf(path)
    parts = gltf.parts()
    used = sorted({part.material for part in parts})
    for part in parts:
        part.material = used.index(part.material)
    maker = _Materials(gltf)
    materials = np.array([maker.record(index) for index in used], MATERIAL)
    return LoadedModel(
        join(parts),
        materials,
        maker.color.array(),
        maker.normal.array(),
        maker.surface.array(),
        bool((materials["finish"][:, 3] > 0).any()),
        {bool(both) for both in materials["both"]},
    )


class _Materials:
    """Materials of a file as records, with the textures they name. glTF 2.0, section 3.9."""

    def __init__(self, gltf: Gltf):
        self._gltf = gltf
        self.color, self.normal, self.surface = Layers("colour"), Layers("normal"), Layers("surface")
        self._pictures: dict[int, tuple[Picture, int]] = {}

    def _texture(self, info: Any) -> tuple[Picture, int] | None:
        """Picture and wrapping of a texture reference; none where it uses a second set of coordinates."""
        if info is None or info.index is None or info.texCoord:
            return None
        if info.index not in self._pictures:
            self._pictures[info.index] = self._gltf.picture(info.index)
        return self._pictures[info.index]

    def record(self, index: int) -> tuple[Any, ...]:
        """`MATERIAL` of a material; -1 is glTF's default one."""
        material = self._gltf.tree.materials[index] if index >= 0 else None
        pbr = material.pbrMetallicRoughness if material else None
        base, metal, rough = [1.0] * 4, 1.0, 1.0
        color = finish = normal = occlusion = None
        scale = strength = 1.0
        if pbr is not None:
            base = _given(pbr.baseColorFactor, base)
            metal, rough = _given(pbr.metallicFactor, metal), _given(pbr.roughnessFactor, rough)
            color, finish = self._texture(pbr.baseColorTexture), self._texture(pbr.metallicRoughnessTexture)
        if material is not None:
            normal, occlusion = (
                self._texture(material.normalTexture),
                self._texture(material.occlusionTexture),
            )
            scale = _given(getattr(material.normalTexture, "scale", None), 1.0)
            strength = _given(getattr(material.occlusionTexture, "strength", None), 1.0)
        surface = finish or occlusion
        layers = [
            self.color.add(color[0]) if color else NONE,
            self.normal.add(normal[0]) if normal else NONE,
            self.surface.add(finish and finish[0], occlusion and occlusion[0]) if surface else NONE,
        ]
        wraps = sum(texture[1] << 4 * i for i, texture in enumerate((color, normal, surface)) if texture)
        mode = (material.alphaMode if material else None) or "OPAQUE"
        cutoff = 0.0
        if mode == "MASK":
            cutoff = _given(getattr(material, "alphaCutoff", None), 0.5)
        elif mode == "BLEND":  # the G-buffer holds one surface per pixel
            cutoff = 0.5
        both = bool(material.doubleSided) if material else False
        finished = np.clip(np.array([metal, rough, strength, cutoff]) * 255.0, 0.0, 255.0).round().tolist()
        return (base, finished, layers, both, wraps, scale)


def _given(value: Any, default: Any) -> Any:
    """A number, or as many as the default has, that a file may give."""
    if value is None:
        return default
    try:
        array = np.array(value, np.float64)
    except (TypeError, ValueError):
        array = np.full(99, np.nan)
    if array.shape != np.shape(default) or not np.isfinite(array).all() or np.abs(array).max() > 1e6:
        raise ModelError(f"a material holds {shorten(value)}")
    return array.tolist()
