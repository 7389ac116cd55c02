"""What there is, as data: frozen models with unit and range on every field, TOML files, shipped scenes.

No GPU here and no numpy; a name is imported when it is first used, so that a short message costs nothing.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .camera import Camera, Keyframe, Pose
    from .describe import schema
    from .errors import UserError, WorldError
    from .film import Film
    from .loading import load, loads, scene_names
    from .place import Place
    from .planet import Planet
    from .quality import QUALITY, Quality
    from .sky import Sky, Sun
    from .terrain import Terrain
    from .world import World
    from .writing import edit_toml

_HOME = {
    "World": "world", "Place": "place", "Planet": "planet", "Sky": "sky", "Sun": "sky", "Terrain": "terrain",
    "Camera": "camera", "Keyframe": "camera", "Pose": "camera", "Film": "film", "load": "loading",
    "loads": "loading", "scene_names": "loading", "edit_toml": "writing", "schema": "describe",
    "Quality": "quality", "QUALITY": "quality", "UserError": "errors", "WorldError": "errors",
}  # fmt: skip

__all__ = [
    "QUALITY", "Camera", "Film", "Keyframe", "Place", "Planet", "Pose", "Quality", "Sky", "Sun", "Terrain",
    "UserError", "World", "WorldError", "edit_toml", "load", "loads", "scene_names", "schema",
]  # fmt: skip


def __getattr__(name: str) -> Any:
    if name in _HOME:
        return getattr(import_module(f".{_HOME[name]}", __name__), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
