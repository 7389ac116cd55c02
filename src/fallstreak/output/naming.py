"""Names of numbered files: `out/evening.png` becomes `out/evening.0000.png`, `out/evening.0001.png`, ..."""

from __future__ import annotations

import os
import re
from pathlib import Path

from fallstreak.output.errors import OutputError

# "evening.####.png" or "evening.{frame}.png" or "evening.{frame:06d}.png"; a single # is a letter like any
# other.
_PLACE = re.compile(r"#{2,}|\{frame(?::0?(\d{1,2})d?)?\}")
_DIGITS = 4


class FrameNames:
    """The file of each frame of a sequence.

    Parameters
    ----------
    pattern : path-like
        A file name with `####` (as many digits as signs), `{frame}` or `{frame:06d}` where the number goes;
        without any of these the number goes before the suffix.

    Examples
    --------
    >>> str(FrameNames("out/evening.png").path(7))
    'out/evening.0007.png'
    >>> str(FrameNames("evening-##.exr").path(7)), str(FrameNames("evening-##.exr").path(100))
    ('evening-07.exr', 'evening-100.exr')
    """

    def __init__(self, pattern: str | os.PathLike):
        path = Path(pattern)
        places = list(_PLACE.finditer(path.name))
        if len(places) > 1:
            raise OutputError(
                f"the name {path.name} has {len(places)} places for the frame number; one is enough"
            )
        self.folder = path.parent
        if places:
            place = places[0]
            digits = len(place[0]) if place[0].startswith("#") else int(place[1] or _DIGITS)
            self._parts = path.name[: place.start()], digits, path.name[place.end() :]
        else:
            self._parts = f"{path.stem}.", _DIGITS, path.suffix
        self.suffix = path.suffix

    def path(self, index: int) -> Path:
        """The file of frame `index`."""
        before, digits, after = self._parts
        return self.folder / f"{before}{index:0{digits}d}{after}"

    @property
    def title(self) -> str:
        """The name without number and suffix: what the sequence is called."""
        before, _, after = self._parts
        return (before + Path(after).stem * (Path(after).suffix != "")).strip("._- ") or "sequence"

    def __str__(self) -> str:
        before, digits, after = self._parts
        return str(self.folder / f"{before}{'#' * digits}{after}")


def is_pattern(path: str | os.PathLike) -> bool:
    """Whether the name has a place for a frame number."""
    return _PLACE.search(Path(path).name) is not None
