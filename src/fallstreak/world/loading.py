"""From a scene's name or path, its bases and overrides to a validated World."""

from __future__ import annotations

import os
import tomllib
from collections.abc import Iterable, Mapping
from difflib import get_close_matches
from pathlib import Path
from typing import Any

from .errors import WorldError, shorten
from .explain import Layer, origin
from .source import inside, parse_layer, read_layer
from .terrain import is_path
from .trees import Tree, assign, plain
from .world import World, absolute

SCENES = Path(__file__).parent / "scenes"
MAX_BASES = 8


def scene_names() -> list[str]:
    """The names of the shipped scenes."""
    return sorted(path.stem for path in SCENES.glob("*.toml"))


def load(scene: str | Path | World, overrides: Iterable[str] | Mapping[str, Any] = ()) -> World:
    """A validated world from a shipped scene's name or a .toml file.

    Parameters
    ----------
    scene
        "jacksboro", "my/scene.toml", a `pathlib.Path`, or a World to be changed.
    overrides
        ``["sky.turbidity=4", "time=2025-01-01T08:00Z"]``, values as in TOML, where a bare word is a string;
        or a mapping of dotted keys to values. Paths in them count from the current directory and may lead
        anywhere: who types them is trusted, while a scene file may come from anybody.

    Raises
    ------
    WorldError
        With one sentence that names file, key, value and what is allowed.

    Examples
    --------
    >>> load("jacksboro", ["sky.turbidity=4"]).sky.turbidity
    4.0
    """
    if isinstance(scene, World):
        layers = [Layer("the world", plain(scene._given))]
        folder = scene.folder
    else:
        path, label = find(scene)
        layers = with_bases(read_layer(path, label), path)
        folder = path.parent.absolute()
    return build(layers + override_layers(overrides), folder)


def loads(text: str, overrides: Iterable[str] | Mapping[str, Any] = (), folder: Path | None = None) -> World:
    """A validated world from the text of a scene; ``folder`` is where its relative paths count from."""
    layer = parse_layer(text, "scene text", folder)
    layers = with_bases(layer, (folder / "scene text") if folder else None)
    return build(layers + override_layers(overrides), folder)


def build(layers: list[Layer], folder: Path | None) -> World:
    """One world of several layers, the later over the earlier, whose files exist."""
    world = World.from_layers(layers, folder)
    if world.terrain.source == "file":
        where = origin(("terrain", "file"), layers)
        try:
            missing = next((path for path in world.terrain.paths if not is_file(path)), None)
        except WorldError as error:
            raise WorldError(f"{where}terrain.file: {error}") from None
        if missing:
            raise WorldError(f"{where}terrain.file = {shorten(str(missing), 120)}, but there is no such file")
    for index, model in enumerate(world.models):
        if model.path:
            _exists(model.path, ("models", index, "file"), f"models[{index}].file", layers)
    for index, layer in enumerate(world.clouds.layers):
        for key, path in layer.paths:
            _exists(path, ("clouds", "layers", index, key), f"clouds.layers[{index}].{key}", layers)
    return world


def _exists(path: Path, place: tuple[str | int, ...], key: str, layers: list[Layer]) -> None:
    if not is_file(path):
        where = origin(place, layers)
        raise WorldError(f"{where}{key} = {shorten(str(path), 120)}, but there is no such file")


def is_file(path: Path) -> bool:
    """`Path.is_file`, but False too for a name the system finds too long."""
    try:
        return path.is_file()
    except OSError:
        return False


def find(scene: str | Path) -> tuple[Path, str]:
    """The file of a scene and how messages call it."""
    name = os.fspath(scene)
    if "\0" in name:
        raise WorldError(f"{shorten(name)} is not a file name: it holds a NUL character")
    if isinstance(scene, Path) or name.endswith(".toml") or "/" in name or os.sep in name:
        return Path(scene), name
    known = scene_names()
    if name in known:
        return SCENES / f"{name}.toml", f"{name} (shipped)"
    also = f", or write ./{name}" if name and os.path.exists(name) else ""
    raise WorldError(
        f"there is no scene {shorten(name)}{_meant(name)}: shipped are {', '.join(known)}, "
        f"and a file's name ends in .toml{also}"
    )


def _meant(name: str) -> str:
    close = get_close_matches(name, scene_names(), n=1, cutoff=0.5)
    return f" (did you mean {close[0]}?)" if close else ""


def with_bases(layer: Layer, path: Path | None) -> list[Layer]:
    """The scene and all it builds on, the lowest first."""
    layers = [layer]
    seen = [path.resolve()] if path else []
    while "extends" in layers[0].tree:
        top = layers[0]
        base = top.tree.pop("extends")
        if not isinstance(base, str):
            raise WorldError(
                f"{top.label}: extends = {shorten(base)} is not allowed: it must be a scene's name or path"
            )
        if base in scene_names():
            path, label = SCENES / f"{base}.toml", f"{base} (shipped)"
        elif is_path(base):
            path = inside(base, path.parent if path else None, top.label, "extends")
            label = str(path)
            if not is_file(path):
                raise WorldError(f"{top.label}: extends = {shorten(base)}, but there is no such file")
        else:
            raise WorldError(
                f"{top.label}: extends = {shorten(base)} is no shipped scene{_meant(base)}: "
                f"allowed are {', '.join(scene_names())} and paths that end in .toml"
            )
        resolved = path.resolve()
        if resolved in seen:
            raise WorldError(
                f"{layer.label}: extends goes in a circle ({' → '.join(p.name for p in [*seen, resolved])})"
            )
        if len(seen) > MAX_BASES:
            raise WorldError(f"{layer.label}: extends goes deeper than {MAX_BASES} scenes")
        seen.append(resolved)
        layers.insert(0, read_layer(path, label))
    return layers


def override_layers(overrides: Iterable[str] | Mapping[str, Any]) -> list[Layer]:
    """One layer per override, in their order."""
    layers = []
    pairs = overrides.items() if isinstance(overrides, Mapping) else map(parse_override, overrides)
    for key, value in pairs:
        tree: Tree = {}
        assign(tree, key, plain(value))
        absolute(tree)
        layers.append(Layer("override", tree))
    return layers


def parse_override(text: str) -> tuple[str, Any]:
    """ "sky.turbidity=4" as ("sky.turbidity", 4)."""
    key, equals, value = text.partition("=")
    if not equals or not key.strip():
        raise WorldError(f"{shorten(text)} is not an override: write KEY=VALUE, such as sky.turbidity=4")
    return key.strip(), parse_value(value.strip())


def parse_value(text: str) -> Any:
    """A TOML value; what is not one (a bare word, a path) is a string."""
    if len(text) > 4000:
        raise WorldError(f"an override of {len(text):,} characters is too long, allowed are 4,000")
    try:
        parsed = tomllib.loads(f"v = {text}")
    except (ValueError, RecursionError):
        return text
    return parsed["v"] if len(parsed) == 1 else text
