"""Arêtes, couloirs and ledges of high mountains, on the CPU; float64 twin of ``ridges.wesl``.

Folded noise has sharp ridges and round hollows between them, as ice leaves them: arêtes and cirques (after
ridged noise, Musgrave et al. 1989). How far a place lies from an arête is known there, so couloirs, which
run down the fall line, end before it: on the crest the fall line turns round, and waves would leave ribs.
"""

from __future__ import annotations

import numpy as np

from ...noise.scatter import hash_lattice
from ..octaves import octave, octave_weight
from .erosion import ROUGH_SEED, ROUGH_SLOPE, STEEPEST, WAVES, Relief, carried, wave

CALM = 0.12  # strength of the blended waves where they are half gone: couloirs join or end there
BLUNT = 0.0015  # width of an arête, over the wavelength of its noise
BLUNT_STEPS = 0.2  # the same in steps of a mesh, so that no crest is a row of teeth
ROUND = 0.06  # half the sine below which a rib between couloirs is rounded
END = 0.1  # of their wavelength: couloirs end so far from a crest
BOTTOM = 0.3  # how much finer couloirs leave the bottom of the larger ones alone
GROOVE = 0.5  # how far an octave's couloirs decide what is crest
GULLY_SLOPE = 0.6  # rms slope of an octave of couloirs, over its depth times the slope of the ground
RIB, RIB_OVERTONE = 0.65, 0.25  # how steep cliffs are and how sharp their edges
LEAN = 0.6  # of the octave before, by which crests of noise are pushed off the lattice
FOLD, FOLD_LEVEL = 0.04, 0.23  # roundness of folded noise; its mean
SHEER, SHEER_TO = 0.7, 1.2  # how much rougher rock is by the square of its slope, and up to which square
DAMPING = 0.2  # of rock by the square of the slope that it lies on
COULOIR_SEED = 90


def fold(value: np.ndarray, blunt: np.ndarray | float):
    """Size of a noise with a rounded zero, and its derivative."""
    size = np.sqrt(value * value + blunt * blunt)
    return size, value / size


def bluntness(power: int, step: np.ndarray) -> np.ndarray:
    """How round the arêtes of noise 2^power m long are, in its own measure."""
    return BLUNT + BLUNT_STEPS * step * 2.0**-power


def combed(east, north, power: int, across_east, across_north, seed: int):
    """Waves 2^power / `WAVES` m long whose phase grows along `across`; cosine and sine of the phase.

    Like `erosion.stripes`, from the four nearest corners of a lattice instead of nine cells.
    """
    x, y = east * 2.0**-power, north * 2.0**-power
    column, row = np.floor(x), np.floor(y)
    fx, fy = x - column, y - row
    ae, an = WAVES * across_east, WAVES * across_north
    column, row = column.astype(np.int64), row.astype(np.int64)
    sx, sy = fx * fx * (3.0 - 2.0 * fx), fy * fy * (3.0 - 2.0 * fy)
    cosine, sine = np.zeros(x.shape), np.zeros(x.shape)
    for j in (0, 1):
        for i in (0, 1):
            h = hash_lattice(column + i, row + j, seed + power + COULOIR_SEED)
            weight = (sx if i else 1.0 - sx) * (sy if j else 1.0 - sy)
            phase = (h >> 16) / 65536.0 + (fx - i) * ae + (fy - j) * an
            cosine += weight * wave(phase + 0.25)
            sine += weight * wave(phase)
    scale = 1.0 / np.sqrt(cosine * cosine + sine * sine + CALM * CALM)
    return cosine * scale, sine * scale


def couloirs(
    relief: Relief,
    away,
    east,
    north,
    coarsest: int,
    finest: int,
    step,
    seed: int,
    depth,
    gain: float,
    soft: float,
) -> Relief:
    """Cut octaves of couloirs into flanks, lattice cells of 2^coarsest m down to 2^finest m.

    Parameters
    ----------
    away : array, m
        From the nearest arête.
    depth : array
        Slope of a couloir's sides over that of the flank; `gain` times as much for each finer octave.
    soft : float
        Rise over run of the ground where they are half as deep as in steep ground.
    """
    height, se, sn, lost = relief.height, relief.slope_east, relief.slope_north, relief.lost
    crest = relief.crest
    for power in range(coarsest, finest - 1, -1):
        weight = octave_weight(power, step)
        square = se * se + sn * sn
        inclined = square / (square + soft * soft)
        slope = depth * np.sqrt(square / (1.0 + square / STEEPEST**2)) * inclined
        left = GULLY_SLOPE * slope
        lost = lost + (1.0 - carried(power, step)) * left * left
        if np.any(weight > 0.0):
            scale = 1.0 / np.sqrt(square + 1e-6)
            ae, an = -sn * scale, se * scale
            cosine, sine = combed(east, north, power, ae, an, seed)
            half2 = np.maximum(0.5 - 0.5 * cosine, 0.0)
            half = np.sqrt(half2 + ROUND * ROUND)
            near = away / (END * 2.0**power)
            mask = weight * near * near / (1.0 + near * near)
            crest = crest + GROOVE * mask * (cosine - crest)
            height = height + mask * slope * (2.0**power / (2.0 * np.pi * WAVES)) * (1.273 - 2.0 * half)
            rise = -0.5 * sine / half * mask * slope
            se, sn = se + rise * ae, sn + rise * an
            # the rib between two couloirs is a crest too
            rib = 2.0**power / (np.pi * WAVES) * half / np.maximum(mask, 0.1)
            away = away * rib / (away + rib)
            bottom = half2 * half2
            away = away * (1.0 - BOTTOM * weight * bottom * bottom)
        depth = depth * gain
    return Relief(height, se, sn, crest, lost)


def ledges(relief: Relief, bed: float, shift, strength, step) -> Relief:
    """Steepen and flatten slopes in turn, as beds of hard and soft rock do.

    Parameters
    ----------
    bed : m, from one cliff up to the next
    shift : array
        Beds that a bed is higher here: how they dip and bend.
    strength : array, 0..1
    """
    square = relief.slope_east**2 + relief.slope_north**2
    told = np.clip(2.0 - 4.0 * step * np.sqrt(square + 0.01) / bed, 0.0, 1.0)
    turns = relief.height / bed + shift
    cosine, sine = wave(turns + 0.25), wave(turns)
    rib = RIB * strength
    gain = told * rib
    height = relief.height + gain * bed / (2.0 * np.pi) * sine * (1.0 + 2.0 * RIB_OVERTONE * cosine)
    rise = 1.0 + gain * (cosine + 2.0 * RIB_OVERTONE * (2.0 * cosine * cosine - 1.0))
    lost = relief.lost + (1.0 - told * told) * 0.6 * rib * rib * square
    return Relief(height, relief.slope_east * rise, relief.slope_north * rise, relief.crest, lost)


def crags(
    relief: Relief, east, north, coarsest: int, finest: int, step, seed: int, rough, sharp: float, gain: float
) -> Relief:
    """Add the noise of broken rock.

    An octave's height is `rough` times its wavelength, more on steep ground, whose face a rise in height
    turns less (`SHEER`), but not so that cliffs become needles (`DAMPING`). `sharp` (0..1) folds it into
    crests; each octave is `gain` times as rough as the last.
    """
    height, se, sn, lost = relief.height, relief.slope_east, relief.slope_north, relief.lost
    before = np.zeros(height.shape)
    rough = rough * (1.0 + SHEER * np.minimum(se * se + sn * sn + lost, SHEER_TO))
    own_slope = ROUGH_SLOPE**2 * ((1.0 - sharp) ** 2 + (1.6 * sharp) ** 2)
    for power in range(coarsest, finest - 1, -1):
        weight = octave_weight(power, step)
        part = rough * gain ** (coarsest - power) / (1.0 + DAMPING * (se * se + sn * sn))
        lost = lost + (1.0 - carried(power, step)) * own_slope * part * part
        if np.any(weight > 0.0):
            value, de, dn = octave(east, north, power, seed + ROUGH_SEED)
            size, bent = fold(value + LEAN * before, FOLD)
            scale = weight * part * 2.0**power
            height = height + scale * ((1.0 - sharp) * value + 1.6 * sharp * (FOLD_LEVEL - size))
            tilt = scale * (1.0 - sharp - 1.6 * sharp * bent)
            se, sn = se + tilt * de, sn + tilt * dn
            before = value
    return Relief(height, se, sn, relief.crest, lost)
