"""Maps of coverage: from files to a square of texels in map metres, the same for CPU and GPU.

A grey PNG of 8 or 16 bits (black 0, white 1) lies where ``map.toml`` beside ``map.png`` says: the outer edges
``west east south north`` in degrees, or in metres from the anchor with ``crs = "metres"``. An .npz holds
``coverage`` (rows, columns), 0 to 1, and may hold ``east`` and ``north`` (m from the anchor) or ``lon`` and
``lat`` (degrees), the places of its columns and rows. What does not say where it lies is centred on the
anchor, north up, ``coverage_extent`` wide. Outside of a map there is its mean.
"""

from __future__ import annotations

import tomllib
import zipfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ...world.errors import WorldError, shorten

SIZE = 512
_MARGIN = 0.1  # of the map's width, on which it fades into its mean
_LARGEST = 12_000 * 12_000
_FARTHEST = 2.1e7  # m: halfway around the Earth
_EDGES = ("west", "east", "south", "north")


@dataclass(frozen=True, eq=False)
class CoverageMap:
    """Coverage by place.

    Attributes
    ----------
    values : (512, 512) float32
        0 to 1; rows from the south, columns from the west; the border is the map's mean.
    corner, extent : (float, float)
        South-west corner and width and height, m on the map.
    """

    values: np.ndarray
    corner: tuple[float, float]
    extent: tuple[float, float]

    @property
    def per_metre(self) -> tuple[float, float]:
        return 1.0 / self.extent[0], 1.0 / self.extent[1]

    def place(self, east: Any, north: Any) -> tuple[Any, Any]:
        """Map metres as parts of the width and the height."""
        return (east - self.corner[0]) / self.extent[0], (north - self.corner[1]) / self.extent[1]

    def at(self, east: Any, north: Any) -> np.ndarray:
        """Bilinear between the middles of texels; twin of ``on_map`` in ``coverage.wesl``."""
        x, y = self.place(east, north)
        return _bilinear(self.values, np.asarray(x) * SIZE - 0.5, np.asarray(y) * SIZE - 0.5)


@dataclass(frozen=True)
class _Raster:
    """Values with the places of their columns and rows, ascending; in degrees, or in metres."""

    values: np.ndarray
    columns: np.ndarray
    rows: np.ndarray
    degrees: bool


def read_coverage(world: Any, index: int) -> CoverageMap | None:
    """The coverage map of a layer; None if it has none.

    Raises
    ------
    WorldError
        One sentence that names the file, what is wrong with it and what is right.
    """
    layer = world.clouds.layers[index]
    if not layer.coverage_map:
        return None
    path = Path(layer.coverage_map)
    readers = {".png": _read_png, ".npz": _read_npz}
    reader = readers.get(path.suffix.lower())
    key = f"clouds.layers[{index}].coverage_map"
    if reader is None:
        raise WorldError(f"{key} = {shorten(str(path), 120)}: coverage is read from .png and .npz")
    try:
        raster = reader(path, layer.coverage_extent)
    except OSError as error:
        raise WorldError(f"{key}: {path}: cannot be read ({error.strerror or error})") from None
    except WorldError as error:
        raise WorldError(f"{key}: {error}") from None
    return _resampled(raster, world)


def _read_png(path: Path, extent: float) -> _Raster:
    from PIL import Image

    try:
        with Image.open(path, formats=("PNG",)) as image:
            width, height = image.size
            mode = image.mode
            if width * height > _LARGEST:
                raise WorldError(f"{path}: {width} × {height} pixels; at most {_LARGEST:,} are read")
            if mode not in ("1", "L", "LA", "I", "I;16", "I;16B"):
                raise WorldError(f"{path}: its pixels are {mode}; coverage is read from grey PNG")
            pixels = np.asarray(image.getchannel(0) if mode == "LA" else image)
    except (WorldError, OSError) as error:
        if isinstance(error, OSError) and error.errno is None:
            raise WorldError(f"{path}: not a readable PNG ({_first_line(error)})") from None
        raise
    except Exception as error:  # what broken pictures make Pillow say has no common type
        raise WorldError(f"{path}: not a readable PNG ({_first_line(error)})") from None
    full = {"1": 1.0, "L": 255.0, "LA": 255.0}.get(mode, 65535.0)
    values = pixels[::-1].astype(np.float64) / full
    edges, degrees = _sidecar(path.with_suffix(".toml"))
    if edges is None:
        tall = extent * height / width
        edges = (-0.5 * extent, 0.5 * extent, -0.5 * tall, 0.5 * tall)
    west, east, south, north = edges
    columns = west + (np.arange(width) + 0.5) * (east - west) / width
    return _Raster(values, columns, south + (np.arange(height) + 0.5) * (north - south) / height, degrees)


def _sidecar(path: Path) -> tuple[tuple[float, ...] | None, bool]:
    """Edges, if it is there, and whether they are degrees."""
    if not path.is_file():
        return None, False
    with open(path, "rb") as file:
        data = file.read(1 << 16)
    try:
        keys = tomllib.loads(data.decode("utf-8-sig"))
    except ValueError as error:
        raise WorldError(f"{path}: not readable as TOML ({_first_line(error)})") from None
    for key in keys:
        if key not in (*_EDGES, "crs"):
            raise WorldError(
                f"{path}: {shorten(key)} is not known; allowed are west, east, south, north, crs"
            )
    crs = keys.get("crs", "geographic")
    if crs not in ("geographic", "metres"):
        raise WorldError(f'{path}: crs = {shorten(crs)}; allowed are "geographic" and "metres"')
    edges = []
    for key in _EDGES:
        value = keys.get(key)
        if key not in keys:
            raise WorldError(f"{path}: has no {key}; needed are west, east, south and north")
        if isinstance(value, bool) or not isinstance(value, (int, float)) or not abs(value) <= _FARTHEST:
            raise WorldError(f"{path}: {key} = {shorten(value)}; it must be a number")
        edges.append(float(value))
    west, east, south, north = edges
    if crs == "geographic":
        _check_degrees(path, west, east, south, north)
    if west >= east or south >= north:
        raise WorldError(f"{path}: west {west:g}, east {east:g}, south {south:g}, north {north:g}: west must "
                         "be less than east, south less than north")  # fmt: skip
    return tuple(edges), crs == "geographic"


def _check_degrees(path: Path, west: float, east: float, south: float, north: float) -> None:
    if not (-360.0 <= west <= 360.0 and east - west <= 360.0 and south >= -90.0 and north <= 90.0):
        raise WorldError(
            f"{path}: {west:g} to {east:g} degrees east and {south:g} to {north:g} north; longitudes must "
            "span at most 360, latitudes lie in -90 to 90"
        )


def _read_npz(path: Path, extent: float) -> _Raster:
    try:
        with zipfile.ZipFile(path) as archive:
            if sum(item.file_size for item in archive.infolist()) > 8 * _LARGEST:
                raise WorldError(f"{path}: holds more than {_LARGEST:,} numbers when unpacked")
        with np.load(path, allow_pickle=False) as archive:
            data = {key: np.asarray(archive[key]) for key in archive.files}
    except (WorldError, OSError):
        raise
    except Exception as error:  # zipfile, zlib and numpy have a dozen types for broken archives
        raise WorldError(f"{path}: not a readable .npz ({_first_line(error)})") from None
    if "coverage" not in data:
        raise WorldError(f"{path}: has no array coverage; it holds {', '.join(data)[:120] or 'nothing'}")
    values = _numbers(path, "coverage", data["coverage"], 2)
    if values.min() < 0.0 or values.max() > 1.0:
        raise WorldError(
            f"{path}: coverage goes from {values.min():g} to {values.max():g}; allowed is 0 to 1"
        )
    height, width = values.shape
    for x, y, degrees in (("east", "north", False), ("lon", "lat", True)):
        if x in data or y in data:
            for key in (x, y):
                if key not in data:
                    raise WorldError(f"{path}: has no array {key}, though it has {y if key == x else x}")
            columns = _axis(path, x, data[x], width)
            rows = _axis(path, y, data[y], height)
            values = values[:: -1 if rows[0] > rows[-1] else 1, :: -1 if columns[0] > columns[-1] else 1]
            columns, rows = np.sort(columns), np.sort(rows)
            if degrees:
                _check_degrees(path, columns[0], columns[-1], rows[0], rows[-1])
            return _Raster(values, columns, rows, degrees)
    tall = extent * height / width
    columns = ((np.arange(width) + 0.5) / width - 0.5) * extent
    return _Raster(values[::-1], columns, ((np.arange(height) + 0.5) / height - 0.5) * tall, False)


def _first_line(error: Exception) -> str:
    return (str(error).splitlines() or [type(error).__name__])[0][:120]


def _numbers(path: Path, key: str, array: np.ndarray, dimensions: int) -> np.ndarray:
    if array.dtype.kind not in "fiub" or array.ndim != dimensions or 0 in array.shape:
        raise WorldError(
            f"{path}: {key} is {array.dtype} of shape {array.shape}; it must be numbers in {dimensions} "
            "dimensions"
        )
    values = array.astype(np.float64)
    if not np.isfinite(values).all():
        raise WorldError(f"{path}: {key} holds values that are not finite")
    return values


def _axis(path: Path, key: str, array: np.ndarray, count: int) -> np.ndarray:
    values = _numbers(path, key, array, 1)
    if np.abs(values).max() > _FARTHEST:
        raise WorldError(f"{path}: {key} reaches {np.abs(values).max():g}; allowed is up to {_FARTHEST:g}")
    steps = np.diff(values)
    if len(values) != count or count < 2 or not ((steps > 0.0).all() or (steps < 0.0).all()):
        raise WorldError(
            f"{path}: {key} has {len(values)} values; it must have {count}, all rising or all falling"
        )
    return values


def _resampled(raster: _Raster, world: Any) -> CoverageMap:
    """Brought onto texels in map metres, with a border that fades into the mean."""
    radius = world.planet.radius
    origin = np.radians([world.place.latitude, world.place.longitude])
    half = [0.5 * (axis[-1] - axis[0]) / max(len(axis) - 1, 1) for axis in (raster.columns, raster.rows)]
    x = np.linspace(raster.columns[0] - half[0], raster.columns[-1] + half[0], 65)
    y = np.linspace(raster.rows[0] - half[1], raster.rows[-1] + half[1], 65)
    if raster.degrees:
        lon, lat = np.meshgrid(np.radians(x), np.radians(np.clip(y, -90.0, 90.0)))
        e, n = _map_from_degrees(lat, lon, origin, radius)
    else:
        e, n = np.meshgrid(x, y)
    wide, tall = float(np.ptp(e)) or 1.0, float(np.ptp(n)) or 1.0
    corner = float(e.min()) - _MARGIN * wide, float(n.min()) - _MARGIN * tall
    extent = (1.0 + 2.0 * _MARGIN) * wide, (1.0 + 2.0 * _MARGIN) * tall
    part = (np.arange(SIZE) + 0.5) / SIZE
    e, n = np.meshgrid(corner[0] + part * extent[0], corner[1] + part * extent[1])
    if raster.degrees:
        lat, lon = _degrees_from_map(e, n, origin, radius)
        middle = 0.5 * (x[0] + x[-1])
        u, v = middle + (np.degrees(lon) - middle + 180.0) % 360.0 - 180.0, np.degrees(lat)
    else:
        u, v = e, n
    column = np.interp(u, raster.columns, np.arange(len(raster.columns)))
    row = np.interp(v, raster.rows, np.arange(len(raster.rows)))
    values = _bilinear(raster.values, column, row)
    # how far outside, in parts of the map
    out = np.maximum(
        np.maximum(x[0] - u, u - x[-1]) / (x[-1] - x[0]), np.maximum(y[0] - v, v - y[-1]) / (y[-1] - y[0])
    )
    edge = np.maximum(np.abs(2.0 * part - 1.0)[:, None], np.abs(2.0 * part - 1.0))
    fade = np.maximum(np.clip(out / (0.8 * _MARGIN), 0.0, 1.0), edge > 1.0 - 1.5 / SIZE)
    held = values + fade * (raster.values.mean() - values)
    return CoverageMap(held.astype(np.float32), corner, extent)


def _map_from_degrees(lat: np.ndarray, lon: np.ndarray, origin: np.ndarray, radius: float):
    """Azimuthal equidistant about the anchor (Snyder 1987, "Map Projections", chapter 25), radians → m."""
    s, c = np.sin(origin[0]), np.cos(origin[0])
    x = np.cos(lat) * np.sin(lon - origin[1])
    y = c * np.sin(lat) - s * np.cos(lat) * np.cos(lon - origin[1])
    up = s * np.sin(lat) + c * np.cos(lat) * np.cos(lon - origin[1])
    across = np.hypot(x, y)
    ratio = radius * np.arctan2(across, up) / np.maximum(across, 1e-12)
    return x * ratio, y * ratio


def _degrees_from_map(e: np.ndarray, n: np.ndarray, origin: np.ndarray, radius: float):
    """The way back, radians."""
    s, c = np.sin(origin[0]), np.cos(origin[0])
    distance = np.maximum(np.hypot(e, n), 1e-6)
    angle = np.minimum(distance / radius, np.pi)
    x, y, up = np.sin(angle) * e / distance, np.sin(angle) * n / distance, np.cos(angle)
    lat = np.arcsin(np.clip(s * up + c * y, -1.0, 1.0))
    return lat, origin[1] + np.arctan2(x, c * up - s * y)


def _bilinear(values: np.ndarray, column: np.ndarray, row: np.ndarray) -> np.ndarray:
    height, width = values.shape
    column, row = np.clip(column, 0.0, width - 1.0), np.clip(row, 0.0, height - 1.0)
    i, j = np.floor(column).astype(np.intp), np.floor(row).astype(np.intp)
    k, l = np.minimum(i + 1, width - 1), np.minimum(j + 1, height - 1)
    fx, fy = column - i, row - j
    low = values[j, i] + fx * (values[j, k] - values[j, i])
    high = values[l, i] + fx * (values[l, k] - values[l, i])
    return low + fy * (high - low)
