"""GeoTIFF elevations by tifffile (extra ``geotiff``): the tags that place a raster, and nothing of GDAL."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ..world.errors import WorldError
from .elevation import _LARGEST, ElevationGrid, _check_degrees, checked_heights

# GeoKeys (OGC GeoTIFF 1.1, section 7)
_MODEL_TYPE, _RASTER_TYPE, _PROJECTED = 1024, 1025, 3072
_UNIT_LINEAR = 3076


def read_geotiff(path: Path) -> ElevationGrid:
    """First page of a GeoTIFF → `ElevationGrid`; WorldError for what is not understood."""
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
            if int(np.prod(page.shape)) > _LARGEST:
                raise WorldError(f"{path}: {page.shape} samples; at most {_LARGEST:,} are read")
            heights = page.asarray()
    except WorldError:
        raise
    except Exception as error:
        raise WorldError(
            f"{path}: not a readable TIFF ({(str(error).splitlines() or ['no reason given'])[0][:120]})"
        ) from None
    if heights.ndim == 3 and 1 in (heights.shape[0], heights.shape[-1]):
        heights = heights.squeeze()
    scale, tie = tags.get(33550), tags.get(33922)
    if scale is None or tie is None or len(scale) < 2 or len(tie) < 6:
        raise WorldError(
            f"{path}: no ModelPixelScale and ModelTiepoint tags: the picture does not say where it lies"
        )
    if not (np.isfinite(scale).all() and np.isfinite(tie).all()) or scale[0] <= 0 or scale[1] <= 0:
        raise WorldError(f"{path}: ModelPixelScale {tuple(scale[:2])} must be two positive numbers")
    keys = _geokeys(tags.get(34735))
    # pixel-is-area: the tie point names the corner of the pixel, its centre lies half a step further
    half = 0.0 if keys.get(_RASTER_TYPE) == 2 else 0.5
    x = (float(tie[3] + (half - tie[0]) * scale[0]), float(scale[0]))
    y = (float(tie[4] - (half - tie[1]) * scale[1]), -float(scale[1]))
    checked = checked_heights(path, "the first page", heights, _nodata(tags.get(42113)))
    crs = _crs(path, keys)
    if crs == "geographic":
        _check_degrees(path, x, checked.shape[1], y, checked.shape[0])
    return ElevationGrid(checked, x, y, crs, path.name)


def _crs(path: Path, keys: dict[int, int]):
    if keys.get(_MODEL_TYPE, 2) == 2:
        return "geographic"
    code = keys.get(_PROJECTED, 0)
    for base, south in ((32600, False), (32700, True)):
        if base < code <= base + 60 and keys.get(_UNIT_LINEAR, 9001) == 9001:
            return ("utm", code - base, south)
    raise WorldError(
        f"{path}: projection EPSG:{code or '?'} is not read; allowed are degrees (EPSG:4326), UTM on WGS84 "
        "(EPSG:32601-32660, 32701-32760): gdalwarp -t_srs EPSG:4326 in.tif out.tif"
    )


def _geokeys(directory) -> dict[int, int]:
    if directory is None or len(directory) < 4:
        return {}
    entries = np.asarray(directory)[4:]
    rows = entries[: len(entries) // 4 * 4].reshape(-1, 4)
    return {int(key): int(value) for key, location, _, value in rows if location == 0}


def _nodata(text) -> float | None:
    try:
        value = float(str(text).strip("\x00 "))
    except ValueError:
        return None
    return value if np.isfinite(value) else None
