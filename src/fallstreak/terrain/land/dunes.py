"""Seas of sand: float64 twin of ``dunes.wesl``.

Crests are lines of equal phase of waves that run with the wind, one to a lattice cell, blended as phasors
(`erosion.stripes` says after whom): where neighbours disagree a dune ends or two join, which makes crests
sinuous and horned. A dune climbs gently to windward; its lee is a slip face at the angle at which dry sand
comes to rest, whatever its height and however its crest turns, because the gradient of the phase is known.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ...noise.scatter import hash_lattice
from ..octaves import wide
from .erosion import JITTER, REACH, Relief, roughen, wave
from .shape import LandShape

REPOSE = 0.6745  # tangent of 34 degrees
STEEPNESS, FACE = 3.2, 0.1  # rms slope of dunes over height by spacing; width of slip faces over spacing
SWAY = 0.35  # how far the wind of a cell turns from the mean
# systems of dunes: spacing over that of the largest, height over theirs
SECOND_SPACING, SECOND_HEIGHT = 0.14, 0.1
THIRD_SPACING, THIRD_HEIGHT = 0.012, 0.006


class Dunes:
    """Transverse and barchanoid dunes, star dunes where `roughness` is high; see `world.terrain` (`LAND`).

    Attributes
    ----------
    native : m, the step from which on only materials add detail
    outside : m, height of the globe beyond the map
    shift_bound : m, the largest shift of a sample from its place on the map
    """

    native = 0.5
    shift_bound = 0.0

    def __init__(self, land: Any, seed: int):
        self.base, self.relief, self.roughness = land.base_height, land.relief, land.roughness
        self.feature, self.water_level, self.seed = land.feature_size, land.water_level, seed
        self.outside = self.base
        self.wind = wind_of(seed)

    def bounds(self) -> tuple[float, float]:
        """Lowest and highest height anywhere, m."""
        return self.base - 0.5 * self.relief - 5.0, self.base + 1.9 * self.relief + 5.0

    def shape(self, east: np.ndarray, north: np.ndarray, step: np.ndarray | float) -> LandShape:
        """The land at places (m) as a mesh with `step` metres between vertices can carry it."""
        east, north, step = np.broadcast_arrays(*(np.asarray(x, np.float64) for x in (east, north, step)))
        seed, relief, (we, wn) = self.seed, self.relief, self.wind
        power = cell_power(self.feature)
        low, low_e, low_n = wide(east, north, power + 3, seed)
        supply = np.clip(0.62 + 1.5 * wide(east, north, power + 1, seed + 7)[0] + 0.8 * low, 0.0, 1.0)
        supply = supply * supply * (3.0 - 2.0 * supply)
        height, slip, lost = dune(
            east, north, self.feature, relief * (0.12 + 0.88 * supply), we, wn, step, seed
        )
        # another wind, a third of a turn away, makes ridges that meet those of the first in stars
        star = self.roughness * supply
        ce, cn = -0.5 * we - 0.866 * wn, 0.866 * we - 0.5 * wn
        cross, cross_slip, cross_lost = dune(
            east, north, 1.3 * self.feature, 0.8 * relief * star, ce, cn, step, seed + 1
        )
        over = cross - height
        share = np.clip(0.5 + over / (0.06 * relief + 1e-6), 0.0, 1.0)
        height = height + share * (over + 0.03 * relief * (1.0 - share))
        slip = slip + share * (cross_slip - slip)
        lost = lost + share * (cross_lost - lost)
        # smaller dunes ride on the windward sides and lie in the flats
        for i, (spacing, tall) in enumerate(((SECOND_SPACING, SECOND_HEIGHT), (THIRD_SPACING, THIRD_HEIGHT))):
            room = (1.0 - slip) * (0.35 + 0.65 * supply)
            te, tn = we - 0.25 * (2 * i - 1) * wn, wn + 0.25 * (2 * i - 1) * we
            more, _, more_lost = dune(
                east, north, spacing * self.feature, tall * relief * room, te, tn, step, seed + 2 + i
            )
            height, lost = height + more, lost + more_lost
        zero = np.zeros(east.shape)
        land = Relief(height + 0.5 * relief * low, 0.5 * relief * low_e, 0.5 * relief * low_n, zero, lost)
        land = roughen(land, east, north, 4, 0, step, seed, 0.006 * (1.0 - slip))
        return LandShape(
            self.base + land.height, zero + self.water_level, zero, zero, np.sqrt(land.lost), zero + 1.0
        )


def wind_of(seed: int) -> tuple[float, float]:
    """Unit vector the wind blows to."""
    h = int(hash_lattice(np.array([17]), np.array([23]), seed)[0])
    e, n = (h & 0xFFFF) / 65535.0 - 0.5, (h >> 16) / 65535.0 - 0.5
    length = np.sqrt(e * e + n * n + 1e-6)
    return e / length, n / length


def cell_power(spacing: float) -> int:
    """Cells about as wide as two dunes."""
    return int(np.floor(np.log2(spacing) + 1.0))


def dune(east, north, spacing: float, tall, wind_east, wind_north, step, seed: int):
    """One system of dunes: height (m), share of slip face 0..1, mean square of the slope left out."""
    power = cell_power(spacing)
    weight = np.clip(2.0 - 4.0 * step / spacing, 0.0, 1.0)
    typical = STEEPNESS * tall / spacing
    coarse = step / (FACE * spacing)
    lost = (1.0 - weight * weight / (1.0 + coarse * coarse)) * typical * typical
    waves = 2.0**power / spacing
    turns, strength, gradient = phasor(east, north, power, waves * wind_east, waves * wind_north, seed)
    tall = tall * strength
    lee = np.clip(tall * gradient / REPOSE, 0.02, 0.45)
    climb = np.clip(turns / (1.0 - lee), 0.0, 1.0)
    fall = np.clip((1.0 - turns) / lee, 0.0, 1.0)
    shape = np.where(turns < 1.0 - lee, climb * climb * (2.2 - 1.2 * climb), fall)
    slip = np.where(turns < 1.0 - lee, 0.0, np.minimum(8.0 * np.minimum(fall, 1.0 - fall), 1.0))
    # the mean of what is too fine
    return tall * (0.42 + weight * (shape - 0.42)), weight * slip, lost


def phasor(east, north, power: int, along_east, along_north, seed: int):
    """Phase (turns, 0..1) of blended waves, their strength 0..1, and the phase's gradient (turns per metre).

    `along` is in turns per lattice cell of 2^power m.
    """
    scale = 2.0**-power
    x, y = east * scale, north * scale
    column, row = np.floor(x), np.floor(y)
    fx, fy = x - column, y - row
    column, row = column.astype(np.int64), row.astype(np.int64)
    c, s = np.zeros(x.shape), np.zeros(x.shape)
    cx, cy, sx, sy = (np.zeros(x.shape) for _ in range(4))
    for j in (-1, 0, 1):
        for i in (-1, 0, 1):
            h = hash_lattice(column + i, row + j, seed + power + 200)
            dx = fx - (i + 0.5 + JITTER * ((h & 0xFF) / 255.0 - 0.5))
            dy = fy - (j + 0.5 + JITTER * ((h >> 8 & 0xFF) / 255.0 - 0.5))
            turn = SWAY * ((h >> 16 & 0xFF) / 127.5 - 1.0)
            ae, an = along_east - turn * along_north, along_north + turn * along_east
            near = np.maximum(1.0 - (dx * dx + dy * dy) / REACH**2, 0.0)
            weight, less = near * near * near, -6.0 / REACH**2 * near * near
            phase = (h >> 24) / 256.0 + dx * ae + dy * an
            cosine, sine = wave(phase + 0.25), wave(phase)
            c, s = c + weight * cosine, s + weight * sine
            cx, cy = cx + less * dx * cosine, cy + less * dy * cosine
            sx, sy = sx + less * dx * sine, sy + less * dy * sine
            cx, cy = cx - TURN * weight * sine * ae, cy - TURN * weight * sine * an
            sx, sy = sx + TURN * weight * cosine * ae, sy + TURN * weight * cosine * an
    square = c * c + s * s
    gx, gy = (c * sx - s * cx) / (square + 1e-3), (c * sy - s * cy) / (square + 1e-3)
    strength = np.sqrt(square / (square + 0.05))
    return angle(c, s), strength, np.sqrt(gx * gx + gy * gy) * scale / TURN


TURN = 2.0 * np.pi


def angle(c, s):
    """Angle of a vector in turns, 0..1, within 0.0007: the same on every machine."""
    a, b = np.abs(c), np.abs(s)
    low, high = np.minimum(a, b), np.maximum(a, b)
    t = low / np.maximum(high, 1e-9)
    eighth = t * (0.125 + 0.04345 * (1.0 - t))
    quarter = np.where(b > a, 0.25 - eighth, eighth)
    half = np.where(c < 0.0, 0.5 - quarter, quarter)
    return np.where(s < 0.0, 1.0 - half, half)
