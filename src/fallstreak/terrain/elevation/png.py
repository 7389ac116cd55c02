"""Grey 16-bit PNG: heights as brightness, with a neighbour file that says where and how high.

A picture does not know where it lies. Beside ``dem.png`` stands

- ``dem.toml`` or ``dem.json`` with the outer edges ``west east south north`` and, if they differ from the
  defaults, ``scale = 1.0`` and ``offset = 0.0`` (metres = scale · stored + offset), ``nodata`` (a stored
  value that means "unknown") and ``crs`` (``"geographic"``, ``"metres"``, ``"EPSG:32632"``), or
- a world file, ``dem.pgw``, ``dem.pngw`` or ``dem.wld``: six lines A D B E C F, x = A·column + B·row + C and
  y = D·column + E·row + F for sample centres; B and D must be 0.

With both, the sidecar's edges count if it has any.
"""

from __future__ import annotations

import json
import struct
import tomllib
import warnings
from collections.abc import Iterator
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from ...world.errors import WorldError, shorten
from .checks import Axes, axes_from_edges, check_degrees, check_shape, crs_by_name
from .grid import ElevationGrid
from .raster import Piece, Raster, Span
from .scratch import ScratchRaster

LARGEST = 12_000 * 12_000  # samples: a picture can only be unpacked as a whole
_EDGES = ("west", "east", "south", "north")
_KINDS = {0: "grey", 2: "RGB", 3: "palette", 4: "grey with alpha", 6: "RGBA"}
_SIDECARS, _WORLD_FILES = (".toml", ".json"), (".pgw", ".pngw", ".wld")
_SIDECAR_BYTES = 1 << 16


def read_png(path: Path) -> ElevationGrid:
    """A grey 16-bit PNG and its sidecar; WorldError for another kind of PNG or one without position."""
    width, height, bits, kind = png_header(path)
    if (bits, kind) != (16, 0):
        raise WorldError(
            f"{path}: is {bits}-bit {_KINDS[kind]}; elevations are read from 16-bit grey PNG (and Terrarium "
            "tiles, 8-bit RGB, from a path that ends in z/x/y.png)"
        )
    shape = (height, width)
    check_shape(path, "the picture", shape, np.uint16)
    if height * width > LARGEST:
        raise WorldError(
            f"{path}: {width} × {height} samples; of PNG at most {LARGEST:,} are read, since it has no parts "
            "that can be read alone: a tiled GeoTIFF has"
        )
    keys = _sidecar(path)
    crs = crs_by_name(path, keys.get("crs", "geographic"))
    x, y = _axes(path, keys, shape)
    if crs == "geographic":
        check_degrees(path, x, width, y, height)
    raster = _Picture(path, shape, keys.get("scale", 1.0), keys.get("offset", 0.0), keys.get("nodata"))
    return ElevationGrid(raster, x, y, crs, path.name)


def png_header(path: Path) -> tuple[int, int, int, int]:
    """Width, height, bits per channel and colour type (PNG, third edition, 11.2.1); nothing is unpacked."""
    with open(path, "rb") as file:
        head = file.read(26)
    if len(head) < 26 or head[:8] != b"\x89PNG\r\n\x1a\n" or head[12:16] != b"IHDR":
        raise WorldError(f"{path}: not a readable PNG (it does not begin as one)")
    width, height, bits, kind = struct.unpack(">IIBB", head[16:26])
    if kind not in _KINDS:
        raise WorldError(f"{path}: not a readable PNG (colour type {kind})")
    return width, height, bits, kind


def open_picture(path: Path) -> Any:
    """The unpacked Pillow image; WorldError for a broken one."""
    from PIL import Image

    try:
        with Image.open(path, formats=("PNG",)) as image:
            image.load()
    except Exception as error:
        reason = (str(error).splitlines() or ["no reason given"])[0][:120]
        raise WorldError(f"{path}: not a readable PNG ({reason})") from None
    return image


class _Picture(Raster):
    """Unpacked at the first reading, as a whole, and then no longer kept in memory."""

    def __init__(self, path: Path, shape, scale: float, offset: float, nodata: float | None):
        self.path, self.name, self.shape = path, str(path), shape
        self.scale, self.offset, self.nodata = scale, offset, nodata

    @cached_property
    def unpacked(self) -> Raster:
        from PIL.Image import DecompressionBombWarning

        with warnings.catch_warnings():
            # Pillow warns of pictures of 90 million pixels; this one has been measured already.
            warnings.simplefilter("ignore", DecompressionBombWarning)
            image = open_picture(self.path)
        high, wide = self.shape
        parts = (image.crop((0, top, wide, min(top + 256, high))) for top in range(0, high, 256))
        return ScratchRaster(map(np.asarray, parts), self.shape, np.uint16, self.name, self.nodata)

    def pieces(self, rows: Span, columns: Span) -> Iterator[Piece]:
        return self.unpacked.pieces(rows, columns)


def _sidecar(path: Path) -> dict[str, Any]:
    """The keys of the sidecar, checked; empty without one."""
    beside = next((p for p in map(path.with_suffix, _SIDECARS) if p.is_file()), None)
    if beside is None:
        return {}
    with open(beside, "rb") as file:
        data = file.read(_SIDECAR_BYTES + 1)
    try:
        if len(data) > _SIDECAR_BYTES:
            raise ValueError(f"larger than {_SIDECAR_BYTES >> 10} KiB")
        text = data.decode("utf-8-sig")
        keys = tomllib.loads(text) if beside.suffix == ".toml" else json.loads(text)
    except (ValueError, RecursionError) as error:
        raise WorldError(f"{beside}: not readable as {beside.suffix[1:]} ({str(error)[:120]})") from None
    if not isinstance(keys, dict):
        raise WorldError(f"{beside}: must hold keys such as west, east, south, north and scale")
    for key, value in keys.items():
        if key == "crs" and isinstance(value, str):
            continue
        if key not in (*_EDGES, "scale", "offset", "nodata"):
            raise WorldError(
                f"{beside}: {shorten(key)} is not known; allowed are west, east, south, north, scale, "
                "offset, nodata and crs"
            )
        number = isinstance(value, (int, float)) and not isinstance(value, bool)
        if not number or not np.isfinite(value) or abs(value) > 1e9 or (key == "scale" and value == 0):
            expected = "a number other than 0" if key == "scale" else "a number"
            raise WorldError(f"{beside}: {key} = {shorten(value)} is not allowed; it must be {expected}")
    return {key: value if key == "crs" else float(value) for key, value in keys.items()}


def _axes(path: Path, keys: dict[str, Any], shape: tuple[int, int]) -> Axes:
    given = [key for key in _EDGES if key in keys]
    if given:
        missing = [key for key in _EDGES if key not in keys]
        if missing:
            raise WorldError(
                f"{path}: its sidecar has no {missing[0]}; needed are west, east, south and north"
            )
        return axes_from_edges(path, _EDGES, tuple(keys[key] for key in _EDGES), shape)
    beside = next((p for p in map(path.with_suffix, _WORLD_FILES) if p.is_file()), None)
    if beside is None:
        raise WorldError(
            f"{path}: does not say where it lies; put {path.stem}.toml beside it with west, east, south and "
            f"north (and scale, offset), or a world file {path.stem}.pgw"
        )
    with open(beside, "rb") as file:
        words = file.read(4096).split()
    try:
        a, d, b, e, c, f = (float(word) for word in words)
    except ValueError:
        raise WorldError(f"{beside}: a world file holds six numbers, this one is none") from None
    if not np.isfinite([a, b, c, d, e, f]).all() or b != 0.0 or d != 0.0 or a <= 0.0 or e == 0.0:
        raise WorldError(
            f"{beside}: A = {a:g}, D = {d:g}, B = {b:g}, E = {e:g} turn or fold the picture; "
            "allowed are A above 0, E other than 0, and B = D = 0"
        )
    return (c, a), (f, e)
