"""A file appears whole or not at all: write beside, then rename."""

from __future__ import annotations

import errno
import os
import threading
from collections.abc import Collection, Iterator
from contextlib import contextmanager
from pathlib import Path

from fallstreak.output.errors import OutputError

_REASONS = {
    errno.ENOENT: "the folder does not exist",
    errno.ENOTDIR: "a part of its path is a file, not a folder",
    errno.EACCES: "there is no permission to write there",
    errno.EPERM: "there is no permission to write there",
    errno.EROFS: "the file system is read-only",
    errno.ENOSPC: "the disk is full",
    errno.EDQUOT: "the disk quota is used up",
    errno.EFBIG: "the file would be larger than the system allows",
    errno.EISDIR: "there is a folder of that name",
    errno.ENAMETOOLONG: "the name is too long",
}


def reason(error: OSError) -> str:
    """The half sentence that tells a person why the system refused."""
    known = _REASONS.get(error.errno or 0)
    return known or (error.strerror or str(error)).lower()


@contextmanager
def replacing(path: str | os.PathLike) -> Iterator[Path]:
    """Give a hidden path beside `path` to write to; on success it becomes `path`, on failure it vanishes.

    Parameters
    ----------
    path : path-like
        Where the finished file shall be. Its folder must exist.

    Raises
    ------
    OutputError
        For everything the operating system refuses, in one sentence.
    """
    path = Path(path)
    # Process and thread in the name: two writers of one file never meet in one half-written file.
    beside = path.with_name(f".{path.name}.{os.getpid()}-{threading.get_ident() % 100000}.part")
    try:
        try:
            yield beside
            if path.is_dir():
                raise IsADirectoryError(errno.EISDIR, "is a directory")
            os.replace(beside, path)
        except BaseException:
            # Also for KeyboardInterrupt: nothing half-written may stay.
            beside.unlink(missing_ok=True) if beside.parent.is_dir() else None
            raise
    except OSError as error:
        raise OutputError(f"cannot write {path}: {reason(error)}") from error


def remove_leftovers(folder: str | os.PathLike, names: Collection[str]) -> None:
    """Remove the hidden parts that killed processes left of the named files in `folder`.

    Only those whose writer no longer runs on this machine are touched.
    """
    for part in Path(folder).glob(".*.part"):
        name, _, writer = part.name[1 : -len(".part")].rpartition(".")
        pid = writer.split("-", 1)[0]
        if name in names and pid.isdigit() and not _runs(int(pid)):
            part.unlink(missing_ok=True)


def _runs(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    except OSError:
        pass
    return True
