"""What every format's reader asks of a file, each answered by one sentence when it is not so."""

from __future__ import annotations

import os
import re
import stat
from pathlib import Path
from typing import Any

import numpy as np

from ...world.errors import WorldError, shorten
from .raster import MOST_SAMPLES

Axis = tuple[float, float]
"""Centre of the first sample and step to the next."""
Axes = tuple[Axis, Axis]


def check_regular(path: Path) -> None:
    """A regular file: opening a pipe would wait for ever, a device has no end."""
    try:
        mode = os.stat(path).st_mode
    except (OSError, ValueError) as error:
        if isinstance(error, FileNotFoundError):
            raise WorldError(f"{path} does not exist; give a file with elevations") from None
        reason = getattr(error, "strerror", None) or str(error)
        raise WorldError(f"{shorten(str(path), 120)} cannot be read: {reason}") from None
    if not stat.S_ISREG(mode):
        kind = "a folder" if stat.S_ISDIR(mode) else "a device or a pipe"
        raise WorldError(f"{path} is {kind}, and elevations are read from regular files")


def check_shape(path: Path, key: str, shape: tuple[int, ...], kind: Any) -> None:
    """A 2-D array of numbers, neither tiny nor monstrous."""
    dtype = np.dtype(kind)
    if len(shape) != 2 or min(shape) < 4 or dtype.kind not in "iuf":
        raise WorldError(
            f"{path}: {key} must be a 2-D array of numbers, at least 4 × 4; it is {dtype} of shape {shape}"
        )
    if shape[0] * shape[1] > MOST_SAMPLES:
        raise WorldError(
            f"{path}: {key} has {shape[0] * shape[1]:,} samples; at most {MOST_SAMPLES:,} are read"
        )


def check_degrees(path: Path, x: Axis, columns: int, y: Axis, rows: int) -> None:
    """Positions that can be degrees."""
    north, south = max(y[0], y[0] + y[1] * (rows - 1)), min(y[0], y[0] + y[1] * (rows - 1))
    if south < -90.0 or north > 90.0 or abs(x[0]) > 540.0 or abs(x[1]) * columns > 360.5:
        raise WorldError(
            f"{path}: latitude {south:.6g}..{north:.6g}, longitude {x[0]:.6g} by {x[1]:.6g} are no degrees; "
            'projected metres need crs = "metres"'
        )


def crs_by_code(code: int) -> Any:
    """The reference system of an EPSG code: degrees or UTM (WGS84, ETRS89, NAD83); None for others."""
    if 4000 < code < 5000:
        return "geographic"
    # base, zones, southern: European and American surveys differ from WGS84 by about a metre
    for base, zones, south in ((32600, 60, False), (32700, 60, True), (25800, 60, False), (26900, 23, False)):
        if base < code <= base + zones:
            return ("utm", code - base, south)
    return None


def crs_by_name(path: Path, name: str) -> Any:
    """The reference system that a file names; WorldError for one that is not read."""
    code = re.fullmatch(r"(?i:epsg):(\d{4,5})", name)
    crs = crs_by_code(int(code.group(1))) if code else name if name in ("geographic", "metres") else None
    if crs is None:
        raise WorldError(
            f'{path}: crs is "{name[:40]}"; allowed are "geographic" (degrees), "metres" (east and north of '
            'the anchor) and UTM on WGS84, "EPSG:32601" to "EPSG:32660" and "EPSG:32701" to "EPSG:32760"'
        )
    return crs


def axes_from_edges(path: Path, names: tuple[str, ...], edges: tuple[float, ...], shape) -> Axes:
    """Outer edges (two of x, two of y, either order) → first sample's centre and step; row 0 is north."""
    if edges[0] == edges[1] or edges[2] == edges[3]:
        raise WorldError(f"{path}: {names[0]}..{names[3]} enclose no area")
    (west, east), (bottom, top) = sorted(edges[:2]), sorted(edges[2:])
    dx, dy = (east - west) / shape[1], (top - bottom) / shape[0]
    return (west + 0.5 * dx, dx), (top - 0.5 * dy, -dy)
