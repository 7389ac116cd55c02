"""Reading a scene file that nobody vouches for: size, encoding, nesting and paths are checked before use."""

from __future__ import annotations

import os
import re
import stat
import tomllib
from pathlib import Path

from .errors import WorldError, shorten
from .explain import Layer
from .terrain import with_paths
from .trees import Tree, files_in, plain

MAX_BYTES = 1 << 20
MAX_LINE = 4000
MAX_DOTS = 100
"""tomllib takes time quadratic in the parts of a dotted key: a few of those could stall it for minutes."""


def read_layer(path: Path, label: str | None = None) -> Layer:
    """The file's values, with its path keys made absolute and found to be inside the file's folder."""
    label = label or str(path)
    text = read_text(path, label)
    return parse_layer(text, label, path.parent)


def read_text(path: Path, label: str) -> str:
    """The text of a regular UTF-8 file of bounded size."""
    try:
        mode = os.stat(path).st_mode
        if stat.S_ISDIR(mode):
            raise WorldError(f"{label} is a folder, and a scene is a .toml file")
        if not stat.S_ISREG(mode):
            raise WorldError(f"{label} is a device or a pipe, and a scene is a regular .toml file")
        with open(path, "rb") as file:
            data = file.read(MAX_BYTES + 1)
    except FileNotFoundError:
        raise WorldError(f"{label} does not exist") from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise WorldError(f"{shorten(label, 120)} cannot be read: {reason}") from None
    if len(data) > MAX_BYTES:
        raise WorldError(f"{label} is larger than {MAX_BYTES >> 20} MiB, and a scene is a few kilobytes")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise WorldError(
            f"{label} is not UTF-8 text: byte {error.start} is 0x{data[error.start]:02x}"
        ) from None


def parse_layer(text: str, label: str, folder: Path | None) -> Layer:
    """The values in a TOML text; paths in it must stay in ``folder``."""
    for number, line in enumerate(text.splitlines(), start=1):
        if len(line) > MAX_LINE:
            raise WorldError(
                f"{label}, line {number}: {len(line):,} characters are too many, allowed are {MAX_LINE:,}"
            )
        if line.count(".") > MAX_DOTS and max(part.count(".") for part in re.split("[={,]", line)) > MAX_DOTS:
            raise WorldError(f"{label}, line {number}: a key or value has more than {MAX_DOTS} dots")
    try:
        tree = tomllib.loads(text)
        tree = plain(tree)
    except tomllib.TOMLDecodeError as error:
        raise WorldError(f"{label} is not TOML: {_lower(str(error))}") from None
    except RecursionError:
        raise WorldError(f"{label} is nested too deeply, and a scene needs four levels") from None
    except WorldError as error:
        raise WorldError(f"{label}: {error}") from None
    except ValueError as error:  # integers beyond Python's limit of digits, dates that do not exist
        raise WorldError(f"{label} is not TOML: {_lower(str(error).split(';')[0])}") from None
    tree.pop("$schema", None)
    _confine(tree, label, folder)
    return Layer(label, tree, text)


def _lower(message: str) -> str:
    """tomllib's message in the middle of a sentence, without what it quotes from a hostile file at length."""
    message = "".join(c if c.isprintable() else "·" for c in message)
    reason, at, place = message.partition(" (at ")  # "(at line 3, column 5)"
    return reason[:1].lower() + reason[1:99] + at + place[:60]


def _confine(tree: Tree, label: str, folder: Path | None) -> None:
    for table, key, called in files_in(tree):
        table[key] = with_paths(
            table[key], lambda name, called=called: str(inside(name, folder, label, called))
        )


def inside(name: str, folder: Path | None, label: str, key: str) -> Path:
    """The absolute path of a file that a scene names: in the scene's folder, also after following links."""
    if folder is None:
        raise WorldError(
            f"{label}: {key} = {shorten(name)} is a path, and a text without a folder cannot hold one"
        )
    if "\0" in name:
        raise WorldError(f"{label}: {key} = {shorten(name)} holds a NUL character")
    root = folder.resolve()
    try:
        target = (root / name).resolve()
    except (OSError, RuntimeError) as error:
        reason = getattr(error, "strerror", None) or "a loop of links"
        raise WorldError(f"{label}: {key} = {shorten(name)} cannot be followed: {reason}") from None
    if Path(name).is_absolute() or not target.is_relative_to(root):
        raise WorldError(
            f"{label}: {key} = {shorten(name)} leaves the scene's folder: allowed are relative paths in it"
            + (f" (--set {key}=… may name any file)" if "." in key and "[" not in key else "")
        )
    return target
