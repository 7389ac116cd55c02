"""Skies, weather and worlds, rendered in real time on WebGPU.

>>> import fallstreak as fs
>>> world = fs.load("jacksboro", ["sky.turbidity=4"])
>>> fs.render(world, size=(1280, 720)).save("evening.png")  # doctest: +SKIP
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from .world import queries

if TYPE_CHECKING:
    from . import noise
    from .frame.renderer import Frame, Renderer, render
    from .world import (
        QUALITY,
        Quality,
        UserError,
        World,
        WorldError,
        edit_toml,
        load,
        loads,
        scene_names,
        schema,
    )

__version__ = "0.1.0"

# Importing fallstreak must cost nothing: a name is imported when it is first used.
_HOME = {
    "World": "world", "load": "world", "loads": "world", "edit_toml": "world", "scene_names": "world",
    "schema": "world", "Quality": "world", "QUALITY": "world", "UserError": "world", "WorldError": "world",
    "render": "frame.renderer", "Renderer": "frame.renderer", "Frame": "frame.renderer",
}  # fmt: skip

__all__ = [
    "QUALITY", "Frame", "Quality", "Renderer", "UserError", "World", "WorldError", "edit_toml", "load",
    "loads", "noise", "render", "scene_names", "schema",
]  # fmt: skip

for _name in ("height", "normal", "slope", "materials", "ray"):
    queries.register(f"terrain.{_name}", f"fallstreak.terrain.queries:{_name}")
for _name in ("extinction", "optical_depth", "inside"):
    queries.register(f"clouds.{_name}", f"fallstreak.clouds.field.queries:{_name}")


def __getattr__(name: str) -> Any:
    if name == "noise":
        return import_module(".noise", __name__)
    if name in _HOME:
        value = getattr(import_module(f".{_HOME[name]}", __name__), name)
        globals()[name] = value
        return value
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
