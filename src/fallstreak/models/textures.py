"""Pictures of a model as arrays of layers: all of one kind share a texture, so that one draw can use them."""

from __future__ import annotations

import io
from dataclasses import dataclass
from typing import Any

import numpy as np

from .files import ModelError

MAX_SIDE = 4096
"""Texels; larger pictures are made smaller."""
MAX_PIXELS = 16384 * 16384
"""Of a picture that is opened at all."""
LAYERS_BYTES = 128 << 20
"""Of all layers of one kind, at four bytes a texel; beyond, all are halved."""
NONE = 255
"""The layer of what has no texture, and so the number of layers there may be; WebGPU grants one more."""


@dataclass(eq=False)
class Picture:
    """A picture whose header was read."""

    image: Any
    name: str

    def texels(self, size: tuple[int, int], mode: str = "RGBA") -> np.ndarray:
        """Decoded to a size, (height, width, channels) uint8.

        Raises
        ------
        ModelError
            When its data are broken.
        """
        try:
            image = self.image
            if image.mode in ("I", "I;16", "I;16B", "I;16L"):  # 16-bit grey; Pillow's own way clips it
                image = image.point(lambda v: v / 256.0).convert("L")
            image = image.convert(mode)
            if image.size != size:
                image = image.resize(size, resample=1 if min(size) < 4 else 3)
            return np.asarray(image)
        except ModelError:
            raise
        except Exception as error:  # Pillow raises what its decoders raise
            raise ModelError(f"{self.name} is broken: {str(error)[:80]}") from None


def open_picture(stream: io.BytesIO, name: str) -> Picture:
    """A PNG or JPEG, of which only the header is read.

    Raises
    ------
    ModelError
        When it is neither, or too large.
    """
    from PIL import Image

    try:
        image = Image.open(stream, formats=("PNG", "JPEG"))
    except Image.DecompressionBombError:
        raise ModelError(f"{name} is larger than {MAX_PIXELS:,} pixels") from None
    except Exception:
        raise ModelError(f"{name} is neither PNG nor JPEG") from None
    if image.width * image.height > MAX_PIXELS:
        raise ModelError(f"{name} is larger than {MAX_PIXELS:,} pixels")
    return Picture(image, name)


def common_size(pictures: list[Picture]) -> tuple[int, int]:
    """Width and height of all layers: the largest of each, as far as memory goes."""
    width = min(max(p.image.width for p in pictures), MAX_SIDE)
    height = min(max(p.image.height for p in pictures), MAX_SIDE)
    while 4 * width * height * len(pictures) > LAYERS_BYTES:
        width, height = max(width // 2, 1), max(height // 2, 1)
    return width, height


@dataclass(eq=False)
class Layers:
    """Pictures that become the layers of one texture array; equal ones are kept once."""

    kind: str

    def __post_init__(self) -> None:
        self._found: dict[tuple[int, ...], int] = {}
        self._pictures: list[tuple[Picture | None, ...]] = []

    def add(self, *pictures: Picture | None) -> int:
        """The layer of a picture, or of several that go into one (each into its channels)."""
        key = tuple(id(p) for p in pictures)
        if key not in self._found:
            if len(self._pictures) == NONE:
                raise ModelError(f"it has more than {NONE} different {self.kind} textures")
            self._found[key] = len(self._pictures)
            self._pictures.append(pictures)
        return self._found[key]

    def array(self) -> np.ndarray | None:
        """(layers, height, width, channels) uint8, or None without pictures.

        Colour has four channels (sRGB and alpha), normals two, surface three and a spare one: occlusion,
        roughness, metal.
        """
        if not self._pictures:
            return None
        size = common_size([p for layer in self._pictures for p in layer if p is not None])
        if self.kind == "colour":
            return np.stack([p[0].texels(size) for p in self._pictures if p[0]])
        if self.kind == "normal":
            return np.stack([p[0].texels(size, "RGB")[..., :2] for p in self._pictures if p[0]])
        made = np.full((len(self._pictures), size[1], size[0], 4), 255, np.uint8)
        for layer, (finish, occlusion) in zip(made, self._pictures, strict=True):
            if finish is not None:
                layer[..., 1:3] = finish.texels(size, "RGB")[..., 1:3]
            if occlusion is not None:
                layer[..., 0] = occlusion.texels(size, "RGB")[..., 0]
        return made
