"""PNG, 8 and 16 bits per channel, with its metadata and its colour space.

Written by hand because Pillow cannot write 16-bit colour, and because bytes must be the same on every run.
After the PNG specification, third edition (W3C 2025): section 9 filters, section 11 chunks. Each row takes
the filter with the smallest sum of absolute differences (section 12.7), which on skies is nearly always Up,
Average or Paeth.
"""

from __future__ import annotations

import os
import struct
import zlib
from collections.abc import Iterator, Mapping
from typing import BinaryIO

import numpy as np

from fallstreak.output.atomic import replacing

SIGNATURE = b"\x89PNG\r\n\x1a\n"
LEVEL = 4  # zlib: 6 saves 4 % more on dithered skies and takes three times as long
_BAND = 64  # rows filtered at a time: memory stays small at 8192 × 8192
_COLOR_TYPE = {1: 0, 2: 4, 3: 2, 4: 6}

# Rec. 709 primaries, sRGB curve, no matrix, full range; then the older ways to say the same.
_CICP = bytes((1, 13, 0, 1))
_CHRM = struct.pack(">8I", 31270, 32900, 64000, 33000, 30000, 60000, 15000, 6000)
_GAMA = struct.pack(">I", 45455)


def write_png(path: str | os.PathLike, pixels: np.ndarray, text: Mapping[str, str] | None = None) -> None:
    """Write a picture in sRGB.

    Parameters
    ----------
    path : path-like
        The file; written beside and renamed.
    pixels : ndarray of uint8 or uint16, shape (H, W) or (H, W, 1..4)
        Grey, grey + alpha, colour or colour + alpha, sRGB-encoded.
    text : mapping of str to str, optional
        Metadata, one `iTXt` chunk each. Keywords are Latin-1, 1 to 79 characters.

    Raises
    ------
    OutputError
        When the file cannot be written.
    """
    with replacing(path) as beside, open(beside, "wb") as file:
        encode_png(file, pixels, text or {})


def encode_png(file: BinaryIO, pixels: np.ndarray, text: Mapping[str, str]) -> None:
    """Write a PNG stream to an open binary file; see `write_png`."""
    if pixels.ndim == 2:
        pixels = pixels[..., None]
    if pixels.dtype not in (np.uint8, np.uint16) or pixels.ndim != 3 or pixels.shape[2] not in _COLOR_TYPE:
        raise ValueError(f"a PNG takes uint8 or uint16 of (H, W, 1..4), not {pixels.dtype} {pixels.shape}")
    height, width, channels = pixels.shape
    if height == 0 or width == 0:
        raise ValueError("a PNG needs at least one pixel")

    header = struct.pack(">IIBBBBB", width, height, 8 * pixels.dtype.itemsize, _COLOR_TYPE[channels], 0, 0, 0)
    file.write(SIGNATURE)
    _write_chunk(file, b"IHDR", header)
    _write_chunk(file, b"cICP", _CICP)
    _write_chunk(file, b"cHRM", _CHRM)
    _write_chunk(file, b"gAMA", _GAMA)
    _write_chunk(file, b"sRGB", b"\0")
    for keyword, value in text.items():
        _write_chunk(file, b"iTXt", _text_chunk(keyword, value))
    packer = zlib.compressobj(LEVEL, zlib.DEFLATED, 15, 9, zlib.Z_FILTERED)
    for rows in _filtered_bands(pixels):
        data = packer.compress(rows)
        if data:
            _write_chunk(file, b"IDAT", data)
    _write_chunk(file, b"IDAT", packer.flush())
    _write_chunk(file, b"IEND", b"")


def read_png_text(path: str | os.PathLike) -> dict[str, str] | None:
    """The text of a PNG if the file is whole, else None.

    Whole means: signature, every chunk with its right checksum, pixel data that unpack to the last row, and
    the end mark. A truncated or overwritten file gives None.

    Returns
    -------
    dict of str to str, or None
    """
    text: dict[str, str] = {}
    expected = unpacked = 0
    unpacker = zlib.decompressobj()
    try:
        with open(path, "rb") as file:
            if file.read(8) != SIGNATURE:
                return None
            for kind, data in _chunks(file):
                if kind == b"IHDR":
                    width, height, depth, color = struct.unpack(">IIBB", data[:10])
                    channels = {0: 1, 2: 3, 4: 2, 6: 4}[color]
                    expected = height * (1 + width * channels * depth // 8)
                elif kind == b"iTXt":
                    keyword, value = _parse_text(data)
                    text[keyword] = value
                elif kind == b"IDAT":
                    unpacked += len(unpacker.decompress(data))
                elif kind == b"IEND":
                    return text if unpacked == expected and unpacker.eof else None
    except (OSError, ValueError, KeyError, struct.error, zlib.error):
        return None
    return None


# --- chunks -------------------------------------------------------------------------------------------------


def _write_chunk(file: BinaryIO, kind: bytes, data: bytes) -> None:
    file.write(struct.pack(">I", len(data)) + kind)
    file.write(data)
    file.write(struct.pack(">I", zlib.crc32(data, zlib.crc32(kind))))


def _chunks(file: BinaryIO) -> Iterator[tuple[bytes, bytes]]:
    """Kinds and contents up to the first that is broken, which raises ValueError."""
    while head := file.read(8):
        length, kind = struct.unpack(">I4s", head)
        data = file.read(length)
        (checksum,) = struct.unpack(">I", file.read(4))
        if len(data) != length or zlib.crc32(data, zlib.crc32(kind)) != checksum:
            raise ValueError(f"chunk {kind!r} is broken")
        yield kind, data


def _text_chunk(keyword: str, value: str) -> bytes:
    # iTXt: keyword, not compressed, no language, no translated keyword, UTF-8
    return keyword.encode("latin-1") + b"\0\0\0\0\0" + value.encode()


def _parse_text(data: bytes) -> tuple[str, str]:
    keyword, rest = data.split(b"\0", 1)
    packed, rest = rest[0], rest[2:]
    _language, _translated, value = rest.split(b"\0", 2)
    if packed:
        value = zlib.decompress(value)
    return keyword.decode("latin-1"), value.decode()


# --- filters ------------------------------------------------------------------------------------------------


def _filtered_bands(pixels: np.ndarray) -> Iterator[bytes]:
    """Rows with their filter byte, some at a time."""
    height, width, channels = pixels.shape
    step = channels * pixels.dtype.itemsize
    above = np.zeros((1, width * step), np.uint8)
    for start in range(0, height, _BAND):
        band = np.ascontiguousarray(pixels[start : start + _BAND])
        if band.dtype == np.uint16:
            band = band.astype(">u2")
        rows = band.view(np.uint8).reshape(len(band), width * step)
        yield _filter(rows, np.concatenate([above, rows[:-1]]), step).tobytes()
        above = rows[-1:]


def _filter(rows: np.ndarray, above: np.ndarray, step: int) -> np.ndarray:
    """The best of the five filters for each row, given the row over each; the filter byte comes first."""
    left = np.zeros_like(rows)
    left[:, step:] = rows[:, :-step]
    corner = np.zeros_like(rows)
    corner[:, step:] = above[:, :-step]
    average = ((left.astype(np.uint16) + above) >> 1).astype(np.uint8)
    # Unsigned arithmetic wraps modulo 256, as the specification wants.
    candidates = [rows, rows - left, rows - above, rows - average, rows - _paeth(left, above, corner)]
    costs = np.stack(
        [np.abs(c.view(np.int8).astype(np.int16)).sum(axis=1, dtype=np.int64) for c in candidates]
    )
    choice = costs.argmin(axis=0)
    out = np.empty((len(rows), 1 + rows.shape[1]), np.uint8)
    out[:, 0] = choice
    for number, candidate in enumerate(candidates):
        chosen = choice == number
        out[chosen, 1:] = candidate[chosen]
    return out


def _paeth(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
    """Which of left, above and corner is nearest to a + b − c (section 9.4), ties in this order."""
    a16, b16, c16 = a.astype(np.int16), b.astype(np.int16), c.astype(np.int16)
    to_a = np.abs(b16 - c16)
    to_b = np.abs(a16 - c16)
    to_c = np.abs(a16 + b16 - 2 * c16)
    return np.where((to_a <= to_b) & (to_a <= to_c), a, np.where(to_b <= to_c, b, c))
