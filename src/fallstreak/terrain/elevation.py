"""Elevation files → one grid of heights that knows where it lies.

Accepted:

- ``.npz`` with the heights under ``elevation`` (or ``heights``, ``topo``, ``z``) and, in degrees, either the
  outer edges ``xmin xmax ymin ymax`` (or ``west east south north``) or the sample positions ``longitude`` and
  ``latitude`` (1-D). With edges the first row is the northern one, as in a picture, whichever of ymin and
  ymax is larger: matplotlib's sample writes the top as ymin. ``crs = "metres"`` says that x and y are metres
  east and north of the anchor instead of degrees. ``nodata`` names a value that means "unknown".
- GeoTIFF (extra ``geotiff``): ModelPixelScale and ModelTiepoint, geographic (EPSG:4326 and the like) or UTM
  on WGS84 (EPSG:326xx, 327xx).

Heights are metres above sea level. Unknown samples (nodata, NaN, below −12 km or above 30 km) are filled from
their surroundings.
"""

from __future__ import annotations

import zipfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ..world.errors import WorldError
from .projection import geographic_from_map, geographic_from_utm, map_from_geographic, utm_from_geographic

_HEIGHT_KEYS = ("elevation", "heights", "topo", "z")
_LARGEST = 12_000 * 12_000  # samples: a bound on what a hostile header can make us allocate


@dataclass(frozen=True)
class ElevationGrid:
    """Heights on a regular grid.

    Attributes
    ----------
    heights : (rows, columns) float32, m above sea level; no unknowns x, y : position of the first sample's
    centre and the step to the next: (start, step); y's step is negative when
        the first row is the northern one
    crs : "geographic" (degrees), "metres" (east and north of the anchor) or ("utm", zone, south)
    name : for messages
    """

    heights: np.ndarray
    x: tuple[float, float]
    y: tuple[float, float]
    crs: Any
    name: str

    def pixels(self, east, north, place, radius: float):
        """Map coordinates (m) → fractional column and row; sample centres are whole numbers."""
        if self.crs == "metres":
            x, y = east, north
        else:
            latitude, longitude = geographic_from_map(east, north, place, radius)
            if self.crs == "geographic":
                # one meridian may be written 275 or -85: take the turn nearest to the file's middle
                middle = self.x[0] + 0.5 * self.x[1] * self.heights.shape[1]
                x, y = longitude - 360.0 * np.round((longitude - middle) / 360.0), latitude
            else:
                x, y = utm_from_geographic(latitude, longitude, *self.crs[1:])
        return (x - self.x[0]) / self.x[1], (y - self.y[0]) / self.y[1]

    def map_position(self, column, row, place, radius: float):
        """Fractional column and row → (east, north) on the map, m."""
        x, y = self.x[0] + self.x[1] * np.asarray(column), self.y[0] + self.y[1] * np.asarray(row)
        if self.crs == "metres":
            return x, y
        if self.crs == "geographic":
            return map_from_geographic(y, x, place, radius)
        return map_from_geographic(*geographic_from_utm(x, y, *self.crs[1:]), place, radius)

    def spacing(self, place, radius: float) -> float:
        """Distance between samples at the grid's middle, m (geometric mean of both directions)."""
        rows, columns = self.heights.shape
        c, r = 0.5 * (columns - 1), 0.5 * (rows - 1)
        e, n = self.map_position(np.array([c, c + 1, c]), np.array([r, r, r + 1]), place, radius)
        return float(np.sqrt(abs((e[1] - e[0]) * (n[2] - n[0]) - (n[1] - n[0]) * (e[2] - e[0]))))


def read_elevation(path: str | Path) -> ElevationGrid:
    """Read a file by its ending.

    Raises
    ------
    WorldError
        With file, key and what is allowed, for anything that is missing, broken or not understood.
    """
    path = Path(path)
    try:
        return _read(path)
    except WorldError as error:
        raise WorldError(f"terrain.file: {error}") from None


def _read(path: Path) -> ElevationGrid:
    if not path.is_file():
        raise WorldError(f"{path} does not exist; give a .npz or GeoTIFF with elevations")
    ending = path.suffix.lower()
    if ending == ".npz":
        return _read_npz(path)
    if ending in (".tif", ".tiff"):
        from .geotiff import read_geotiff

        return read_geotiff(path)
    raise WorldError(f'{path} ends in "{path.suffix}"; elevations are read from .npz, .tif and .tiff')


def _read_npz(path: Path) -> ElevationGrid:
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
        raise WorldError(f"{path}: not a readable .npz ({str(error).splitlines()[0][:120]})") from None
    key = next((k for k in _HEIGHT_KEYS if k in data), None)
    if key is None:
        raise WorldError(
            f"{path}: no heights; one of the keys {', '.join(_HEIGHT_KEYS)} is needed, "
            f"found {', '.join(data) or 'none'}"
        )
    heights = data[key]
    nodata = _number(path, data, "nodata") if "nodata" in data else None
    crs = str(data["crs"]) if "crs" in data else "geographic"
    if crs not in ("geographic", "metres"):
        raise WorldError(f'{path}: crs is "{crs[:40]}"; allowed are "geographic" (degrees) and "metres"')
    heights = checked_heights(path, key, heights, nodata)
    rows, columns = heights.shape
    if "longitude" in data and "latitude" in data:
        x = _axis(path, data, "longitude", columns)
        y = _axis(path, data, "latitude", rows)
    else:
        names = next(
            (
                k
                for k in (("xmin", "xmax", "ymin", "ymax"), ("west", "east", "south", "north"))
                if set(k) <= set(data)
            ),
            None,
        )
        if names is None:
            raise WorldError(
                f"{path}: no position; needed are xmin, xmax, ymin, ymax (or west, east, south, north) "
                "or longitude and latitude"
            )
        west, east, bottom, top = (_number(path, data, k) for k in names)
        if west == east or bottom == top:
            raise WorldError(f"{path}: {names[0]}..{names[3]} enclose no area")
        west, east, bottom, top = min(west, east), max(west, east), min(bottom, top), max(bottom, top)
        dx, dy = (east - west) / columns, (top - bottom) / rows
        x, y = (west + 0.5 * dx, dx), (top - 0.5 * dy, -dy)
    if crs == "geographic":
        _check_degrees(path, x, columns, y, rows)
    return ElevationGrid(heights, x, y, crs, path.name)


def _check_degrees(path, x, columns, y, rows) -> None:
    north, south = max(y[0], y[0] + y[1] * (rows - 1)), min(y[0], y[0] + y[1] * (rows - 1))
    if south < -90.0 or north > 90.0 or abs(x[0]) > 540.0 or abs(x[1]) * columns > 360.5:
        raise WorldError(
            f"{path}: latitude {south:.6g}..{north:.6g}, longitude {x[0]:.6g} by {x[1]:.6g} are no degrees; "
            'projected metres need crs = "metres"'
        )


def _number(path: Path, data: dict, key: str) -> float:
    try:
        value = float(np.asarray(data[key]).item())
    except (ValueError, TypeError):
        raise WorldError(f"{path}: {key} must be one number, it has shape {np.shape(data[key])}") from None
    if not np.isfinite(value):
        raise WorldError(f"{path}: {key} is {value}; it must be finite")
    return value


def _axis(path: Path, data: dict, key: str, count: int) -> tuple[float, float]:
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


def checked_heights(path: Path, key: str, heights: np.ndarray, nodata: float | None) -> np.ndarray:
    """Any 2-D numeric array → float32 without unknowns; WorldError when it is no such array."""
    if heights.ndim != 2 or min(heights.shape) < 4 or heights.dtype.kind not in "iuf":
        raise WorldError(
            f"{path}: {key} must be a 2-D array of numbers, at least 4 × 4; "
            f"it is {heights.dtype} of shape {heights.shape}"
        )
    if heights.size > _LARGEST:
        raise WorldError(f"{path}: {key} has {heights.size:,} samples; at most {_LARGEST:,} are read")
    values = heights.astype(np.float32)
    unknown = ~np.isfinite(values) | (values < -12e3) | (values > 30e3)
    if nodata is not None:
        unknown |= values == np.float32(nodata)
    if unknown.all():
        raise WorldError(f"{path}: {key} holds no height between -12 and 30 km")
    return fill_voids(values, unknown) if unknown.any() else values


def fill_voids(values: np.ndarray, unknown: np.ndarray) -> np.ndarray:
    """Fill unknown samples by means of ever coarser neighbourhoods (push-pull, Gortler et al. 1996)."""
    weight = (~unknown).astype(np.float32)
    total = np.where(unknown, 0.0, values).astype(np.float32)
    if min(values.shape) <= 1 or not unknown.any():
        return np.where(unknown, total.sum() / max(weight.sum(), 1.0), values).astype(np.float32)
    pad = [(0, n % 2) for n in values.shape]
    shape = tuple((n + 1) // 2 for n in values.shape)
    w = np.pad(weight, pad).reshape(shape[0], 2, shape[1], 2).sum((1, 3))
    v = np.pad(total, pad).reshape(shape[0], 2, shape[1], 2).sum((1, 3)) / np.maximum(w, 1.0)
    coarse = fill_voids(v, w == 0.0)
    rows, columns = ((np.arange(n) - 0.5) / 2.0 for n in values.shape)
    return np.where(unknown, bilinear(coarse, columns[None, :], rows[:, None]), values).astype(np.float32)


def bilinear(grid: np.ndarray, column, row) -> np.ndarray:
    """Bilinear samples of ``grid`` at fractional positions, the edge repeated outside."""
    column = np.clip(column, 0.0, grid.shape[1] - 1.0)
    row = np.clip(row, 0.0, grid.shape[0] - 1.0)
    j, i = (
        np.minimum(column.astype(int), max(grid.shape[1] - 2, 0)),
        np.minimum(row.astype(int), max(grid.shape[0] - 2, 0)),
    )
    fx, fy = column - j, row - i
    j1, i1 = np.minimum(j + 1, grid.shape[1] - 1), np.minimum(i + 1, grid.shape[0] - 1)
    top = grid[i, j] * (1.0 - fx) + grid[i, j1] * fx
    return top * (1.0 - fy) + (grid[i1, j] * (1.0 - fx) + grid[i1, j1] * fx) * fy
