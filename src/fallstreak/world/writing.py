"""Worlds as TOML: a fresh file, or a change in an old one that leaves every other byte alone."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .errors import WorldError, shorten
from .source import read_text

if TYPE_CHECKING:
    from .world import World


def to_toml(world: World) -> str:
    """See `World.to_toml`."""
    import tomlkit

    from .world import World

    preset = world.planet.preset
    default = World(planet={"preset": preset})
    document = tomlkit.document()
    values = _differences(world, default)
    if preset != "earth":
        values["planet"] = {"preset": preset} | values.get("planet", {})
    terrain = values.get("terrain", {})
    if world.folder and world.terrain.path and "file" in terrain:
        root = world.folder.resolve()
        if world.terrain.path.resolve().is_relative_to(root):
            terrain["file"] = world.terrain.path.resolve().relative_to(root).as_posix()
    keyframes = values.get("camera", {}).pop("keyframes", None)
    for key, value in values.items():
        document.add(key, value)
    if keyframes:
        camera = document.setdefault("camera", tomlkit.table())
        frames = tomlkit.aot()
        for frame in keyframes:
            frames.append(tomlkit.item(frame))
        camera.add("keyframes", frames)
    return tomlkit.dumps(document)


def _differences(model: Any, default: Any) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for name in type(model).model_fields:
        value, usual = getattr(model, name), getattr(default, name)
        if value == usual:
            continue
        if name == "keyframes":
            found[name] = [frame.model_dump(exclude_none=True) for frame in value]
        elif hasattr(type(value), "model_fields"):
            found[name] = _differences(value, usual)
        elif value is None:
            found[name] = "auto"
        elif isinstance(value, tuple):
            found[name] = value[0] if value[0] == value[1] == value[2] else list(value)
        else:
            found[name] = value
    return found


def edit_toml(scene: str | Path, changes: Mapping[str, Any]) -> str:
    """Change values in a scene file or text; comments, order and every other byte stay.

    Parameters
    ----------
    scene
        A `pathlib.Path` to a file, which is rewritten in one step (beside, then renamed), or a TOML text.
    changes
        Dotted keys with their new values; ``None`` removes a key.

    Returns
    -------
    str
        The new text. It is validated before anything is written.
    """
    import tomlkit
    from tomlkit.exceptions import TOMLKitError

    from .loading import build, override_layers
    from .loading import _with_bases as with_bases
    from .source import parse_layer

    path = scene if isinstance(scene, Path) else None
    label = str(path) if path else "scene text"
    text = read_text(path, label) if path else str(scene)
    parse_layer(text, label, path.parent if path else Path.cwd())
    try:
        document = tomlkit.parse(text)
    except (TOMLKitError, ValueError, RecursionError) as error:
        raise WorldError(f"{label} is not TOML: {error}") from None
    for key, value in changes.items():
        *tables, last = key.split(".")
        at: Any = document
        for name in tables:
            if name not in at:
                at.add(name, tomlkit.table())
            at = at[name]
            if not isinstance(at, Mapping):
                raise WorldError(
                    f"{label}: {key} cannot be set, since {name} is {shorten(at)} and not a table"
                )
        if value is None:
            at.pop(last, None)
        else:
            at[last] = value
    result = tomlkit.dumps(document)
    folder = path.parent if path else Path.cwd()
    layer = parse_layer(result, label, folder)
    build(with_bases(layer, path or folder / "scene text") + override_layers(()), folder)
    if path:
        beside = path.with_name(f".{path.name}.{os.getpid()}.part")
        beside.write_text(result, encoding="utf-8", newline="")
        os.replace(beside, path)
    return result
