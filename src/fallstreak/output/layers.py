"""What a rendered frame offers, and what its layers are called in files."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from fallstreak.output.errors import OutputError


class FrameLike(Protocol):
    """A finished frame in memory. A layer that was not rendered is absent or None.

    Attributes
    ----------
    hdr : ndarray of float32, shape (H, W, 3)
        Luminance, linear Rec. 709, cd/m², without exposure.
    ldr : ndarray of uint8, shape (H, W, 3)
        The finished picture: exposed, tone-mapped, sRGB, dithered.
    ldr16 : ndarray of uint16, shape (H, W, 3)
        The same in 16 bits; a frame has one or the other.
    depth : ndarray of float32, shape (H, W)
        Distance from the camera along the ray, metres; infinite where nothing is hit.
    normal : ndarray of float32, shape (H, W, 3)
        Unit normal, world axes (east, north, up); zero where nothing is hit.
    albedo : ndarray of float32, shape (H, W, 3)
        Linear Rec. 709, 0 to 1.
    motion : ndarray of float32, shape (H, W, 2)
        Where the point now in this pixel came from: position now − position in the frame before, pixels, x
        right, y down.
    clouds : ndarray of float32, shape (H, W)
        Opacity of the clouds in front, 0 to 1.
    metadata : mapping
        Scene, time, frame, seed, version, adapter, size, samples, ev100: nothing that differs between two
        runs.
    stats : mapping
        Timings and memory.
    """

    @property
    def ldr(self) -> np.ndarray | None: ...

    @property
    def metadata(self) -> Mapping[str, Any]: ...

    @property
    def stats(self) -> Mapping[str, Any]: ...


@dataclass(frozen=True)
class Layer:
    """One layer: its channels in an EXR file and what its numbers mean."""

    name: str
    channels: tuple[str, ...]
    meaning: str


LAYERS = {
    layer.name: layer
    for layer in (
        Layer("hdr", ("R", "G", "B"), "luminance, linear Rec. 709, cd/m2"),
        Layer("depth", ("Z",), "distance from the camera along the ray, m; infinite where the ray leaves"),
        Layer("normal", ("N.X", "N.Y", "N.Z"), "unit normal, x east, y north, z up"),
        Layer("albedo", ("albedo.R", "albedo.G", "albedo.B"), "linear Rec. 709, 0 to 1"),
        Layer(
            "motion", ("motion.X", "motion.Y"), "position now - position in the frame before, pixels, y down"
        ),
        Layer("clouds", ("clouds.A",), "opacity of the clouds in front of what lies behind, 0 to 1"),
    )
}


def layers_of(frame: FrameLike, wanted: Iterable[str] | None = None) -> dict[str, np.ndarray]:
    """The float layers of a frame by name, in the order of `LAYERS`.

    Parameters
    ----------
    frame : FrameLike
        The frame.
    wanted : iterable of str, optional
        Names from `LAYERS`; by default all the frame has.

    Raises
    ------
    OutputError
        When a wanted layer does not exist or the frame does not have it.
    """
    names = list(LAYERS) if wanted is None else check_layers(wanted)
    found = {name: getattr(frame, name, None) for name in LAYERS if name in names}
    if wanted is not None:
        for name, pixels in found.items():
            if pixels is None:
                raise OutputError(f"the layer {name!r} was not rendered")
    return {name: np.asarray(pixels, np.float32) for name, pixels in found.items() if pixels is not None}


def check_layers(names: Iterable[str]) -> tuple[str, ...]:
    """The names in the order of `LAYERS`, each once; an unknown one is an `OutputError`."""
    names = list(names)
    for name in names:
        if name not in LAYERS:
            raise OutputError(f"there is no layer {name!r}; there are {', '.join(LAYERS)}")
    return tuple(name for name in LAYERS if name in names)
