"""Cloud models as the GPU reads them: all boxes, all sprites and a table of models, each in one buffer."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .model import BOX, CloudModel

MODEL = np.dtype([("first", "<u4", 4), ("bounds", "<f4", 4)])
"""32 bytes: first box, boxes, first sprite, sprites; radius, height, reach, top (see `CloudModel`), m."""

GPU_SPRITE = np.dtype([("centre", "<f4", 3), ("size", "<f4"), ("word", "<u4", 4)])
"""32 bytes; `word` is box (index into all boxes), texture, chance, shading group."""


@dataclass(frozen=True, eq=False)
class Packed:
    """Buffers of several models.

    Attributes
    ----------
    boxes : (n,) of `BOX`
    models : (len(models),) of `MODEL`
    sprites : (m,) of `GPU_SPRITE`
    """

    boxes: np.ndarray
    models: np.ndarray
    sprites: np.ndarray


def pack(models: Sequence[CloudModel]) -> Packed:
    """The buffers of these models, in their order."""
    table = np.zeros(len(models), MODEL)
    boxes: list[np.ndarray] = [np.zeros(0, BOX)]
    sprites: list[np.ndarray] = [np.zeros(0, GPU_SPRITE)]
    first_box = first_sprite = 0
    for row, model in zip(table, models, strict=True):
        row["first"] = first_box, len(model.boxes), first_sprite, len(model.sprites)
        row["bounds"] = model.radius, model.height, model.reach, model.top
        made = np.zeros(len(model.sprites), GPU_SPRITE)
        made["centre"], made["size"] = model.sprites["centre"], model.sprites["size"]
        box = model.sprites["box"]
        made["word"][:, 0] = first_box + box
        made["word"][:, 1], made["word"][:, 2] = model.sprites["texture"], model.sprites["chance"]
        made["word"][:, 3] = model.boxes["group"][box]
        boxes.append(model.boxes)
        sprites.append(made)
        first_box += len(model.boxes)
        first_sprite += len(made)
    return Packed(np.concatenate(boxes), table, np.concatenate(sprites))
