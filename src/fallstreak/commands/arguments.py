"""What people type after ``fallstreak render``, turned into values; every mistake is one sentence."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Sequence
from pathlib import Path

from fallstreak.output.errors import OutputError
from fallstreak.output.layers import LAYERS, check_layers
from fallstreak.output.naming import FrameNames, is_pattern
from fallstreak.output.save import check_format
from fallstreak.world.errors import UserError, shorten

SMALLEST, LARGEST = 16, 8192  # what the renderer takes; the larger is WebGPU's default limit of a texture
LAST_FRAME = 10_000_000


class UsageError(UserError):
    """A value on the command line that is not allowed."""


def parse_size(text: str) -> tuple[int, int]:
    """ "1280x720" as (1280, 720)."""
    match = re.fullmatch(r"\s*(\d{1,9})\s*[x×X*]\s*(\d{1,9})\s*", text)
    if not match:
        raise UsageError(
            f"--size {shorten(text)} is not a size: write WIDTHxHEIGHT in pixels, such as 1280x720"
        )
    size = int(match[1]), int(match[2])
    if min(size) < SMALLEST or max(size) > LARGEST:
        raise UsageError(
            f"--size {shorten(text)} is not allowed: each side must be {SMALLEST} to {LARGEST} pixels"
        )
    return size


def parse_frames(text: str) -> range:
    """ "0:48" as the frames 0 to 47."""
    match = re.fullmatch(r"\s*(\d{0,12})\s*:\s*(\d{1,12})\s*", text)
    if not match:
        raise UsageError(
            f"--frames {shorten(text)} is not a range: write FIRST:END, such as 0:48 for the frames 0 to 47"
        )
    first, end = int(match[1] or 0), int(match[2])
    if first >= end:
        raise UsageError(f"--frames {shorten(text)} is empty: the end must be greater than the first frame")
    if end > LAST_FRAME:
        raise UsageError(f"--frames {shorten(text)} is not allowed: the end must be at most {LAST_FRAME:,}")
    return range(first, end)


def parse_layers(text: str) -> tuple[str, ...]:
    """ "hdr,depth" as ("hdr", "depth"); "all" is all of them."""
    names = [name for name in re.split(r"[,\s]+", text.strip().lower()) if name]
    if names == ["all"]:
        return tuple(LAYERS)
    if not names:
        raise UsageError(f"--layers is empty: give one or more of {', '.join(LAYERS)}, separated by commas")
    try:
        return check_layers(names)
    except OutputError as error:
        raise UsageError(f"--layers {shorten(text)}: {error}") from error


def camera_overrides(text: str) -> list[str]:
    """ "height=2000,pitch=-5" as overrides of the scene; a camera given here stands still."""
    from fallstreak.world import Camera

    known = [name for name in Camera.model_fields if name != "keyframes"]
    overrides = ["camera.keyframes=[]"]
    for part in filter(None, (part.strip() for part in text.split(","))):
        key, equals, value = (piece.strip() for piece in part.partition("="))
        if not equals or not value or key not in known:
            raise UsageError(
                f"--camera: {shorten(part)} is not allowed: write KEY=VALUE with one of {', '.join(known)}, "
                "such as height=2000,heading=250,pitch=-5"
            )
        overrides.append(f"camera.{key}={value}")
    return overrides


def check_number(name: str, value: float, low: float, high: float) -> None:
    """Refuse what is outside low..high."""
    if not low <= value <= high:
        raise UsageError(f"{name} {value:.15g} is not allowed: it must be {low:g} to {high:g}")


def check_outputs(paths: Sequence[Path], *, sequence: bool) -> None:
    """Refuse, before anything is rendered, what could not be written afterwards."""
    seen: set[Path] = set()
    for path in paths:
        check_file(path, "-o", "picture.png")
        check_format(path)
        if is_pattern(path) and not sequence:
            raise UsageError(
                f"-o {path} is the name of a sequence: give --frames FIRST:END too, or another name"
            )
        if path.absolute() in seen:
            raise UsageError(f"-o {path} is given twice")
        seen.add(path.absolute())


def check_file(path: Path, option: str, example: str = "stats.json") -> None:
    """Refuse a file that is a folder, or whose folder is not there or not writable."""
    if path.is_dir():
        raise UsageError(f"{option} {path} is a folder: give a file name in it, such as {path / example}")
    folder = path.parent
    if not folder.exists():
        raise UsageError(f"{option} {path}: there is no folder {folder}; make it with: mkdir -p {folder}")
    if not folder.is_dir():
        raise UsageError(f"{option} {path}: {folder} is a file, not a folder")
    if not os.access(folder, os.W_OK | os.X_OK):
        raise UsageError(f"{option} {path}: there is no permission to write into {folder}")


def check_layers_fit(layers: tuple[str, ...] | None, paths: Iterable[Path]) -> None:
    """Refuse layers that no output could hold."""
    paths = list(paths)
    if layers and all(path.suffix.lower() == ".png" for path in paths):
        raise UsageError(
            f"--layers {','.join(layers)} does not go into {paths[0].name}: a PNG holds only the picture; "
            "add -o with .exr or .npz"
        )


def check_bits_fit(bits: int | None, paths: Iterable[Path]) -> None:
    """Refuse a depth of bits that no output has."""
    paths = list(paths)
    if bits is not None and all(path.suffix.lower() != ".png" for path in paths):
        raise UsageError(
            f"--bits {bits} does not go into {paths[0].name}: only a PNG has 8 or 16; add -o with .png"
        )


def sequence_names(paths: Sequence[Path]) -> list[FrameNames]:
    """The numbered names of a sequence, which must not meet."""
    names = [FrameNames(path) for path in paths]
    if len({str(name.path(0)) for name in names}) < len(names):
        raise UsageError("two of the -o names are the same when numbered")
    return names
