"""Plain nested dictionaries: what TOML files, overrides and keyword arguments have in common."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pydantic import BaseModel

from .errors import WorldError, shorten

Tree = dict[str, Any]
DEPTH = 16
"""Deepest nesting that is read; the world itself needs four."""


def plain(value: Any, depth: int = 0) -> Any:
    """A deep copy made of dicts, lists and scalars; models give what was set in them, numpy gives numbers."""
    if depth > DEPTH:
        raise WorldError(f"tables and lists are nested deeper than {DEPTH} levels, and a scene needs four")
    if isinstance(value, BaseModel):
        value = {name: getattr(value, name) for name in value.model_fields_set}
    if isinstance(value, Mapping):
        return {str(key): plain(item, depth + 1) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(item, depth + 1) for item in value]
    if isinstance(value, Path):
        return str(value)
    if hasattr(value, "tolist"):
        return value.tolist()
    return value


def merge(base: Tree, top: Tree) -> Tree:
    """``base`` with ``top`` laid over it: tables are merged key by key, all else is replaced."""
    merged = dict(base)
    for key, value in top.items():
        below = merged.get(key)
        merged[key] = merge(below, value) if isinstance(below, dict) and isinstance(value, dict) else value
    return merged


def assign(tree: Tree, key: str, value: Any) -> None:
    """Set a dotted key in place, making tables on the way; a table given for a table is merged into it."""
    parts = key.strip().split(".")
    if not all(parts) or len(parts) > DEPTH:
        raise WorldError(f"{shorten(key)} is not a key: write names joined by dots, such as sky.turbidity")
    at = tree
    for depth, part in enumerate(parts[:-1], start=1):
        at = at.setdefault(part, {})
        if not isinstance(at, dict):
            raise WorldError(
                f"{key} cannot be set: {'.'.join(parts[:depth])} is {shorten(at)} and not a table"
                + (" (give the whole list)" if isinstance(at, list) else "")
            )
    old = at.get(parts[-1])
    at[parts[-1]] = merge(old, value) if isinstance(old, dict) and isinstance(value, dict) else value


_NOTHING: Any = object()


def at(tree: Any, path: tuple[str | int, ...], default: Any = None) -> Any:
    """What the tree holds at the path."""
    for part in path:
        if isinstance(tree, dict) and part in tree:
            tree = tree[part]  # type: ignore[index]
        elif isinstance(tree, list) and isinstance(part, int) and part < len(tree):
            tree = tree[part]
        else:
            return default
    return tree


def holds(tree: Any, path: tuple[str | int, ...]) -> bool:
    """Whether the tree holds something at the path."""
    return at(tree, path, _NOTHING) is not _NOTHING


def files_in(tree: Tree) -> list[tuple[Tree, str, str]]:
    """Where the tree names files: (table, key, what a message calls it), for each a text or a list.

    What is no table or no name is left to the validation.
    """
    found: list[tuple[Tree, str, str]] = []
    terrain = tree.get("terrain")
    if isinstance(terrain, dict) and "file" in terrain:
        found.append((terrain, "file", "terrain.file"))
    for where, key in (("models", "file"), ("clouds.layers", "coverage_map"), ("clouds.layers", "models")):
        tables = at(tree, tuple(where.split(".")))
        for index, table in enumerate(tables if isinstance(tables, list) else []):
            if isinstance(table, dict) and key in table:
                found.append((table, key, f"{where}[{index}].{key}"))
    return found
