"""``fallstreak noise``: a picture of a noise, for a look before it goes into a program."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from fallstreak.commands import arguments as check
from fallstreak.commands.arguments import UsageError

if TYPE_CHECKING:
    import numpy as np

_FLAG = Parameter(negative="", show_default=False)

# Colours at equal distances from low to high, sRGB 0…255.
COLORS: dict[str, tuple[tuple[int, int, int], ...]] = {
    "grey": ((0, 0, 0), (255, 255, 255)),
    "signed": ((9, 43, 89), (53, 126, 178), (240, 240, 236), (214, 120, 62), (97, 24, 18)),
    "fire": ((6, 4, 12), (92, 18, 52), (196, 58, 36), (246, 160, 48), (255, 246, 208)),
    "land": ((14, 38, 84), (44, 108, 148), (206, 194, 146), (96, 128, 66), (112, 96, 78), (250, 250, 250)),
}


def noise(
    *,
    output: Annotated[Path, Parameter(name=["-o", "--output"], negative="")] = Path("noise.png"),
    kind: str = "perlin",
    fractal: str = "fbm",
    octaves: int = 1,
    lacunarity: float = 2.0,
    gain: float = 0.5,
    warp: float | None = None,
    size: str = "512x512",
    seed: int = 0,
    dims: int = 3,
    frequency: float | None = None,
    period: int | None = None,
    at: str | None = None,
    smooth: Annotated[bool, _FLAG] = False,
    range: str | None = None,
    colors: str = "grey",
    bits: int = 8,
    gpu: Annotated[bool, _FLAG] = False,
) -> int:
    """Draw noise: a plane through it, as a PNG.

    Parameters
    ----------
    output
        The file, .png.
    kind
        perlin, simplex, value, cellular_f1, cellular_f2, cellular_f2f1, improved or table.
    fractal
        How octaves add up: fbm, ridged, billow, turbulence or hybrid.
    octaves
        How many, each finer than the last; one shows what the kind is like, eight make clouds.
    lacunarity
        How much finer each octave is.
    gain
        How much weaker.
    warp
        Displace the points by noise first, by so many cells; with fbm.
    size
        Width x height in pixels, 16 to 8192 each.
    seed
        0 to 4294967295; each is another noise.
    dims
        The dimensions of the noise, of which the picture is a plane: 2, 3 or 4.
    frequency
        Cells of the first octave across the width. [default: 8, or the period]
    period
        Repeat after so many cells, so that copies of the picture fit together.
    at
        Where the upper left corner lies, in cells, as many numbers as dims: 1e7,0,0.5. [default: 0,0,0.37]
    smooth
        Leave out octaves finer than the pixels, fading: no aliasing.
    range
        What is black and what is white: -1,1. [default: the lowest and highest value there are]
    colors
        grey, signed, fire or land.
    bits
        8 or 16 per channel.
    gpu
        Compute on the graphics adapter.
    """
    width, height = check.parse_size(size)
    check.check_file(output, "-o", "noise.png")
    if output.suffix.lower() != ".png":
        raise UsageError(f"-o {output} is not a PNG: give a name that ends in .png, such as noise.png")
    if bits not in (8, 16):
        raise UsageError(f"--bits {bits} is not allowed: it must be 8 or 16")
    if dims not in (2, 3, 4):
        raise UsageError(f"--dims {dims} is not allowed: it must be 2, 3 or 4")
    if colors not in COLORS:
        raise UsageError(f"--colors {colors} is not allowed: it must be {', '.join(COLORS)}")
    if warp is not None and fractal != "fbm":
        raise UsageError(f"--warp does not go with --fractal {fractal}: points are displaced for fbm only")
    cells = float(period or 8) if frequency is None else frequency
    check.check_number("--frequency", cells, 1e-6, 1e6)
    corner = _numbers("--at", at, dims) if at is not None else (0.0, 0.0, 0.37, 0.37)[:dims]
    limits = _numbers("--range", range, 2) if range is not None else None
    if limits and limits[0] >= limits[1]:
        raise UsageError(f"--range {range} is empty: write LOW,HIGH, such as --range=-1,1")

    options = {
        "octaves": octaves,
        "kind": kind,
        "lacunarity": lacunarity,
        "gain": gain,
        "seed": seed,
        "period": period,
        "spacing": cells / width if smooth else None,
    }
    try:
        if gpu:
            values, where = _on_gpu(width, height, corner, cells, fractal, warp, options)
        else:
            values, where = _on_cpu(width, height, corner, cells, fractal, warp, options), "on the CPU"
    except ValueError as error:  # such as: kind='perln' is not allowed: …
        message = str(error).replace("amount=", "warp=", 1)
        raise UsageError(f"--{message}") from None
    low, high = limits or (float(values.min()), float(values.max()))
    from fallstreak.output.png import write_png

    text = {"kind": kind, "fractal": fractal, "octaves": octaves, "seed": seed, "cells": cells, "low": low}
    write_png(
        output,
        colour(values, low, high, colors, bits),
        {"fallstreak:noise": json.dumps(text | {"high": high})},
    )
    first, last = ("black", "white") if colors == "grey" else ("the first colour", "the last")
    octaves_text = "one octave" if octaves == 1 else f"{octaves} octaves of {fractal}"
    print(
        f"{output}: {kind}, {octaves_text}, {width}×{height} {where}; {low:.3g} is {first}, {high:.3g} {last}"
    )
    return 0


def colour(values: np.ndarray, low: float, high: float, colors: str, bits: int) -> np.ndarray:
    """Values as pixels: `low` as the first colour, `high` as the last, in uint8 or uint16."""
    import numpy as np

    table = np.array(COLORS[colors], float) / 255.0
    place = np.clip((values.astype(float) - low) / max(high - low, 1e-30), 0.0, 1.0)
    most = 2**bits - 1
    dtype = np.uint8 if bits == 8 else np.uint16
    if colors == "grey":
        return np.rint(place * most).astype(dtype)
    stops = np.linspace(0.0, 1.0, len(table))
    channels = [np.interp(place, stops, table[:, c]) for c in (0, 1, 2)]
    return np.rint(np.stack(channels, -1) * most).astype(dtype)


def _on_cpu(width, height, corner, cells, fractal, warp, options):
    from fallstreak import noise

    if warp is not None:
        return noise.warp(_points(width, height, corner, cells), warp, **options)
    shape = (1,) * (len(corner) - 2) + (height, width)
    values = noise.grid(shape, step=cells / width, origin=corner, fractal=fractal, **options)
    return values.reshape(height, width)


def _on_gpu(width, height, corner, cells, fractal, warp, options):
    import numpy as np

    from fallstreak.gpu import Device
    from fallstreak.noise.bake import Layer, sample

    period, spacing = options.pop("period"), options.pop("spacing")
    layer = Layer(fractal=fractal, frequency=1.0, warp=warp or 0.0, **options)
    device = Device.open()
    points = np.stack([axis.ravel() for axis in _points(width, height, corner, cells)], -1)
    values = sample(device, points, layer, period=period, spacing=spacing)
    return values.reshape(height, width), f"on {device.adapter.name}"


def _points(width, height, corner, cells):
    import numpy as np

    step = cells / width
    x, y = np.meshgrid(corner[0] + step * np.arange(width), corner[1] + step * np.arange(height))
    return (x, y, *(np.full((height, width), c) for c in corner[2:]))


def _numbers(option: str, text: str, count: int) -> tuple[float, ...]:
    import math

    try:
        numbers = tuple(float(part) for part in text.split(","))
    except ValueError:
        numbers = ()
    if len(numbers) != count or not all(math.isfinite(number) for number in numbers):
        raise UsageError(f"{option} {text} is not allowed: write {count} numbers with commas between them")
    return numbers
