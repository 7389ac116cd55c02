"""Heights unpacked into a temporary file, where their own can only be unpacked as a whole."""

from __future__ import annotations

import contextlib
import os
import tempfile
import weakref
from collections.abc import Iterable
from pathlib import Path

import numpy as np

from .raster import RawRaster


class ScratchRaster(RawRaster):
    """A raster in a file of its own, which goes when the raster does, at the latest when the program ends.

    Parameters
    ----------
    rows : iterable of (n, columns) arrays, one below the other
    """

    def __init__(
        self, rows: Iterable[np.ndarray], shape: tuple[int, int], dtype, name: str, nodata: float | None
    ):
        handle, path = tempfile.mkstemp(prefix="fallstreak-", suffix=".raw")
        weakref.finalize(self, _remove, path)
        with open(handle, "wb") as file:
            for part in rows:
                part.astype(dtype, copy=False).tofile(file)
        super().__init__(Path(path), 0, shape, dtype, name, nodata)


def _remove(path: str) -> None:
    with contextlib.suppress(OSError):
        os.unlink(path)
