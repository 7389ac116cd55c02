"""Worlds as TOML: a fresh file, or a change in an old one that leaves every other byte alone."""

from __future__ import annotations

import os
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .errors import WorldError, shorten
from .source import parse_layer, read_text
from .terrain import PRESETS, is_path, with_paths
from .trees import assign, files_in, plain

if TYPE_CHECKING:
    from .world import World


def to_toml(world: World) -> str:
    """See `World.to_toml`."""
    import tomlkit

    from .world import World

    preset = world.planet.preset
    source = {"source": world.terrain.source} if world.terrain.source in PRESETS else {}
    default = World(planet={"preset": preset}, terrain=source)
    document = tomlkit.document()
    values = _differences(world, default)
    if source:
        values["terrain"] = source | values.get("terrain", {})
    if preset != "earth":
        values["planet"] = {"preset": preset} | values.get("planet", {})
    if world.folder:
        here = world.folder.resolve()
        for table, key, _ in files_in(values):
            table[key] = with_paths(table[key], lambda name: _relative(name, here))
    lists = {
        (section, name): values.get(section, {}).pop(name, None)
        for section, name in (("camera", "keyframes"), ("clouds", "layers"))
    }
    for key, value in values.items():
        if value or key not in ("camera", "clouds"):
            document.add(key, value)
    for (section, name), entries in lists.items():
        if entries:
            tables = tomlkit.aot()
            for entry in entries:
                tables.append(tomlkit.item(entry))
            document.setdefault(section, tomlkit.table()).add(name, tables)
    return tomlkit.dumps(document)


def _relative(name: str, root: Path) -> str:
    """A path counted from the scene's folder if it lies in it."""
    path = Path(name).resolve()
    if not path.is_relative_to(root):
        return name
    short = path.relative_to(root).as_posix()
    return short if is_path(short) else f"./{short}"


def _differences(model: Any, default: Any) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for name in type(model).model_fields:
        value, usual = getattr(model, name), getattr(default, name)
        if value == usual:
            continue
        if name == "keyframes":
            found[name] = [frame.model_dump(exclude_none=True) for frame in value]
        elif name in ("models", "layers"):
            found[name] = [entry.model_dump(exclude_defaults=True) for entry in value]
        elif hasattr(type(value), "model_fields"):
            found[name] = _differences(value, usual)
        elif value is None:
            found[name] = "auto"
        elif isinstance(value, tuple):
            grey = len(value) == 3 and value[0] == value[1] == value[2] and not isinstance(value[0], str)
            found[name] = value[0] if grey else list(value)
        else:
            found[name] = value
    return found


def edit_toml(scene: str | Path, changes: Mapping[str, Any]) -> str:
    """Change values in a scene file or text; comments, order and every other byte stay.

    Parameters
    ----------
    scene
        A `pathlib.Path` (or a string that ends in .toml), whose file is rewritten in one step: written
        beside, then renamed. Or the text of a scene.
    changes
        Dotted keys with their new values; ``None`` removes a key.

    Returns
    -------
    str
        The new text, which has been found valid before anything was written.

    Examples
    --------
    >>> edit_toml("seed = 1  # lucky\\n", {"seed": 7})
    'seed = 7  # lucky\\n'
    """
    import tomlkit
    from tomlkit.exceptions import TOMLKitError

    from .loading import build, with_bases

    path = Path(scene) if isinstance(scene, Path) or str(scene).endswith(".toml") else None
    label = str(path) if path else "scene text"
    text = read_text(path, label) if path else str(scene)
    folder = path.parent if path else Path.cwd()
    parse_layer(text, label, folder)
    expected = plain(tomllib.loads(text))
    try:
        document = tomlkit.parse(text)
        for key, value in changes.items():
            value = plain(value)
            _set(document, key, value)
            if value is None:
                _remove(expected, key)
            else:
                assign(expected, key, value)
        result = tomlkit.dumps(document)
    except (TOMLKitError, ValueError, TypeError, RecursionError) as error:
        raise WorldError(f"{label} cannot be edited: {error}") from None
    layer = parse_layer(result, label, folder)
    if plain(tomllib.loads(result)) != expected:
        raise WorldError(f"{label} cannot be edited in place: its layout hides where a new key belongs")
    build(with_bases(layer, path or folder / "scene text"), folder)
    if path:
        bom = "\ufeff" if path.read_bytes().startswith(b"\xef\xbb\xbf") else ""
        _replace(path, bom + result)
    return result


def _replace(path: Path, text: str) -> None:
    """Write beside, then rename, so that the file is never half-written."""
    beside = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        beside.write_text(text, encoding="utf-8", newline="")
        os.replace(beside, path)
    except OSError as error:
        beside.unlink(missing_ok=True)
        raise WorldError(f"{path} cannot be written: {error.strerror}") from None


def _set(document: Any, key: str, value: Any) -> None:
    """Set or remove (None) a dotted key in a tomlkit document."""
    import tomlkit

    *tables, last = key.split(".")
    at: Any = document
    for name in tables:
        if name not in at:
            if value is None:
                return
            at.add(name, tomlkit.table())
        at = at[name]
        if not hasattr(at, "keys"):
            raise ValueError(f"{key} cannot be set, since {name} is {shorten(at)} and not a table")
    if value is None:
        at.pop(last, None)
    elif isinstance(value, dict) and isinstance(at.get(last), dict):
        for inner, item in value.items():
            _set(at[last], inner, item)
    else:
        at[last] = value


def _remove(tree: Any, key: str) -> None:
    *tables, last = key.split(".")
    for name in tables:
        tree = tree.get(name, {})
    tree.pop(last, None)
