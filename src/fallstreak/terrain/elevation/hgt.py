"""SRTM tiles (.hgt): one degree square, big-endian 16-bit metres, no header; the name says where it lies.

The name gives the tile's south-western corner in whole degrees; a corner is the centre of a sample. 1201 or
3601 rows run from north to south, the outermost rows and columns are shared with the neighbours, and −32768
stands for a void (NASA JPL, "SRTM Topography", section 2.1).
"""

from __future__ import annotations

import re
import zipfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from ...world.errors import WorldError
from .grid import ElevationGrid
from .raster import Piece, Raster, RawRaster, Span

_SIZES = (1201, 3601)
_VOID = -32768.0
_DTYPE = np.dtype(">i2")


def read_hgt(path: Path) -> ElevationGrid:
    """A tile ``N46E008.hgt``, or one in a zip archive of its own (``N46E008.hgt.zip``)."""
    south, west = _corner(path)
    size = _zipped_size(path) if path.suffix.lower() == ".zip" else path.stat().st_size
    side = next((n for n in _SIZES if 2 * n * n == size), None)
    if side is None:
        expected = " or ".join(f"{2 * n * n:,} ({n} × {n} samples)" for n in _SIZES)
        raise WorldError(f"{path}: {size:,} bytes are no SRTM tile; one has {expected}")
    step = 1.0 / (side - 1)
    if path.suffix.lower() == ".zip":
        raster: Raster = _ZippedTile(path, side)
    else:
        raster = RawRaster(path, 0, (side, side), _DTYPE, str(path), _VOID)
    return ElevationGrid(raster, (west, step), (south + 1.0, -step), "geographic", path.name)


def _corner(path: Path) -> tuple[float, float]:
    match = re.match(r"([ns])(\d{1,2})_?([ew])(\d{1,3})(?!\d)", path.name, re.IGNORECASE)
    south = west = 999.0
    if match:
        south = float(match[2]) * (1 if match[1] in "nN" else -1)
        west = float(match[4]) * (1 if match[3] in "eE" else -1)
    if not (-90.0 <= south <= 89.0 and -180.0 <= west <= 180.0):
        raise WorldError(
            f"{path}: the name of an SRTM tile says where its south-western corner lies, such as N46E008.hgt "
            "(latitude 0 to 90, longitude 0 to 180)"
        )
    return south, west


def _member(archive: zipfile.ZipFile, path: Path) -> zipfile.ZipInfo:
    found = [item for item in archive.infolist() if item.filename.lower().endswith(".hgt")]
    if len(found) != 1:
        raise WorldError(f"{path}: holds {len(found)} .hgt files; one is read")
    return found[0]


def _zipped_size(path: Path) -> int:
    try:
        with zipfile.ZipFile(path) as archive:
            return _member(archive, path).file_size
    except (OSError, zipfile.BadZipFile, ValueError) as error:
        raise WorldError(f"{path}: not a readable zip archive ({str(error)[:120]})") from None


class _ZippedTile(Raster):
    """A tile that is unpacked anew at each reading: 26 MB, which one thread does in a tenth of a second."""

    nodata = _VOID

    def __init__(self, path: Path, side: int):
        self.path, self.name, self.shape = path, str(path), (side, side)

    def pieces(self, rows: Span, columns: Span) -> Iterator[Piece]:
        yield Piece(0, 0, self._load, self.name)

    def _load(self) -> np.ndarray:
        expected = self.shape[0] * self.shape[1] * _DTYPE.itemsize
        try:
            with zipfile.ZipFile(self.path) as archive, archive.open(_member(archive, self.path)) as file:
                # Never more than a tile, whatever the archive claims to hold.
                data = file.read(expected)
        except (
            OSError,
            zipfile.BadZipFile,
            ValueError,
            RuntimeError,
            NotImplementedError,
            EOFError,
        ) as error:
            raise WorldError(f"{self.path}: not a readable zip archive ({str(error)[:120]})") from None
        except Exception as error:  # zlib.error, lzma's: whatever the method of compression raises
            raise WorldError(f"{self.path}: damaged zip archive ({str(error)[:120]})") from None
        if len(data) != expected:
            raise WorldError(f"{self.path}: the .hgt in it ends after {len(data):,} of {expected:,} bytes")
        return np.frombuffer(data, _DTYPE).reshape(self.shape).astype(np.int16)
