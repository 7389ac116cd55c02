"""NumPy archives: heights and their position under names."""

from __future__ import annotations

import zipfile
from pathlib import Path

import numpy as np

from ...world.errors import WorldError
from .checks import Axes, Axis, axes_from_edges, check_degrees, check_shape, crs_by_name
from .grid import ElevationGrid
from .raster import ArrayRaster

_HEIGHT_KEYS = ("elevation", "heights", "topo", "z")
_EDGES = (("xmin", "xmax", "ymin", "ymax"), ("west", "east", "south", "north"))
_LARGEST = 12_000 * 12_000  # samples: an archive is unpacked into memory


def read_npz(path: Path) -> ElevationGrid:
    """See docs/terrain.md for the keys; WorldError for what is missing or not understood."""
    try:
        with zipfile.ZipFile(path) as archive:
            if sum(item.file_size for item in archive.infolist()) > 8 * _LARGEST:
                raise WorldError(
                    f"{path}: holds more than {_LARGEST:,} samples when unpacked; cut it to the place shown"
                )
        with np.load(path, allow_pickle=False) as archive:
            data = {key: archive[key] for key in archive.files}
    except WorldError:
        raise
    except Exception as error:
        reason = (str(error).splitlines() or ["no reason given"])[0][:120]
        raise WorldError(f"{path}: not a readable .npz ({reason})") from None
    key = next((k for k in _HEIGHT_KEYS if k in data), None)
    if key is None:
        raise WorldError(
            f"{path}: no heights; one of the keys {', '.join(_HEIGHT_KEYS)} is needed, "
            f"found {', '.join(data)[:200] or 'none'}"
        )
    heights = data[key]
    check_shape(path, key, heights.shape, heights.dtype)
    nodata = _number(path, data, "nodata") if "nodata" in data else None
    crs = crs_by_name(path, str(data["crs"]) if "crs" in data else "geographic")
    x, y = _axes(path, data, heights.shape)
    if crs == "geographic":
        check_degrees(path, x, heights.shape[1], y, heights.shape[0])
    return ElevationGrid(ArrayRaster(heights, str(path), nodata), x, y, crs, path.name)


def _axes(path: Path, data: dict, shape: tuple[int, int]) -> Axes:
    if "longitude" in data and "latitude" in data:
        return _axis(path, data, "longitude", shape[1]), _axis(path, data, "latitude", shape[0])
    names = next((k for k in _EDGES if set(k) <= set(data)), None)
    if names is None:
        raise WorldError(
            f"{path}: no position; needed are xmin, xmax, ymin, ymax (or west, east, south, north) "
            "or longitude and latitude"
        )
    return axes_from_edges(path, names, tuple(_number(path, data, k) for k in names), shape)


def _number(path: Path, data: dict, key: str) -> float:
    try:
        value = float(np.asarray(data[key]).item())
    except (ValueError, TypeError):
        raise WorldError(f"{path}: {key} must be one number, it has shape {np.shape(data[key])}") from None
    if not np.isfinite(value):
        raise WorldError(f"{path}: {key} is {value}; it must be finite")
    return value


def _axis(path: Path, data: dict, key: str, count: int) -> Axis:
    values = np.asarray(data[key])
    if values.shape != (count,) or values.dtype.kind not in "iuf" or not np.isfinite(values).all():
        raise WorldError(
            f"{path}: {key} must be {count} finite numbers, one for each sample; its shape is {values.shape}"
        )
    values = values.astype(float)
    step = (values[-1] - values[0]) / max(count - 1, 1)
    if step == 0.0 or np.abs(np.diff(values) - step).max() > 0.02 * abs(step):
        raise WorldError(f"{path}: {key} must be evenly spaced (within 2 %)")
    return float(values[0]), float(step)
