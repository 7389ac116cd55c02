"""One function for every format: the suffix decides."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from fallstreak.output.errors import OutputError
from fallstreak.output.exr import write_exr
from fallstreak.output.layers import FrameLike, check_layers, layers_of
from fallstreak.output.metadata import png_text
from fallstreak.output.npz import write_npz
from fallstreak.output.png import write_png

FORMATS = {
    ".png": "the finished picture, 8 or 16 bit",
    ".exr": "float layers in cd/m² and metres",
    ".npz": "numpy arrays",
}


def save(
    frame: FrameLike,
    path: str | os.PathLike,
    *,
    layers: Iterable[str] | None = None,
    bits: int | None = None,
    facts: Mapping[str, Any] | None = None,
) -> Path:
    """Write a frame to a file; the suffix decides the format.

    Parameters
    ----------
    frame : FrameLike
        What `fallstreak.render` gives.
    path : path-like
        Ends in .png, .exr or .npz. Its folder must exist. A file already there is replaced at once when the
        new one is complete.
    layers : iterable of str, optional
        For .exr and .npz: which of "hdr", "depth", "normal", "albedo", "motion", "clouds"; by default all
        that were rendered.
    bits : {8, 16}, optional
        For .png: bits per channel; by default what was rendered.
    facts : mapping, optional
        More metadata, over the frame's own.

    Returns
    -------
    Path
        Where the file is.

    Raises
    ------
    OutputError
        For an unknown suffix, a layer that does not exist or was not rendered, or a place that cannot be
        written.
    """
    path = Path(path)
    suffix = check_format(path)
    if bits is None:
        bits = 8 if frame.ldr is not None else 16
    facts = file_metadata({**frame.metadata, **(facts or {})}, path, layers=layers, bits=bits, frame=frame)
    if suffix == ".png":
        write_png(path, _picture(frame, bits), png_text(facts))
    elif suffix == ".exr":
        write_exr(path, layers_of(frame, layers), facts)
    else:
        arrays = layers_of(frame, layers)
        if layers is None and frame.ldr is not None:
            arrays["ldr"] = frame.ldr
        write_npz(path, arrays, facts)
    return path


def check_format(path: str | os.PathLike) -> str:
    """The lower-case suffix if it is one of `FORMATS`; else an `OutputError` that lists them."""
    path = Path(path)
    suffix = path.suffix.lower()
    if suffix not in FORMATS:
        known = ", ".join(f"{name} ({what})" for name, what in FORMATS.items())
        wrong = f"the suffix {path.suffix!r} is unknown" if suffix else "the name has no suffix"
        raise OutputError(f"cannot write {path}: {wrong}; there are {known}")
    return suffix


def file_metadata(
    metadata: Mapping[str, Any],
    path: str | os.PathLike,
    *,
    layers: Iterable[str] | None,
    bits: int,
    frame: FrameLike | None = None,
) -> dict[str, Any]:
    """A frame's metadata with what concerns this one file: its bits or its layers.

    Without `frame` and `layers`, the layers are left out: they are not known before the frame is rendered.
    """
    facts = dict(metadata)
    if Path(path).suffix.lower() == ".png":
        if bits not in (8, 16):
            raise OutputError(f"a PNG has 8 or 16 bits per channel, not {bits}")
        facts["bits"] = bits
    elif layers is not None:
        facts["layers"] = list(check_layers(layers))
    elif frame is not None:
        facts["layers"] = list(layers_of(frame))
    return facts


def _picture(frame: FrameLike, bits: int) -> np.ndarray:
    pixels = getattr(frame, "ldr" if bits == 8 else "ldr16", None)
    if pixels is None:
        raise OutputError(f"a PNG of {bits} bits was asked for, but the frame was not rendered so")
    return np.asarray(pixels, np.uint8 if bits == 8 else np.uint16)
