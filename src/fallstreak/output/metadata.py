"""What a file says about itself, and whether it is the file a resumed sequence expects.

Metadata is one flat mapping of JSON values. It holds nothing that differs between two runs of one command. In
a PNG it is the `iTXt` chunk "fallstreak", in EXR the attribute `fallstreak`, in .npz the entry `metadata`.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Mapping
from datetime import date
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fallstreak.output.exr import read_exr_text
from fallstreak.output.npz import read_npz_text
from fallstreak.output.png import read_png_text
from fallstreak.world.files import sidecars
from fallstreak.world.terrain import is_path

if TYPE_CHECKING:
    from fallstreak.world import World
    from fallstreak.world.terrain import Terrain

KEYWORD = "fallstreak"


def canonical(metadata: Mapping[str, Any]) -> str:
    """The one spelling of metadata: JSON, keys sorted, times as ISO 8601."""
    return json.dumps(_plain(metadata), sort_keys=True, ensure_ascii=False, allow_nan=False)


def _plain(value: Any) -> Any:
    """Only what JSON knows; numpy scalars become numbers, tuples lists, dates text."""
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    if value is None or isinstance(value, str | bool | int):
        return value
    if isinstance(value, date):
        return value.isoformat()
    if hasattr(value, "tolist"):
        return _plain(value.tolist())
    if isinstance(value, float):
        return float(value) if isfinite(value) else None  # JSON knows no other numbers
    return str(value)


def png_text(metadata: Mapping[str, Any]) -> dict[str, str]:
    """The text chunks of a PNG: the standard keywords, and everything under `KEYWORD`."""
    text = {"Software": f"fallstreak {metadata.get('version', '')}".strip()}
    if "scene" in metadata:
        text["Title"] = str(metadata["scene"])
    text[KEYWORD] = canonical(metadata)
    return text


def read_metadata(path: str | os.PathLike) -> dict[str, Any] | None:
    """What fallstreak wrote into a picture, or None if the file is not whole, not ours or not there.

    Parameters
    ----------
    path : path-like
        A .png, .exr or .npz file.

    Examples
    --------
    >>> read_metadata("no such picture.png") is None
    True
    """
    suffix = Path(path).suffix.lower()
    if suffix == ".png":
        text = (read_png_text(path) or {}).get(KEYWORD)
    elif suffix == ".exr":
        text = read_exr_text(path)
    elif suffix == ".npz":
        text = read_npz_text(path)
    else:
        return None
    try:
        metadata = json.loads(text) if text else None
    except ValueError:
        return None
    return metadata if isinstance(metadata, dict) else None


def describes(metadata: Mapping[str, Any], expected: Mapping[str, Any]) -> bool:
    """Whether `metadata` says of every key in `expected` what is expected."""
    plain = json.loads(canonical(metadata))
    return all(key in plain and plain[key] == value for key, value in json.loads(canonical(expected)).items())


def is_whole(path: str | os.PathLike, expected: Mapping[str, Any] | None = None) -> bool:
    """Whether the file at `path` is complete and undamaged and, if given, carries the expected metadata.

    Every checksum in the file is verified. This is the question a resumed sequence asks of each file it
    finds.
    """
    metadata = read_metadata(path)
    return metadata is not None and (expected is None or describes(metadata, expected))


def world_digest(world: World) -> str:
    """Sixteen hexadecimal digits that differ when anything in the world differs.

    Of elevation files it is the contents that count, not where they lie: the same on every machine.
    """
    values = world.model_dump(mode="json")
    if world.terrain.source == "file" and world.terrain.paths:
        values["terrain"]["file"] = _files_digest(world.terrain)
    return hashlib.sha256(canonical(values).encode()).hexdigest()[:16]


def _files_digest(terrain: Terrain) -> str | list[str]:
    """Of each elevation file; a lone .npz or .tif says everything by its contents."""
    digests = [name for name in terrain.names if not is_path(name)]
    for path in terrain.paths:
        # SRTM and Terrarium tiles lie where their names say, a picture where the file beside it says.
        named = path.suffix.lower() not in (".npz", ".tif", ".tiff")
        parts = ["/".join(path.parts[-3:] if path.stem.isdigit() else path.parts[-1:])] if named else []
        digests.append(":".join([*parts, *(_file_digest(file) for file in (path, *sidecars(path)))]))
    return digests[0] if len(digests) == 1 else digests


def _file_digest(path: Path) -> str:
    if not path.is_file():
        return "missing"
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
