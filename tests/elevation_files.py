"""Elevation files of all formats, of one hill whose height is known everywhere."""

from __future__ import annotations

import zipfile
from pathlib import Path

import numpy as np
from PIL import Image


def hill(latitude, longitude):
    """Smooth heights (m) by latitude and longitude (degrees), 300 to 1700."""
    return (
        1000.0
        + 400.0 * np.sin(2.1 * np.radians(90.0 * latitude))
        + 300.0 * np.cos(np.radians(120.0 * longitude))
    )


def write_hgt(folder: Path, south: int, west: int, side: int = 1201, void=None, zipped=False) -> Path:
    """An SRTM tile; `void` is a pair of slices that become −32768."""
    name = f"{'NS'[south < 0]}{abs(south):02d}{'EW'[west < 0]}{abs(west):03d}.hgt"
    latitude = south + 1.0 - np.arange(side) / (side - 1)
    longitude = west + np.arange(side) / (side - 1)
    heights = np.rint(hill(latitude[:, None], longitude[None, :])).astype(">i2")
    if void is not None:
        heights[void] = -32768
    if zipped:
        path = folder / f"{name}.zip"
        with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
            archive.writestr(name, heights.tobytes())
        return path
    (folder / name).write_bytes(heights.tobytes())
    return folder / name


def write_terrarium(folder: Path, z: int, x: int, y: int, side: int = 256) -> Path:
    """A tile z/x/y.png."""
    n = side * 2**z
    longitude = (x * side + np.arange(side) + 0.5) / n * 360.0 - 180.0
    latitude = np.degrees(np.arctan(np.sinh(np.pi * (1.0 - 2.0 * (y * side + np.arange(side) + 0.5) / n))))
    stored = np.rint((hill(latitude[:, None], longitude[None, :]) + 32768.0) * 256.0).astype(np.uint32)
    rgb = np.stack([stored >> 16, (stored >> 8) & 255, stored & 255], -1).astype(np.uint8)
    path = folder / str(z) / str(x) / f"{y}.png"
    path.parent.mkdir(parents=True, exist_ok=True)
    Image.fromarray(rgb).save(path)
    return path


def write_png(path: Path, west, east, south, north, shape=(60, 80), scale=0.05, offset=-100.0) -> Path:
    """A 16-bit picture without its sidecar, by outer edges."""
    latitude = north - (np.arange(shape[0]) + 0.5) / shape[0] * (north - south)
    longitude = west + (np.arange(shape[1]) + 0.5) / shape[1] * (east - west)
    stored = np.rint((hill(latitude[:, None], longitude[None, :]) - offset) / scale).astype(np.uint16)
    Image.fromarray(stored).save(path)
    return path


def tile_of(latitude: float, longitude: float, z: int) -> tuple[int, int]:
    """The web-map tile of a place."""
    x = int((longitude + 180.0) / 360.0 * 2**z)
    y = int((1.0 - np.arcsinh(np.tan(np.radians(latitude))) / np.pi) / 2.0 * 2**z)
    return x, y
