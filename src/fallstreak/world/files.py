"""Which files a scene means by a path, a folder or a pattern, and nothing outside of them."""

from __future__ import annotations

import os
from fnmatch import fnmatchcase
from pathlib import Path

from .errors import WorldError, shorten

ENDINGS = (".npz", ".tif", ".tiff", ".hgt", ".hgt.zip", ".png")
"""How names of elevation files end."""
SIDECARS = (".toml", ".json", ".pgw", ".pngw", ".wld")
"""Files of the same name that belong to a picture."""
MOST = 4096
"""Files that one scene may join."""
_WILD = "*?["


def all_files(names: tuple[str | None, ...]) -> tuple[tuple[Path, ...], ...]:
    """For each entry of ``terrain.file`` its `elevation_files`; none for None. At most `MOST` in all."""
    found = tuple(() if name is None else tuple(elevation_files(name)) for name in names)
    if sum(map(len, found)) > MOST:
        raise WorldError(f"the list stands for more than {MOST:,} files; join fewer")
    return found


def elevation_files(name: str) -> list[Path]:
    """The files that one entry of ``terrain.file`` stands for, sorted.

    Parameters
    ----------
    name : str
        An absolute path: of a file; of a folder, for the elevation files in it and for its tiles
        ``z/x/y.png``; or with ``*``, ``?`` and ``[…]``, which stand for parts of names but for no ``/``.

    Raises
    ------
    WorldError
        When there is no such file, when a link leads out of the folder, or when they are too many.
    """
    path = Path(name)
    try:
        if _is_folder(path):
            found, root = _in_folder(path), path
        elif _is_wild(name) and not os.path.lexists(path):
            found, root = _matching(path)
        else:
            return [path]  # whether it is there and readable is for its reader to say
        root = root.resolve()
        for file in found:
            if not file.resolve().is_relative_to(root):
                raise WorldError(f"{file} is a link that leads out of {root}; name the file itself instead")
    except (OSError, RuntimeError, ValueError) as error:
        reason = getattr(error, "strerror", None) or "a loop of links"
        raise WorldError(f"{shorten(name, 120)} cannot be searched: {reason}") from None
    if not found:
        raise WorldError(f"{shorten(name, 120)} holds no elevation file; they end in {', '.join(ENDINGS)}")
    return found


def sidecars(path: Path) -> list[Path]:
    """What stands beside a picture and says where it lies."""
    if path.suffix.lower() != ".png":
        return []
    return [beside for ending in SIDECARS if (beside := path.with_suffix(ending)).is_file()]


def _is_wild(name: str) -> bool:
    return any(c in name for c in _WILD)


def _is_folder(path: Path) -> bool:
    try:
        return path.is_dir()
    except OSError:
        return False  # a name too long: its reader says so


def changed(path: Path) -> int:
    """When a file was last changed, ns; 0 where that cannot be known, as its reader will say."""
    try:
        return path.stat().st_mtime_ns
    except OSError:
        return 0


def _in_folder(folder: Path) -> list[Path]:
    names = [child for child in _children(folder) if _is_elevation(child) and not child.is_dir()]
    tiles = _tiles(folder, 0)
    return _few(names + tiles, folder)


def _tiles(folder: Path, depth: int) -> list[Path]:
    """Tiles z/x/y.png below a folder: three numbers deep, so that no loop of links matters."""
    found: list[Path] = []
    for child in _children(folder):
        if depth < 2 and child.name.isdigit() and child.is_dir():
            found += _few(_tiles(child, depth + 1), folder)
        elif depth == 2 and child.stem.isdigit() and child.suffix.lower() == ".png":
            found.append(child)
    return found


def _matching(pattern: Path) -> tuple[list[Path], Path]:
    """Files that match, and the folder that the first wild part stands in."""
    found, root = [Path(pattern.anchor)], None
    for part in pattern.parts[1:]:
        if not _is_wild(part) or (root is None and (found[0] / part).exists()):
            found = [folder / part for folder in found]
            continue
        if "**" in part:
            raise WorldError(f"{shorten(str(pattern), 120)}: ** is not allowed; * stands for one name")
        root = root or found[0]
        found = [
            child
            for folder in found
            if folder.is_dir()
            for child in _children(folder)
            if fnmatchcase(child.name, part)
        ]
        _few(found, pattern)
    files = [file for file in found if os.path.lexists(file) and not file.is_dir() and _is_elevation(file)]
    return files, root or pattern.parent


def _children(folder: Path) -> list[Path]:
    return sorted(folder.iterdir())


def _is_elevation(path: Path) -> bool:
    return path.name.lower().endswith(ENDINGS) and not path.name.startswith(".")


def _few(found: list[Path], where: Path) -> list[Path]:
    if len(found) > MOST:
        raise WorldError(f"{shorten(str(where), 120)} stands for more than {MOST:,} files; join fewer")
    return found
