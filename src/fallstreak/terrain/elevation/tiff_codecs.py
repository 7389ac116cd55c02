"""One tile or strip of a TIFF, unpacked to at most its own size, whatever the packed bytes claim.

Deflate, LZW and packed bits are unpacked here, the predictors undone (TIFF 6.0, sections 9, 13 and 14; TIFF
Technical Note 3 for floats); everything else is left to tifffile with imagecodecs, where that is installed.
"""

from __future__ import annotations

import zlib
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from ...world.errors import WorldError
from ..quick import loops

Unpacker = Callable[[bytes, int, int], np.ndarray]
"""(packed bytes, index, rows that are there) → (rows, columns) in the machine's byte order."""

_NONE, _LZW, _DEFLATE, _DEFLATE_OLD, _PACKBITS = 1, 5, 8, 32946, 32773
_HORIZONTAL, _FLOATING = 2, 3


class UnreadableError(Exception):
    """A tile or strip that cannot be unpacked."""


def unpacker(path: Path, page: Any, dtype: np.dtype, part: tuple[int, int]) -> Unpacker:
    """How the tiles or strips of this page are unpacked; WorldError if nothing here can do it."""
    compression, predictor = int(page.compression), int(page.predictor)
    own = _CODECS.get(compression)
    if own is None or predictor not in (1, _HORIZONTAL, _FLOATING) or page.fillorder != 1:
        return _by_tifffile(path, page)
    width = part[1]
    row_bytes = width * dtype.itemsize

    def unpack(data: bytes, index: int, rows: int) -> np.ndarray:
        # tiles are whole even where they reach over the edge, the last strip is as short as it is
        count = part[0] if page.is_tiled else rows
        flat = own(data, count * row_bytes)
        if len(flat) < count * row_bytes:
            raise UnreadableError(f"{len(flat):,} of {count * row_bytes:,} bytes")
        return _undo(
            np.frombuffer(flat, np.uint8, count * row_bytes).reshape(count, row_bytes), dtype, predictor
        )

    return unpack


def _by_tifffile(path: Path, page: Any) -> Unpacker:
    try:
        decode = page.decode
        import_module("imagecodecs")
    except Exception:
        name = getattr(page.compression, "name", page.compression)
        raise WorldError(
            f"{path}: its compression ({name}) needs the package imagecodecs: python -m pip install "
            "imagecodecs, or gdal_translate -co COMPRESS=DEFLATE in.tif out.tif"
        ) from None

    def unpack(data: bytes, index: int, rows: int) -> np.ndarray:
        try:
            values = decode(data, index)[0]
        except Exception as error:
            raise UnreadableError((str(error).splitlines() or ["no reason given"])[0][:120]) from None
        if values is None:
            raise UnreadableError("nothing in it")
        values = values.reshape(values.shape[-3:-1]) if values.ndim > 2 else values
        return values.astype(values.dtype.newbyteorder("="), copy=False)

    return unpack


def _plain(data: bytes, expected: int) -> bytes:
    return data


def _inflate(data: bytes, expected: int) -> bytes:
    try:
        return zlib.decompressobj().decompress(data, expected)
    except zlib.error as error:
        raise UnreadableError(str(error)[:120]) from None


def _packbits(data: bytes, expected: int) -> bytes:
    out = bytearray()
    at = 0
    while at < len(data) and len(out) < expected:
        n = data[at]
        if n < 128:
            out += data[at + 1 : at + 2 + n]
            at += 2 + n
        else:
            out += data[at + 1 : at + 2] * (257 - n if n > 128 else 0)
            at += 2 if n > 128 else 1
    return bytes(out)


def _lzw(data: bytes, expected: int) -> bytes:
    from .lzw import unpack

    out = np.empty(expected, np.uint8)
    count = unpack(np.frombuffer(data, np.uint8), out)
    if count < 0:
        raise UnreadableError("a code that stands for nothing")
    return out[:count].tobytes()


_CODECS = {_NONE: _plain, _LZW: _lzw, _DEFLATE: _inflate, _DEFLATE_OLD: _inflate, _PACKBITS: _packbits}


def _undo(flat: np.ndarray, dtype: np.dtype, predictor: int) -> np.ndarray:
    native = dtype.newbyteorder("=")
    if predictor == _FLOATING:
        # bytes of a row by significance, highest first, each the difference from the one before
        planes = np.cumsum(flat, axis=1, dtype=np.uint8).reshape(len(flat), dtype.itemsize, -1)
        return (
            np.ascontiguousarray(planes.transpose(0, 2, 1))
            .view(dtype.newbyteorder(">"))[..., 0]
            .astype(native)
        )
    values = flat.view(dtype).astype(native, copy=False)
    if predictor == _HORIZONTAL:
        quick = loops()
        if quick is not None and native.kind in "iu" and native.itemsize == 2:
            sums = values.copy()
            quick.accumulate(sums.view(np.uint16))
            return sums
        return np.cumsum(values, axis=1, dtype=native)
    return values
