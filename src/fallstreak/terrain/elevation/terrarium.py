"""Terrarium tiles: web-map pictures whose colours are heights, ``z/x/y.png``.

Height in metres is 256·red + green + blue/256 − 32768. Tile (x, y) of zoom z is one of 4^z of the square web
Mercator map, x from the antimeridian to the east, y from 85.05° to the south (Mapzen, "Terrain Tiles":
formats; OpenStreetMap, "Slippy map tilenames").
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from ...world.errors import WorldError
from .grid import ElevationGrid
from .png import open_picture, png_header
from .raster import Piece, Raster, Span

MOST_ZOOM = 20
_SIDES = (256, 512)


def tile_address(path: Path) -> tuple[int, int, int] | None:
    """(z, x, y) of a path that ends in z/x/y.png, else None."""
    names = (*path.parts[-3:-1], path.stem)
    if path.suffix.lower() != ".png" or len(names) != 3 or not all(_is_number(name) for name in names):
        return None
    z, x, y = map(int, names)
    return (z, x, y) if z <= MOST_ZOOM and max(x, y) < 2**z else None


def _is_number(name: str) -> bool:
    return name.isascii() and name.isdigit() and len(name) <= 8


def read_terrarium(path: Path) -> ElevationGrid:
    """One tile."""
    address = tile_address(path)
    assert address is not None
    z, x, y = address
    width, height, bits, kind = png_header(path)
    if (bits, kind) not in ((8, 2), (8, 6)) or width != height or width not in _SIDES:
        raise WorldError(
            f"{path}: a Terrarium tile is 8-bit RGB of 256 × 256 or 512 × 512 pixels; this is {bits}-bit, "
            f"colour type {kind}, {width} × {height}"
        )
    # degrees of longitude, and as many along the meridian; the first sample's centre is half a step inside
    step = 360.0 / (width * 2**z)
    first = -180.0 + (x * width + 0.5) * step, 180.0 - (y * width + 0.5) * step
    return ElevationGrid(_Tile(path, width), (first[0], step), (first[1], -step), "mercator", path.name)


class _Tile(Raster):
    """Its colours as one number, in 1/256 m."""

    scale, offset = 1.0 / 256.0, -32768.0

    def __init__(self, path: Path, side: int):
        self.path, self.name, self.shape = path, str(path), (side, side)

    def pieces(self, rows: Span, columns: Span) -> Iterator[Piece]:
        yield Piece(0, 0, self._load, self.name)

    def _load(self) -> np.ndarray:
        colours = np.asarray(open_picture(self.path))
        if colours.shape[:2] != self.shape or colours.ndim != 3:
            raise WorldError(f"{self.path}: is another picture than a moment ago")
        stored = colours[..., 0].astype(np.int32)
        for channel in (1, 2):
            stored <<= 8
            stored |= colours[..., channel]
        return stored
