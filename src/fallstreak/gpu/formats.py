"""Texture formats: bytes per texel and the numpy type that holds one."""

from __future__ import annotations

import numpy as np

_FORMATS: dict[str, tuple[type[np.generic], int]] = {
    "r8unorm": (np.uint8, 1),
    "rg8unorm": (np.uint8, 2),
    "rgba8unorm": (np.uint8, 4),
    "rgba8unorm-srgb": (np.uint8, 4),
    "rgba8uint": (np.uint8, 4),
    "rgb10a2unorm": (np.uint32, 1),
    "r16float": (np.float16, 1),
    "rg16float": (np.float16, 2),
    "rgba16float": (np.float16, 4),
    "rgba16uint": (np.uint16, 4),
    "r32float": (np.float32, 1),
    "rg32float": (np.float32, 2),
    "rgba32float": (np.float32, 4),
    "r32uint": (np.uint32, 1),
    "rg32uint": (np.uint32, 2),
    "rgba32uint": (np.uint32, 4),
    "rg11b10ufloat": (np.uint32, 1),
    "depth32float": (np.float32, 1),
}


def is_depth(fmt: str) -> bool:
    """Whether the format is a depth format."""
    return fmt.startswith("depth")


def texel(fmt: str) -> tuple[np.dtype, int]:
    """numpy type and number of components of one texel."""
    try:
        kind, count = _FORMATS[fmt]
    except KeyError:
        raise ValueError(
            f"texture format {fmt!r} is not supported; use one of {', '.join(_FORMATS)}"
        ) from None
    return np.dtype(kind), count


def texel_bytes(fmt: str) -> int:
    """Bytes of one texel in memory."""
    kind, count = texel(fmt)
    return kind.itemsize * count
