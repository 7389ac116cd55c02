"""The bytes of files that nobody vouches for: size, kind and place are checked first."""

from __future__ import annotations

import os
import stat
from pathlib import Path
from urllib.parse import unquote

from ..world.errors import UserError, shorten

MAX_BYTES = 512 << 20
"""Of one file; a model of four million vertices with its textures needs less."""


class ModelError(UserError):
    """A model cannot be used: one sentence that names the file and the reason."""


def read_bytes(path: Path, what: str) -> bytes:
    """A regular file of bounded size.

    Raises
    ------
    ModelError
        When there is none, or it is a folder, a pipe, too large, or not to be read.
    """
    try:
        # A pipe would wait for its writer: O_NONBLOCK opens it at once, and what it is decides.
        handle = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0))
        with open(handle, "rb") as file:
            status = os.fstat(handle)
            if not stat.S_ISREG(status.st_mode):
                raise ModelError(f"{what} is no regular file but a device or a pipe")
            if status.st_size > MAX_BYTES:
                size = f"{status.st_size / 2**20:,.0f} MiB"
                raise ModelError(f"{what} has {size}, and at most {MAX_BYTES >> 20} MiB are read")
            return file.read(MAX_BYTES)
    except FileNotFoundError:
        raise ModelError(f"{what} does not exist") from None
    except IsADirectoryError:
        raise ModelError(f"{what} is a folder, and a model is a .glb or .gltf file") from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise ModelError(f"{what} cannot be read: {reason}") from None


def read_beside(uri: str, folder: Path) -> bytes:
    """A buffer or an image that a .gltf names: relative, in the model's folder, also after following links.

    Raises
    ------
    ModelError
        For a URI with a scheme, an absolute one, or one that leaves the folder.
    """
    name = unquote(uri)
    if "\0" in name or "\\" in name or ":" in name.split("/")[0]:
        raise ModelError(f"it names {shorten(uri)}, and only files in the model's own folder are read")
    root = folder.resolve()
    try:
        target = (root / name).resolve()
    except (OSError, RuntimeError):
        raise ModelError(f"it names {shorten(uri)}, which cannot be followed") from None
    if Path(name).is_absolute() or not target.is_relative_to(root) or target == root:
        raise ModelError(f"it names {shorten(uri)}, which leaves the model's folder")
    return read_bytes(target, f"{shorten(uri)}, which it names,")
