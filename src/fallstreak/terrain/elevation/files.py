"""One file by its ending, or several as one grid."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from pathlib import Path

from ...world.errors import WorldError
from .checks import check_regular
from .grid import ElevationGrid

_log = logging.getLogger("fallstreak.terrain")
_MOST_NOTES = 5  # files whose voids are said one by one
_GAP = 1e-3  # of the area: less than that is the ragged edge of files that are turned against each other


def read_elevation(paths: str | Path | Sequence[str | Path]) -> ElevationGrid:
    """Read a file by its ending; several are joined.

    The whole is read once, a few tiles or strips at a time, for a copy of at most 2048² samples
    (`ElevationGrid.overview`); so what is damaged is known from here on.

    Parameters
    ----------
    paths : path or sequence of paths
        Where files overlap the finer one counts, of equally fine ones the first.

    Raises
    ------
    WorldError
        With file, key and what is allowed, for anything that is missing, broken or not understood.
    """
    one = isinstance(paths, (str, Path))
    names = [Path(paths)] if one else [Path(path) for path in paths]
    try:
        grids = [_open(path) for path in names]
        grid = grids[0] if len(grids) == 1 else _joined(grids)
        notes = _notes(grid)
    except WorldError as error:
        raise WorldError(f"terrain.file: {error}") from None
    except OSError as error:
        raise WorldError(f"terrain.file: {names[0]} cannot be read: {error.strerror or error}") from None
    for note in notes:
        _log.warning(note)
    return grid


def _notes(grid: ElevationGrid) -> list[str]:
    """What the picture shows although no file knows it."""
    unknown, names = grid.overview.unknown, list(grid.overview.unknown)
    notes = [
        f"{name}: {unknown[name]:,} samples hold no height; they are filled from around" for name in names
    ]
    if len(notes) > _MOST_NOTES:
        rest = sum(unknown[name] for name in names[_MOST_NOTES:])
        more = len(names) - _MOST_NOTES
        notes[_MOST_NOTES:] = [f"{more} more elevation files: {rest:,} samples hold no height"]
    if grid.overview.known is not None:
        voids = sum(unknown.values()) / (grid.shape[0] * grid.shape[1])
        share = 1.0 - float(grid.overview.known.mean()) - voids
        if share > _GAP:
            notes.append(f"{grid.name}: {share:.1%} of the area around the files lies in none of them")
    return notes


def _joined(grids: list[ElevationGrid]) -> ElevationGrid:
    from .mosaic import joined

    return joined(grids)


def _open(path: Path) -> ElevationGrid:
    check_regular(path)
    ending = path.suffix.lower()
    if ending == ".npz":
        from .npz import read_npz

        return read_npz(path)
    if ending in (".tif", ".tiff"):
        from .geotiff import read_geotiff

        return read_geotiff(path)
    if ending == ".hgt" or path.name.lower().endswith(".hgt.zip"):
        from .hgt import read_hgt

        return read_hgt(path)
    if ending == ".png":
        from .png import read_png
        from .terrarium import read_terrarium, tile_address

        return read_terrarium(path) if tile_address(path) else read_png(path)
    raise WorldError(
        f'{path} ends in "{path.suffix[:40]}"; elevations are read from .npz, .tif, .tiff, .hgt, .hgt.zip '
        "and .png"
    )
