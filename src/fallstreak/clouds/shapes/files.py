"""Reading cloud models: shipped ones by name, a user's own by path; bad ones are refused in one sentence."""

from __future__ import annotations

import os
import re
import stat
from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path

from pydantic import ValidationError

from ...world.errors import WorldError, shorten
from ...world.explain import explain
from ...world.source import parse_layer
from .model import CloudModel
from .tables import ModelFile

DATA = Path(__file__).parent / "data"
_MAX_BYTES = 1 << 18


def shipped() -> list[str]:
    """Names of the models that come with the package."""
    return sorted(path.stem for path in DATA.glob("*.toml"))


def load(names: Sequence[str], folder: Path | None = None) -> list[CloudModel]:
    """Cloud models, in the order of their names.

    Parameters
    ----------
    names
        Of shipped models ("cumulus_humilis_a"), or paths of .toml files.
    folder
        Where relative paths count from; None: the current directory.

    Raises
    ------
    WorldError
        One sentence with file, box and key.
    """
    return [_one(str(name), folder) for name in names]


def _one(name: str, folder: Path | None) -> CloudModel:
    if name.endswith(".toml"):
        path = (folder or Path()) / name
        return parse(_text(path), str(path), path.stem)
    if name not in shipped():
        raise WorldError(
            f"cloud model {shorten(name)} is not shipped: name a .toml file or one of {', '.join(shipped())}"
        )
    return _shipped(name)


@lru_cache
def _shipped(name: str) -> CloudModel:
    path = DATA / f"{name}.toml"
    return parse(path.read_text(encoding="utf-8"), path.name, name)


def parse(text: str, label: str, name: str) -> CloudModel:
    """The model that a TOML text describes.

    Raises
    ------
    WorldError
        One sentence that begins with `label` and names box and key.
    """
    layer = parse_layer(text, label, None)
    try:
        table = ModelFile.model_validate(layer.tree)
    except ValidationError as error:
        told = str(explain(error, ModelFile, layer.tree, [layer])).replace("a scene has", "a model has")
        # people count boxes from one
        told = re.sub(r"boxes\[(\d{1,9})\]\.?", lambda m: f"box {int(m[1]) + 1}, ", told)
        raise WorldError(told) from None
    return CloudModel.of(name, table)


def _text(path: Path) -> str:
    try:
        mode = os.stat(path).st_mode
        if not stat.S_ISREG(mode):
            raise WorldError(f"{path} is no regular file, and a cloud model is a .toml file")
        with open(path, "rb") as file:
            data = file.read(_MAX_BYTES + 1)
    except FileNotFoundError:
        raise WorldError(f"{path} does not exist") from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise WorldError(f"{shorten(str(path), 120)} cannot be read: {reason}") from None
    if len(data) > _MAX_BYTES:
        raise WorldError(f"{path} is larger than {_MAX_BYTES >> 10} KiB, and a cloud model has a few")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        wrong = f"byte {error.start} is 0x{data[error.start]:02x}"
        raise WorldError(f"{path} is not UTF-8 text: {wrong}") from None
