"""OpenEXR with named float32 layers in absolute units.

Written by the OpenEXR library (scan lines, ZIP compression). Colour is luminance in cd/m², said the standard
way by `whiteLuminance = 1`: RGB (1, 1, 1) is one candela per square metre. Read back for resuming without the
library, after the "OpenEXR File Layout" document, because the library prints to the terminal whatever it does
not like.
"""

from __future__ import annotations

import math
import os
import struct
import zlib
from collections.abc import Mapping
from datetime import datetime
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from fallstreak.output.atomic import reason, replacing
from fallstreak.output.errors import OutputError
from fallstreak.output.layers import LAYERS

_REC709 = (0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290)
_ROWS = 16  # scan lines per ZIP block


def write_exr(path: str | os.PathLike, layers: Mapping[str, np.ndarray], metadata: Mapping[str, Any]) -> None:
    """Write float layers.

    Parameters
    ----------
    path : path-like
        The file; written beside and renamed.
    layers : mapping of str to ndarray of float32, shape (H, W) or (H, W, C)
        By their names in `LAYERS`.
    metadata : mapping
        Goes as JSON into the attribute `fallstreak`; place and time also into the standard attributes.

    Raises
    ------
    OutputError
        When the file cannot be written.
    """
    import OpenEXR

    channels = {}
    for name, pixels in layers.items():
        planes = pixels[..., None] if pixels.ndim == 2 else pixels
        for index, channel in enumerate(LAYERS[name].channels):
            channels[channel] = np.ascontiguousarray(planes[..., index], np.float32)
    header = {
        "type": OpenEXR.scanlineimage,
        "compression": OpenEXR.ZIP_COMPRESSION,
        **_attributes(layers, metadata),
    }
    with replacing(path) as beside:
        # The library reports no reason, and none at all when the disk fills up: ask the system first, look
        # after.
        with open(beside, "wb"):
            pass
        try:
            OpenEXR.File(header, channels).write(str(beside))
        except (RuntimeError, ValueError, OSError) as error:
            why = reason(error) if isinstance(error, OSError) else "OpenEXR refused"
            raise OutputError(f"cannot write {path}: {why}") from error
        if _scan(beside, unpack=False) is None:
            raise OutputError(f"cannot write {path}: only a part could be written, is the disk full?")


def read_exr_text(path: str | os.PathLike) -> str | None:
    """The `fallstreak` attribute of an EXR file if the file is whole, else None.

    Whole means: a header, and every block at its place, of its length and unpacking without error.
    """
    attributes = _scan(Path(path), unpack=True)
    if attributes is None or "fallstreak" not in attributes:
        return None
    return attributes["fallstreak"][1].decode(errors="replace")


def _attributes(layers: Mapping[str, np.ndarray], metadata: Mapping[str, Any]) -> dict[str, Any]:
    from fallstreak.output.metadata import canonical

    meanings = (f"{', '.join(LAYERS[name].channels)}: {LAYERS[name].meaning}" for name in layers)
    attributes: dict[str, Any] = {
        "fallstreak": canonical(metadata),
        "software": f"fallstreak {metadata.get('version', '')}".strip(),
        "comments": "; ".join(meanings),
        "chromaticities": _REC709,
        "whiteLuminance": 1.0,
    }
    # Standard attributes: the moment of capture is the scene's, local by its own offset.
    try:
        time = datetime.fromisoformat(str(metadata["time"]))
        offset = time.utcoffset()
        attributes["capDate"] = time.strftime("%Y:%m:%d %H:%M:%S")
        attributes["utcOffset"] = -offset.total_seconds() if offset else 0.0  # "seconds to add to get UTC"
    except (KeyError, ValueError):
        pass
    for key in ("latitude", "longitude", "altitude"):
        if isinstance(metadata.get(key), int | float):
            attributes[key] = float(metadata[key])
    return attributes


# --- reading the layout -------------------------------------------------------------------------------------


def _scan(path: Path, *, unpack: bool) -> dict[str, tuple[str, bytes]] | None:
    """Attributes (type and bytes by name) of a whole single-part ZIP scan-line file, else None."""
    try:
        with open(path, "rb") as file:
            attributes = _read_header(file)
            _check_blocks(file, attributes, os.fstat(file.fileno()).st_size, unpack)
    except (OSError, ValueError, KeyError, struct.error, zlib.error):
        return None
    return attributes


def _read_header(file: BinaryIO) -> dict[str, tuple[str, bytes]]:
    if file.read(4) != b"\x76\x2f\x31\x01" or file.read(4)[0] != 2:
        raise ValueError("not OpenEXR")
    attributes = {}
    while name := _read_string(file):
        kind = _read_string(file)
        (size,) = struct.unpack("<i", file.read(4))
        value = file.read(max(size, 0))
        if len(value) != size:
            raise ValueError("the header is cut off")
        attributes[name] = (kind, value)
    return attributes


def _read_string(file: BinaryIO) -> str:
    text = bytearray()
    while (byte := file.read(1)) != b"\0":
        if not byte or len(text) > 255:
            raise ValueError("the header is cut off")
        text += byte
    return text.decode()


def _check_blocks(
    file: BinaryIO, attributes: Mapping[str, tuple[str, bytes]], size: int, unpack: bool
) -> None:
    """Raise unless the blocks follow each other without a gap to the end of the file."""
    left, top, right, bottom = struct.unpack("<4i", attributes["dataWindow"][1])
    if attributes["compression"][1] != b"\x03":
        raise ValueError("not ZIP-compressed")
    width, height = right - left + 1, bottom - top + 1
    row = width * sum(_sample_sizes(attributes["channels"][1]))
    count = math.ceil(height / _ROWS)
    offsets = struct.unpack(f"<{count}Q", file.read(8 * count))
    place = file.tell()
    for index, offset in enumerate(offsets):
        rows = min(_ROWS, height - index * _ROWS)
        y, length = struct.unpack("<ii", file.read(8))
        if offset != place or y != top + index * _ROWS or length < 0:
            raise ValueError("a block is missing")
        place += 8 + length
        if not unpack:
            file.seek(place)
            continue
        data = file.read(length)
        # A block that would not shrink is stored as it is.
        plain = data if length == rows * row else zlib.decompress(data)
        if len(plain) != rows * row:
            raise ValueError("a block is cut off")
    if place != size:
        raise ValueError("the file is cut off")


def _sample_sizes(channels: bytes) -> list[int]:
    """Bytes per sample of each channel of a `chlist` attribute."""
    sizes = []
    while channels[0]:
        end = channels.index(b"\0")
        (kind,) = struct.unpack("<i", channels[end + 1 : end + 5])
        sizes.append(2 if kind == 1 else 4)
        channels = channels[end + 17 :]
    return sizes
