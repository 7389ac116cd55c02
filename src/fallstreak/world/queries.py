"""Questions the world answers with the help of upper rooms (`world.terrain.height`), without importing them.

An upper room's function is registered under a name as "package.module:function" and imported when asked.
`fallstreak/__init__.py` wires the shipped ones.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import Any

_entries: dict[str, str] = {}
_resolved: dict[str, Callable[..., Any]] = {}


def register(name: str, entry: str) -> None:
    """Say which function ("package.module:function") answers the question ``name``; the last one counts."""
    _entries[name] = entry
    _resolved.pop(name, None)


def resolve(name: str) -> Callable[..., Any]:
    """The function that answers ``name``; ``LookupError`` when nobody registered one."""
    found = _resolved.get(name)
    if found is None:
        if name not in _entries:
            raise LookupError(f"no provider is registered for the query {name!r} (known: {sorted(_entries)})")
        module, _, function = _entries[name].partition(":")
        found = _resolved[name] = getattr(import_module(module), function)
    return found
