"""Named resources of a frame graph: as declared, and as they lie in GPU memory."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np

from .device import Device
from .errors import GraphError
from .formats import is_depth
from .schedule import Ref
from .struct import Struct

Lifetime = Literal["transient", "persistent", "history", "data"]

COPY_SRC, COPY_DST = 0x0004, 0x0008
INDEX, VERTEX, UNIFORM, STORAGE, INDIRECT = 0x0010, 0x0020, 0x0040, 0x0080, 0x0100
TEXTURE_COPY_SRC, TEXTURE_COPY_DST, TEXTURE_BINDING, STORAGE_BINDING, RENDER_ATTACHMENT = 1, 2, 4, 8, 16

BUFFER_USAGES = {"index": INDEX, "vertex": VERTEX, "indirect": INDIRECT}


@dataclass
class TextureDecl:
    """A texture as declared; `usage` grows as passes use it."""

    name: str
    format: str
    size: tuple[int, int, int]
    dimension: str
    mips: int
    clear: tuple[float, float, float, float]
    lifetime: Lifetime
    data: np.ndarray | None = None
    usage: int = TEXTURE_COPY_SRC

    def kind(self) -> object:
        """Equal for textures that may share memory."""
        return (self.format, self.size, self.dimension, self.mips)


@dataclass
class BufferDecl:
    """A buffer as declared."""

    name: str
    size: int
    usage: int
    lifetime: Lifetime
    data: bytes | None = None

    def kind(self) -> object:
        """Equal for buffers that may share memory."""
        return ("buffer", self.size, self.usage)


class Uniform:
    """A uniform struct whose values Python sets; uploaded at the start of the frame when it changed."""

    def __init__(self, name: str, struct: Struct):
        self.name, self.struct = name, struct
        self.offset = 0
        self.record = np.zeros((), struct.dtype)
        self._uploaded = b""
        self.changed = True
        """Whether values differ from those the last frame had; passes use it as `when`."""

    def set(self, **values: object) -> bool:
        """Set fields; returns whether anything differs from what the GPU holds."""
        self.struct.fill(self.record, values)
        self.changed = self.record.tobytes() != self._uploaded
        return self.changed

    def take(self) -> bytes:
        """The bytes to upload; called by the graph when it records a frame."""
        self._uploaded = self.record.tobytes()
        return self._uploaded


@dataclass
class Physical:
    """Where a named resource lies: one GPU object, or two that swap places every frame (history)."""

    objects: list[Any]
    views: dict[tuple[object, ...], Any] = field(default_factory=dict)

    def at(self, parity: int, previous: bool = False) -> Any:
        """The object of this or the previous frame."""
        return self.objects[(parity + (1 if previous else 0)) % len(self.objects)]


def allocate_texture(device: Device, decl: TextureDecl) -> Any:
    """Make the texture of a declaration and upload its data, if it has any."""
    usage = decl.usage
    if decl.data is not None or decl.lifetime in ("persistent", "history"):
        usage |= TEXTURE_COPY_DST
    texture = device.texture(
        decl.name, decl.format, decl.size, usage, dimension=decl.dimension, mips=decl.mips
    )
    if decl.data is not None:
        upload_texture(device, texture, decl.data, decl.size)
    return texture


def upload_texture(device: Device, texture: Any, data: np.ndarray, size: tuple[int, int, int]) -> None:
    """Write a whole mip 0; `data` is C-contiguous with `size` texels."""
    w, h, d = size
    data = np.ascontiguousarray(data)
    row = data.nbytes // (h * d)
    if row * h * d != data.nbytes or row % w:
        raise GraphError(f"texture data of {data.nbytes} bytes does not fill {size}")
    device.queue.write_texture(
        {"texture": texture},
        data.view(np.uint8).reshape(-1),
        {"bytes_per_row": row, "rows_per_image": h},
        size,
    )


def view_of(
    physical: Physical, decl: TextureDecl, ref: Ref, parity: int, shape: str, single_mip: bool
) -> Any:
    """A cached texture view; `shape` is "2d", "2d-array", "3d" or "cube"."""
    texture = physical.at(parity, ref.previous)
    key = (id(texture), ref.mip, ref.layer, shape, single_mip)
    if key not in physical.views:
        mip = ref.mip or 0
        count = 1 if single_mip or ref.mip is not None else decl.mips
        layers = decl.size[2] if decl.dimension == "2d-array" and shape != "2d" else 1
        physical.views[key] = texture.create_view(
            dimension=shape,
            aspect="depth-only" if is_depth(decl.format) else "all",
            base_mip_level=mip,
            mip_level_count=count,
            base_array_layer=ref.layer or 0,
            array_layer_count=1 if ref.layer is not None else layers,
        )
    return physical.views[key]
