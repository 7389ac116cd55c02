"""GeoTIFF elevations: tags by tifffile (extra ``geotiff``), tiles and strips one by one, no GDAL."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from ...world.errors import WorldError
from .checks import Axes, check_degrees, check_shape, crs_by_code
from .grid import ElevationGrid
from .raster import Piece, Raster, RawRaster, Span
from .tiff_codecs import Unpacker, UnreadableError, unpacker

# GeoKeys (OGC GeoTIFF 1.1, section 7)
_MODEL_TYPE, _RASTER_TYPE, _PROJECTED = 1024, 1025, 3072
_UNIT_LINEAR = 3076
_LARGEST_PART = 256 << 20  # bytes of a tile or strip, which is unpacked as a whole

# What tifffile remarks on a damaged file goes to whoever listens to logs; ours is one sentence.
logging.getLogger("tifffile").addHandler(logging.NullHandler())


def read_geotiff(path: Path) -> ElevationGrid:
    """First page of a GeoTIFF; WorldError for what is not understood."""
    try:
        import tifffile
    except ImportError:
        raise WorldError(
            f'{path}: reading GeoTIFF needs tifffile: python -m pip install "fallstreak[geotiff]"'
        ) from None
    try:
        with tifffile.TiffFile(path) as tiff:
            page = tiff.pages.first
            tags = {tag.code: tag.value for tag in page.tags.values()}
            raster = _raster(path, page, tiff.byteorder, _nodata(tags.get(42113)))
    except WorldError:
        raise
    except Exception as error:
        reason = (str(error).splitlines() or ["no reason given"])[0][:120]
        raise WorldError(f"{path}: not a readable TIFF ({reason})") from None
    x, y = _axes(path, tags)
    crs = _crs(path, _geokeys(tags.get(34735)))
    if crs == "geographic":
        check_degrees(path, x, raster.shape[1], y, raster.shape[0])
    return ElevationGrid(raster, x, y, crs, path.name)


def _raster(path: Path, page: Any, byteorder: Any, nodata: float | None) -> Raster:
    shape = tuple(n for n in page.shape if n > 1) if len(page.shape) == 3 else tuple(page.shape)
    check_shape(path, "the first page", shape, page.dtype if page.dtype is not None else object)
    dtype = np.dtype(page.dtype).newbyteorder(byteorder)
    if page.bitspersample != 8 * dtype.itemsize:
        raise WorldError(f"{path}: has {page.bitspersample} bits per sample; allowed are 8, 16, 32 and 64")
    size = path.stat().st_size
    if page.is_contiguous and page.compression == 1 and page.fillorder == 1:
        start = page.dataoffsets[0]
        if start + shape[0] * shape[1] * dtype.itemsize > size:
            raise WorldError(f"{path}: is cut off; its heights would end after its {size:,} bytes")
        return RawRaster(path, start, shape, dtype, str(path), nodata)
    part = (
        (page.tilelength, page.tilewidth) if page.is_tiled else (min(page.rowsperstrip, shape[0]), shape[1])
    )
    across = -(-shape[1] // part[1])
    count = across * -(-shape[0] // part[0])
    offsets, sizes = page.dataoffsets, page.databytecounts
    if min(part) < 1 or len(offsets) < count or len(sizes) < count:
        raise WorldError(f"{path}: names {len(offsets):,} of {count:,} tiles or strips; it is damaged")
    if part[0] * part[1] * dtype.itemsize > _LARGEST_PART:
        raise WorldError(
            f"{path}: its tiles or strips hold {part[0]} × {part[1]} samples, too many to unpack one by one: "
            "gdal_translate -co TILED=YES -co COMPRESS=DEFLATE in.tif out.tif"
        )
    if any(o + s > size for o, s in zip(offsets[:count], sizes[:count], strict=True)):
        raise WorldError(f"{path}: is cut off; some of its tiles or strips lie beyond its {size:,} bytes")
    return _Parts(path, shape, part, offsets, sizes, unpacker(path, page, dtype, part), nodata)


class _Parts(Raster):
    """Tiles or strips, compressed one by one."""

    def __init__(self, path: Path, shape, part, offsets, sizes, unpack: Unpacker, nodata: float | None):
        self.path, self.name, self.shape, self.nodata = path, str(path), shape, nodata
        self.part, self.offsets, self.sizes, self.unpack = part, offsets, sizes, unpack
        self.across = -(-shape[1] // part[1])

    def pieces(self, rows: Span, columns: Span) -> Iterator[Piece]:
        high, wide = self.part
        for i in range(rows[0] // high, -(-rows[1] // high)):
            for j in range(columns[0] // wide, -(-columns[1] // wide)):
                yield Piece(i * high, j * wide, lambda i=i, j=j: self._load(i, j), self.name)

    def _load(self, i: int, j: int) -> np.ndarray:
        index = i * self.across + j
        rows = min(self.part[0], self.shape[0] - i * self.part[0])
        columns = min(self.part[1], self.shape[1] - j * self.part[1])
        if self.sizes[index] == 0:
            # a tile that GDAL left out, because nothing is known in it
            return np.full((rows, columns), np.nan, np.float32)
        with open(self.path, "rb") as file:
            file.seek(self.offsets[index])
            data = file.read(self.sizes[index])
        try:
            values = self.unpack(data, index, rows)
        except UnreadableError as error:
            raise WorldError(f"{self.path}: tile or strip {index} is damaged ({error})") from None
        return values[:rows, :columns]


def _axes(path: Path, tags: dict[int, Any]) -> Axes:
    scale, tie = _numbers(tags.get(33550)), _numbers(tags.get(33922))
    if len(scale) < 2 or len(tie) < 6:
        raise WorldError(
            f"{path}: no ModelPixelScale and ModelTiepoint tags: the picture does not say where it lies"
        )
    if not (np.isfinite(scale).all() and np.isfinite(tie).all()) or scale[0] <= 0 or scale[1] <= 0:
        raise WorldError(f"{path}: ModelPixelScale {tuple(scale[:2])} must be two positive numbers")
    # pixel-is-area: the tie point names the corner of the pixel, its centre lies half a step further
    half = 0.0 if _geokeys(tags.get(34735)).get(_RASTER_TYPE) == 2 else 0.5
    x = (float(tie[3] + (half - tie[0]) * scale[0]), float(scale[0]))
    return x, (float(tie[4] - (half - tie[1]) * scale[1]), -float(scale[1]))


def _crs(path: Path, keys: dict[int, int]) -> Any:
    if keys.get(_MODEL_TYPE, 2) == 2:
        return "geographic"
    code = keys.get(_PROJECTED, 0)
    crs = crs_by_code(code) if keys.get(_UNIT_LINEAR, 9001) == 9001 else None
    if isinstance(crs, tuple):
        return crs
    raise WorldError(
        f"{path}: projection EPSG:{code or '?'} is not read; allowed are degrees (EPSG:4326), UTM on WGS84 "
        "(EPSG:32601-32660, 32701-32760): gdalwarp -t_srs EPSG:4326 in.tif out.tif"
    )


def _geokeys(directory: Any) -> dict[int, int]:
    entries = np.asarray(_numbers(directory)[4:])
    rows = entries[: len(entries) // 4 * 4].reshape(-1, 4)
    return {int(key): int(value) for key, location, _, value in rows if location == 0}


def _numbers(value: Any) -> tuple[float, ...]:
    """The numbers of a tag; none where it holds something else."""
    values = value if isinstance(value, tuple) else (value,)
    return values if all(isinstance(v, (int, float)) for v in values) else ()


def _nodata(text: Any) -> float | None:
    try:
        value = float(str(text).strip("\x00 "))
    except ValueError:
        return None
    return value if np.isfinite(value) else None
