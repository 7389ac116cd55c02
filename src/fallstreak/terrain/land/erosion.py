"""Relief that running water leaves: gullies down the fall line, on the CPU; float64 twin of ``erosion.wesl``.

Water is not simulated: a place knows only itself, so that land stays endless and any part of it can be
asked for alone. Each lattice cell holds a wave that runs across the slope, so that its troughs run down it;
waves of neighbours are blended as phasors (after Tricard et al. 2019, "Procedural Phasor Noise"; used for
erosion by R. S. Johansen, "Phacelle"), which lets troughs join and fork. Octaves of half the size follow the
slope that the larger ones have made: small gullies run into large ones, as in a river's tree.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...noise.scatter import hash_lattice
from ..octaves import octave, octave_weight

WAVES = 0.8  # waves in a lattice cell
REACH = 1.2  # cells, how far a cell's wave is felt
JITTER = 0.6  # cells, width of the square that a cell's centre is drawn from
CALM = 0.2  # strength of the blended waves where they are half gone: troughs join or end there
ARETE = 0.0004  # square of the sine below which a sharp crest is rounded
NARROW = 0.005  # the same of the crest beside which finer gullies fade: the fall line turns round there
FLANK = 0.65  # how much finer gullies keep to the flanks of the larger ones
STEEPEST = 1.1  # rise over run that gullies grow to, as the ground gets steeper
LEVEL = 1.273  # with which sharp crests and round troughs have mean 0
WAVE_SEED, ROUGH_SEED = 30, 60
GULLY_SLOPE = 0.95  # rms slope of an octave of gullies, over that of its sides in the open
DAMPING = 0.4  # of noise by the square of the slope that it lies on
ROUGH_PEAK = 0.77  # of an octave of noise, over its amplitude
ROUGH_SLOPE = 1.02  # rms slope of an octave of noise, over its amplitude in wavelengths


@dataclass(frozen=True)
class Gullies:
    """How land is cut.

    Attributes
    ----------
    depth : slope of a gully's sides over that of the ground it is cut into
    gain : `depth` of the next finer octave over that of the last
    lift : rise over run that gullies are cut by even in flat ground, first octave
    lift_gain : the same of the next octave over that of the last
    soft : rise over run of the ground where the first octave's gullies are half as deep as in steep ground
    calm : the same for finer octaves
    sharpness : 0 waves … 1 round troughs between sharp crests
    """

    depth: float
    gain: float
    lift: float
    lift_gain: float
    soft: float
    calm: float
    sharpness: float


@dataclass
class Relief:
    """Land while it is being worked: arrays of one shape.

    Attributes
    ----------
    height : m
    slope_east, slope_north : rise over run
    crest : −1 in the bottom of valleys … 1 on crests; ground too flat for gullies follows it
    lost : mean square of the slope left out
    """

    height: np.ndarray
    slope_east: np.ndarray
    slope_north: np.ndarray
    crest: np.ndarray
    lost: np.ndarray


def wave(turns: np.ndarray) -> np.ndarray:
    """Sine of whole turns within 0.0011, by two parabolas: the same on every machine, which sines are not."""
    t = turns - np.floor(turns + 0.5)
    arc = 8.0 * t - 16.0 * t * np.abs(t)
    return arc * (0.775 + 0.225 * np.abs(arc))


def stripes(east, north, power: int, across_east, across_north, seed: int):
    """Waves 2^power / `WAVES` m long whose phase grows along `across`.

    Parameters
    ----------
    east, north : arrays, m
    power : int
        The lattice's cells are 2^power m wide.
    across_east, across_north : arrays
        Unit vector at each place, or shorter.
    seed : int

    Returns
    -------
    cosine, sine : arrays
        Of the blended phase; both small where waves of neighbouring cells cancel.
    """
    x, y = east * 2.0**-power, north * 2.0**-power
    column, row = np.floor(x), np.floor(y)
    fx, fy = x - column, y - row
    ae, an = WAVES * across_east, WAVES * across_north
    column, row = column.astype(np.int64), row.astype(np.int64)
    cosine, sine = np.zeros(x.shape), np.zeros(x.shape)
    for j in (-1, 0, 1):
        for i in (-1, 0, 1):
            h = hash_lattice(column + i, row + j, seed + power + WAVE_SEED)
            dx = fx - (i + 0.5 + JITTER * ((h & 0xFF) / 255.0 - 0.5))
            dy = fy - (j + 0.5 + JITTER * ((h >> 8 & 0xFF) / 255.0 - 0.5))
            near = np.maximum(1.0 - (dx * dx + dy * dy) / REACH**2, 0.0)
            weight = near * near * near
            phase = (h >> 16) / 65536.0 + dx * ae + dy * an
            cosine += weight * wave(phase + 0.25)
            sine += weight * wave(phase)
    scale = 1.0 / np.sqrt(cosine * cosine + sine * sine + CALM * CALM)
    return cosine * scale, sine * scale


def carried(power: int, step):
    """Share of an octave's mean square slope that differences over two steps still show."""
    weight = octave_weight(power, step)
    wave_numbers = 4.0 * np.asarray(step) * 2.0**-power
    return weight * weight / (1.0 + wave_numbers * wave_numbers)


def carve(
    relief: Relief, east, north, coarsest: int, finest: int, step, seed: int, gullies: Gullies, strength=1.0
) -> Relief:
    """Cut octaves of gullies into land, lattice cells of 2^coarsest m down to 2^finest m.

    `strength` (number or array) scales their depth. What `step` (m) cannot carry is left out and counted in
    `Relief.lost`.
    """
    height, se, sn = relief.height, relief.slope_east, relief.slope_north
    crest, lost = relief.crest, relief.lost
    keep = flank = 1.0
    depth, lift, soft = gullies.depth * strength, gullies.lift, gullies.soft
    for power in range(coarsest, finest - 1, -1):
        weight = octave_weight(power, step)
        square = se * se + sn * sn
        steep = np.sqrt(square / (1.0 + square / STEEPEST**2) + lift * lift)
        left = GULLY_SLOPE * depth * steep * square / (square + soft * soft)
        lost = lost + (1.0 - carried(power, step)) * left * left
        if np.any(weight > 0.0):
            turn = 1.0 / np.sqrt(square + 1e-6)
            ae, an = -sn * turn, se * turn
            cosine, sine = stripes(east, north, power, ae, an, seed)
            half2 = np.maximum(0.5 - 0.5 * cosine, 0.0)
            half = np.sqrt(half2 + ARETE)
            value = cosine + gullies.sharpness * (LEVEL - 2.0 * half - cosine)
            rise = -sine * (1.0 - gullies.sharpness + 0.5 * gullies.sharpness / half)
            mask = flank * square / (square + soft * soft)
            target = crest + mask * (value - crest)
            slope = weight * depth * steep
            height = height + slope * (2.0**power / (2.0 * np.pi * WAVES)) * target
            se, sn = se + slope * mask * rise * ae, sn + slope * mask * rise * an
            crest = crest + weight * (target - crest)
            narrow = 1.0 - weight * NARROW / (NARROW + half2)
            keep = keep * narrow * narrow
            flat = 1.0 - np.minimum(sine * sine, 1.0)
            flank = keep * (1.0 - weight * FLANK * flat * flat)
        depth, lift, soft = depth * gullies.gain, lift * gullies.lift_gain, gullies.calm
    return Relief(height, se, sn, crest, lost)


def roughen(relief: Relief, east, north, coarsest: int, finest: int, step, seed: int, rough) -> Relief:
    """Add noise that no water has shaped.

    An octave's height is `rough` (number or array) times its wavelength, the less the steeper the ground it
    comes to lie on (`DAMPING`), so that cliffs do not become needles.
    """
    height, se, sn, lost = relief.height, relief.slope_east, relief.slope_north, relief.lost
    for power in range(coarsest, finest - 1, -1):
        weight = octave_weight(power, step)
        part = rough / (1.0 + DAMPING * (se * se + sn * sn))
        lost = lost + (1.0 - carried(power, step)) * ROUGH_SLOPE**2 * part * part
        if np.any(weight > 0.0):
            value, de, dn = octave(east, north, power, seed + ROUGH_SEED)
            scale = weight * part * 2.0**power
            height, se, sn = height + scale * value, se + scale * de, sn + scale * dn
    return Relief(height, se, sn, relief.crest, lost)


def fill(land: Relief, floor: np.ndarray, width: float) -> tuple[Relief, np.ndarray]:
    """Fill valleys with what rivers leave.

    `floor` stacks its height and slopes; the edge is `width` m soft. Also returns 0 on the floor … 1 above.
    """
    above = (land.height - floor[0]) / width
    root = np.sqrt(above * above + 1.0)
    bare = 0.5 + 0.5 * above / root
    height = floor[0] + 0.5 * width * (above + root)
    east = floor[1] + bare * (land.slope_east - floor[1])
    north = floor[2] + bare * (land.slope_north - floor[2])
    return Relief(height, east, north, land.crest, land.lost * bare * bare), bare
