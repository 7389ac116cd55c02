"""Water on the ground: waves by slopes in a picture that repeats, and the colour of its depth.

How steep waves are follows from the wind (Cox & Munk 1954). In the equilibrium range every octave of
wavelengths has the same share of it (Phillips 1958: elevation spectrum k⁻³), so one picture of four octaves
serves at every scale; what a pixel cannot resolve becomes roughness, so that far water glitters broadly.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from ..gpu import FrameGraph

SIDE = 256
STEEPEST = 4.0  # standard deviations of slope that the picture's codes reach
OCTAVES = 11.0  # of waves, from some 10 m to the shortest that wind makes, some 6 mm
SCALES = (4.0, 64.0)  # m, widths that the picture is laid out at, each with waves of 1/4 to 1/64 of it
_OWN = 4.0  # octaves in the picture


@dataclass(frozen=True)
class Water:
    """What colours water.

    Attributes
    ----------
    deep : diffuse reflectance of bottomless water, linear Rec. 709
    absorption : 1/m, diffuse attenuation on one way
    """

    deep: tuple[float, float, float]
    absorption: tuple[float, float, float]


# Of the size that Kirk 2011, "Light and Photosynthesis in Aquatic Ecosystems", reports for clear sea, lakes
# brown from leaves and green from algae, melt water white with rock flour, rivers full of silt.
SEA = Water((0.010, 0.026, 0.046), (0.40, 0.075, 0.055))
LAKE = Water((0.012, 0.020, 0.013), (0.90, 0.50, 0.85))
MELT = Water((0.022, 0.062, 0.068), (0.75, 0.28, 0.26))
SILT = Water((0.072, 0.066, 0.040), (2.0, 1.9, 2.6))
WATERS = {"coast": SEA, "alpine": MELT, "canyon": SILT, "dunes": SEA}


@lru_cache(maxsize=2)
def wave_picture(seed: int) -> tuple[np.ndarray, tuple[float, ...]]:
    """Slopes of waves that run east, and gusts.

    Returns
    -------
    picture : (SIDE, SIDE, 4) uint8
        rg: slopes towards east and north, (code / 255 − ½) · 2 · STEEPEST standard deviations of the slope's
        length; b: gusts, smooth, mean ½. Rows run north.
    kept : of the mean square slope, by mip level
    """
    rng = np.random.default_rng((seed, 77))
    k = np.fft.fftfreq(SIDE, 1.0 / SIDE)
    kx, ky = np.meshgrid(k, k)
    size = np.hypot(kx, ky)
    # elevation: power 1/k⁴ per mode is k⁻³ along k; more of it with the wind than across
    spread = np.where(kx > 0.0, kx / np.maximum(size, 1.0), 0.0)
    band = np.clip(size / 4.0 - 0.5, 0.0, 1.0) * np.clip(2.0 - size / 48.0, 0.0, 1.0)
    phase = np.exp(2j * np.pi * rng.random(size.shape))
    elevation = phase * spread * band / np.maximum(size, 1.0) ** 2 * rng.rayleigh(size=size.shape)
    slopes = np.stack([np.fft.ifft2(2j * np.pi * axis * elevation).real for axis in (kx, ky)], -1)
    slopes /= np.sqrt((slopes**2).sum(-1).mean())
    gusts = np.fft.ifft2(phase * np.exp(-((size / 5.0) ** 2)) * (size > 0.0)).real
    gusts = 0.5 + 0.2 * gusts / gusts.std()
    picture = np.full((SIDE, SIDE, 4), 255.0)
    picture[..., :2] = 255.0 * (0.5 + 0.5 * slopes / STEEPEST)
    picture[..., 2] = 255.0 * gusts
    kept, level = [], slopes
    while level.shape[0] > 1:
        kept.append(float((level**2).sum(-1).mean()))
        half = level.shape[0] // 2
        level = level.reshape(half, 2, half, 2, 2).mean((1, 3))
    return np.round(np.clip(picture, 0.0, 255.0)).astype(np.uint8), (*kept, 0.0)


def slope_variance(wind: float) -> float:
    """Mean square slope of clean water under a wind in m/s, all waves: Cox & Munk 1954."""
    return 0.003 + 0.00512 * wind


def add_water(graph: FrameGraph, seed: int) -> None:
    """Declare ``terrain.waves``, with mips."""
    graph.texture_data("terrain.waves", wave_picture(seed)[0], "rgba8unorm", mips=True)


def water_constants(terrain: Any, seed: int, island: bool) -> dict[str, Any]:
    """The compile-time constants of ``water.wesl`` for a ``world.terrain``."""
    water = SEA if island else WATERS.get(terrain.material, LAKE)
    total = slope_variance(terrain.wind)
    return {
        "DEEP": water.deep,
        "ABSORPTION": water.absorption,
        "KEPT": list(wave_picture(seed)[1]),
        "WAVES": (_OWN / OCTAVES * total, (1.0 - 2.0 * _OWN / OCTAVES) * total),
        # elevation files end at the sea's surface: what lies below it they do not say
        "DEPTH_SCALE": 60.0 if island else 1.0,
    }
