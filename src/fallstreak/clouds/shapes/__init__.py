"""Cloud models: files of boxes that say what a cloud looks like, for every technique.

What it is
    A model is a handful of boxes (Wang 2004: artists built clouds from boxes that a tool filled with
    sprites). The ellipsoids in the boxes are the matter of the cloud: `clouds/field` evaluates them, sprites
    and spheres fill them. Files are TOML, at most 24 boxes each: ``boxes`` (centre, size, turn, shading
    group, density), ``[sprites]`` (how many, how large, which textures, smallest distance), ``[colours]``
    (five levels by height, percentages and directional colours by hour). `load` takes names of shipped models
    and paths of a user's own.

Limits
    Boxes turn about the vertical only. What is finer than a box comes from noise and textures.
"""

from .files import load, parse, shipped
from .model import BOX, SWELL, CloudModel
from .pack import GPU_SPRITE, MODEL, Packed, pack
from .tables import GROUPS, MOST_BOXES, TEXTURES

__all__ = [
    "BOX",
    "GPU_SPRITE",
    "GROUPS",
    "MODEL",
    "MOST_BOXES",
    "SWELL",
    "TEXTURES",
    "CloudModel",
    "Packed",
    "load",
    "pack",
    "parse",
    "shipped",
]
