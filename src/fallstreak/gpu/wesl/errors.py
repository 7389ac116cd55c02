"""The one exception of the linker: a sentence with the place it speaks of."""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches


class WeslError(Exception):
    """A shader module cannot be linked.

    Attributes
    ----------
    message : str
        The sentence without the place.
    filename : str
        The ``.wesl`` file, or ``<constants>`` and the like for a virtual module.
    line, column : int
        Counted from 1; 0 when the whole file is meant.
    """

    def __init__(self, message: str, filename: str = "", line: int = 0, column: int = 0):
        self.message, self.filename, self.line, self.column = message, filename, line, column
        place = ":".join(str(part) for part in (filename, line, column) if part)
        super().__init__(f"{place}: {message}" if place else message)


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """Return ``"; did you mean 'x'?"`` or an empty string when nothing known is close to `name`."""
    close = get_close_matches(name, list(known), n=1, cutoff=0.7)
    return f"; did you mean '{close[0]}'?" if close else ""
