"""The sixteen textures of the sprites: one sheet, baked from noise by ``fallstreak clouds bake``."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

import numpy as np

SIDE = 128
"""Texels along a side of a texture."""
COUNT = 16
ROW = 4
"""Textures beside each other on the sheet."""
SHEET = Path(__file__).parent / "data" / "textures.png"


@lru_cache(maxsize=1)
def sheet() -> np.ndarray:
    """The textures, (16, SIDE, SIDE, 4) uint8, top row first.

    Red and green: how far the surface leans to the right and up: (code − 127.5) / 127.5 times `bake.STEEPEST`
    is minus the rise of thickness per width. Blue: thickness, mean 1/2. Alpha: opacity of the texture as a
    sprite of its own, 0 at its rim.
    """
    from PIL import Image

    with Image.open(SHEET) as picture:
        texels = np.asarray(picture.convert("RGBA"))
    return apart(texels)


def apart(picture: np.ndarray) -> np.ndarray:
    """The sheet's picture, (ROW · SIDE, ROW · SIDE, 4), as textures."""
    return np.ascontiguousarray(
        picture.reshape(ROW, SIDE, ROW, SIDE, 4).swapaxes(1, 2).reshape(COUNT, SIDE, SIDE, 4)
    )


def together(textures: np.ndarray) -> np.ndarray:
    """Textures as the picture of a sheet; the inverse of `apart`."""
    return np.ascontiguousarray(
        textures.reshape(ROW, ROW, SIDE, SIDE, 4).swapaxes(1, 2).reshape(ROW * SIDE, ROW * SIDE, 4)
    )
