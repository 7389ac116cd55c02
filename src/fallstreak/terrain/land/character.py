"""Detail below the resolution of an elevation model, in its character: float64 twin of ``character.wesl``.

The model knows waves from twice its spacing up, and its word stands: all that is added is finer than the
spacing and has mean 0, so that the mean over a cell of the model stays the model's height. Slopes are cut by
gullies that run down the model's own slope; steep ground is rough as rock is; flats stay flat.
"""

from __future__ import annotations

import numpy as np

from .erosion import ROUGH_PEAK, STEEPEST, WAVES, Gullies, Relief, carve, roughen

GULLIES = Gullies(depth=0.5, gain=0.9, lift=0.0, lift_gain=1.0, soft=0.1, calm=0.12, sharpness=0.35)
FLAT, STEEP = 0.004, 0.045  # amplitude over wavelength of the noise on flat ground and on rock
ROCKY = (0.45, 1.1)  # rise over run where rock begins and where there is nothing else
FINEST_GULLY, FINEST_NOISE = 2, 0
COARSEST = 9


def first_octave(spacing: float) -> int:
    """The coarsest octave of an elevation model with samples `spacing` m apart: waves shorter than that."""
    return int(np.clip(np.floor(np.log2(0.78 * WAVES * spacing)), FINEST_GULLY, COARSEST))


def detail(east, north, slope_east, slope_north, coarsest: int, step, seed: int) -> Relief:
    """What is added to the model's height: `Relief.height`, m; its slopes are those of both together.

    Parameters
    ----------
    east, north : float64 arrays of one shape, m
    slope_east, slope_north : arrays, rise over run of the model
    coarsest : `first_octave` of the model's spacing
    step : m between samples, number or array
    seed : int
    """
    zero = np.zeros(east.shape)
    land = Relief(zero, slope_east + zero, slope_north + zero, zero, zero)
    rough = roughness(np.sqrt(slope_east**2 + slope_north**2))
    land = carve(land, east, north, coarsest, FINEST_GULLY, step, seed, GULLIES)
    return roughen(land, east, north, coarsest, FINEST_NOISE, step, seed, rough)


def roughness(slope):
    """Amplitude over wavelength of the noise on ground of a slope (rise over run)."""
    t = np.clip((slope - ROCKY[0]) / (ROCKY[1] - ROCKY[0]), 0.0, 1.0)
    return FLAT + (STEEP - FLAT) * t * t * (3.0 - 2.0 * t)


def bound(coarsest: int, slope=STEEPEST):
    """The most that `detail` adds or takes away, m, where the model's slope is at most so steep.

    Gullies steepen the ground that finer ones are cut into: by less than half in all.
    """
    steep = np.minimum(1.5 * slope / np.sqrt(1.0 + slope * slope / STEEPEST**2), STEEPEST)
    gullies = GULLIES.depth * steep * 1.1 / (2.0 * np.pi * WAVES)
    return (gullies / (1.0 - 0.5 * GULLIES.gain) + 2.0 * ROUGH_PEAK * roughness(slope)) * 2.0**coarsest
