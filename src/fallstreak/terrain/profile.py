"""What of the ground those need who walk over its heights on the GPU: the clipmap's, without its passes."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from ..gpu import Struct
from .clipmap import TILE
from .frame import TERRAIN_FRAME

if TYPE_CHECKING:
    from .clipmap_passes import ClipmapPasses

MODULE = "package::terrain::profile"


@dataclass(frozen=True)
class Profile:
    """Heights of the clipmap's levels, as another system's pass takes them.

    Its shader imports ``height_between`` of `module` by the constant ``GROUND``.

    Attributes
    ----------
    tiles : int
        Width of every level's window, in tiles of 32 samples; even.
    spacing : float
        m, between samples of level 0; of the next twice as much each.
    levels : int
    extent : float
        m, half the width of the map, beyond which windows do not follow the camera.
    bind, structs, constants, flags
        Of the module, for ``FrameGraph.compute``.
    """

    clip: ClipmapPasses = field(repr=False)
    tiles: int
    spacing: float
    levels: int
    extent: float
    bind: dict[str, str]
    structs: tuple[Struct, ...]
    constants: dict[str, Any]
    flags: dict[str, bool]

    @classmethod
    def of(cls, clip: ClipmapPasses) -> Profile:
        """The profile of a clipmap."""
        return cls(
            clip,
            clip.clip.tiles,
            clip.spacing,
            clip.levels,
            clip.clip.extent,
            {"terrain": "terrain.frame", "shapes": "terrain.shape", "shifts": "terrain.shift"},
            (TERRAIN_FRAME,),
            {**clip.constants, "GROUND": MODULE},
            {"SHIFT": clip.flags["SHIFT"]},
        )

    @property
    def firsts(self) -> np.ndarray:
        """First sample of each level's window in this frame, east and north: (levels, 2) int."""
        return TILE * self.clip.clip.windows[: self.levels, :2].astype(np.int64)

    @property
    def finest(self) -> int:
        """Finest level that is held in this frame; the finer ones are of no use from there."""
        return self.clip.finest
