"""The renderer's memory of earlier frames, kept beside a sequence while it is unfinished.

Anti-aliasing and exposure look back, so frame 500 needs what frame 499 left on the GPU. Every few frames that
state goes into `.fallstreak/<title>.<frame>.npz` beside the pictures. A resumed sequence starts from the
newest state before the first missing frame instead of from the beginning, and gets the same bytes.
"""

from __future__ import annotations

import os
import re
import threading
import zipfile
import zlib
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from fallstreak.output.atomic import replacing
from fallstreak.output.errors import OutputError
from fallstreak.output.metadata import canonical

State = dict[str, np.ndarray | bytes]
FOLDER = ".fallstreak"
_KEPT = 2
_IDENTITY = "fallstreak.sequence"
_BYTES = "bytes:"
_UNREADABLE = (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile, zlib.error)


class Checkpoints:
    """States of one sequence on disk.

    Parameters
    ----------
    folder : path-like
        Where the pictures are.
    title : str
        What the sequence is called.
    identity : mapping
        What makes this sequence this sequence; states of another one are ignored.
    """

    def __init__(self, folder: str | os.PathLike, title: str, identity: Mapping[str, Any]):
        self.folder = Path(folder) / FOLDER
        self._title = title
        self._identity = canonical(identity)
        self._newest = -1
        self._forgetting = threading.Lock()

    def save(self, index: int, state: Mapping[str, np.ndarray | bytes]) -> None:
        """Keep the state after frame `index`, and forget all but the newest two up to the last one saved.

        May be called from several threads; the later state may be on disk first.
        """
        entries: dict[str, np.ndarray] = {_IDENTITY: np.array(self._identity)}
        for name, value in state.items():
            if isinstance(value, bytes | bytearray | memoryview):
                entries[_BYTES + name] = np.frombuffer(value, np.uint8)
            else:
                entries[name] = np.asarray(value)
        try:
            self.folder.mkdir(exist_ok=True)
        except OSError as error:
            raise OutputError(f"cannot make {self.folder} for checkpoints: {error.strerror}") from error
        with replacing(self._path(index)) as beside, open(beside, "wb") as file:
            np.savez(file, allow_pickle=False, **entries)
        with self._forgetting:
            self._newest = max(self._newest, index)
            for old in [kept for kept in self.indices() if kept <= self._newest][:-_KEPT]:
                self._path(old).unlink(missing_ok=True)

    def indices(self) -> list[int]:
        """Frames after which a state was kept, ascending."""
        name = re.compile(re.escape(self._title) + r"\.(\d+)\.npz")
        found = (name.fullmatch(path.name) for path in self.folder.glob("*.npz"))
        return sorted(int(match[1]) for match in found if match)

    def load(self, index: int) -> State | None:
        """The state after frame `index`; None if it is damaged or of another sequence."""
        if not self._is_ours(index):
            return None
        try:
            with np.load(self._path(index), allow_pickle=False) as file:
                return {
                    name.removeprefix(_BYTES): file[name].tobytes() if name.startswith(_BYTES) else file[name]
                    for name in file
                    if name != _IDENTITY
                }
        except _UNREADABLE:
            return None

    def prune(self) -> None:
        """Remove what is damaged or of another sequence of the same title."""
        for index in self.indices():
            if not self._is_ours(index):
                self._path(index).unlink(missing_ok=True)

    def _is_ours(self, index: int) -> bool:
        try:
            with np.load(self._path(index), allow_pickle=False) as file:
                return str(file[_IDENTITY]) == self._identity
        except _UNREADABLE:
            return False

    def remove(self) -> None:
        """Forget all states of this sequence, and the folder if it is empty."""
        for path in self.folder.glob("*"):
            if re.fullmatch(r"\.?" + re.escape(self._title) + r"\.\d+\.npz(\..*\.part)?", path.name):
                path.unlink(missing_ok=True)
        with suppress(OSError):  # other sequences may keep states there
            self.folder.rmdir()

    def _path(self, index: int) -> Path:
        return self.folder / f"{self._title}.{index:04d}.npz"
