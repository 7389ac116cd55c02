"""Noise by wavelength on the CPU: float64 twin of ``octaves.wesl``."""

from __future__ import annotations

import numpy as np

from ..noise import patterns


def octave(east, north, power: int, seed: int):
    """Noise of wavelength 2^power m: value (mean 0, standard deviation 0.25) and slopes per metre."""
    scale = 2.0**power
    value, dx, dy = patterns.slope(east / scale, north / scale, seed + power + 16)
    return value, dx / scale, dy / scale


wide = octave
"""The same for wavelengths above 4096 m, which the GPU finds from the map in single precision."""


def octave_weight(power: int, step):
    """How much of an octave a step (m) can carry: all below a quarter of the wave, nothing from half."""
    return np.clip(2.0 - 4.0 * np.asarray(step) * 2.0**-power, 0.0, 1.0)
