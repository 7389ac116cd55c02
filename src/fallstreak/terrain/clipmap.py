"""Which tiles of the ground the GPU holds: nested windows around the camera, and what of them is new.

Level k has samples s_k = spacing · 2^k apart at whole multiples of s_k, in tiles of 32 × 32. Its window of
`tiles` × `tiles` tiles follows the camera in steps of a tile and wraps around in its texture, so that moving
costs only what comes into sight (Losasso & Hoppe 2004, "Geometry Clipmaps"; Tanner et al. 1998). What a texel
holds depends on its place alone: pictures do not depend on the way that led to them.

A window's outermost tiles have shape but no surface, because slopes look at the neighbours.
"""

from __future__ import annotations

import numpy as np

TILE = 32
MAX_LEVELS = 16
MAX_JOBS = 16128  # with the windows, what a uniform buffer holds by default


class Clipmap:
    """The windows of all levels.

    Parameters
    ----------
    spacing : m between the samples of level 0; a power of two
    tiles : width of a window in tiles; even
    levels : their number
    extent : m, half the width of the map; tiles beyond are never asked for
    """

    def __init__(self, spacing: float, tiles: int, levels: int, extent: float):
        self.spacing, self.tiles, self.levels, self.extent = spacing, tiles, levels, extent
        self.windows = np.zeros((MAX_LEVELS, 4), np.int32)
        shape = (levels, tiles, tiles, 2)
        nowhere = np.iinfo(np.int32).max
        self._held = {
            "shape": np.full(shape, nowhere, np.int32),
            "surface": np.full(shape, nowhere, np.int32),
        }
        self._wanted: np.ndarray | None = None
        self._at: tuple | None = None
        column = np.arange(tiles)
        self._grid = np.stack(np.meshgrid(column, column), -1).astype(np.int32)
        rim = (self._grid == 0) | (self._grid == tiles - 1)
        self._inner = ~rim.any(-1)

    def move(self, east: float, north: float, finest: int) -> bool:
        """Follow the camera (m on the map); levels finer than `finest` are of no use from there.

        Returns whether the windows moved.
        """
        sizes = self.spacing * TILE * 2.0 ** np.arange(self.levels)
        first = np.round(np.array([[east, north]]) / sizes[:, None]).astype(np.int32) - self.tiles // 2
        at = (first.tobytes(), finest)
        if at == self._at:
            return False
        self._at = at
        self.windows[: self.levels, :2] = first
        tile = first[:, None, None, :] + self._grid
        corner = tile * sizes[:, None, None, None]
        away = np.maximum(np.maximum(corner, -(corner + sizes[:, None, None, None])), 0.0)
        used = np.hypot(away[..., 0], away[..., 1]) < 1.05 * self.extent + 3.0 * sizes[:, None, None]
        used &= (np.arange(self.levels) >= finest)[:, None, None]
        self._wanted = tile
        self._used = used
        return True

    def jobs(self, kind: str) -> np.ndarray:
        """Tiles whose "shape" or "surface" is to be worked out: level << 16 | row << 8 | column, uint32."""
        assert self._wanted is not None
        stale = (self._slots(self._held[kind]) != self._wanted).any(-1) & self._used
        if kind == "surface":
            stale &= self._inner
        level, row, column = np.nonzero(stale)
        return (level << 16 | row << 8 | column).astype(np.uint32)

    def done(self, kind: str, jobs: np.ndarray) -> None:
        """The jobs have been recorded."""
        level, row, column = jobs >> 16, jobs >> 8 & 255, jobs & 255
        assert self._wanted is not None
        tile = self._wanted[level, row, column]
        slot = tile % self.tiles
        self._held[kind][level, slot[:, 1], slot[:, 0]] = tile

    def _slots(self, held: np.ndarray) -> np.ndarray:
        """What the slots of the wanted tiles hold."""
        slot = self._wanted % self.tiles  # type: ignore[operator]
        level = np.arange(self.levels)[:, None, None]
        return held[level, slot[..., 1], slot[..., 0]]


def packed_jobs(jobs: np.ndarray) -> np.ndarray:
    """Jobs as the uniform holds them, (MAX_JOBS / 4, 4) uint32."""
    out = np.zeros(MAX_JOBS, np.uint32)
    out[: len(jobs)] = jobs
    return out.reshape(-1, 4)
