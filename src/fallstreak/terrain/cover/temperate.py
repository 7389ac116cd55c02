"""Eastern woodland in October, on the CPU: float64 twin of ``temperate.wesl``."""

from __future__ import annotations

import numpy as np

from ..octaves import wide
from ..pattern import cells, faded, missing, random, smoothstep, speckle, threshold
from .cover import Covers, Sites

PALETTE = ("grass", "forest_floor", "canopy", "soil", "sandstone", "scree")

FOREST, TURN = np.array([0.041, 0.050, 0.017]), np.array([0.066, 0.014, -0.003])
LITTER, ROCK = np.array([0.092, 0.068, 0.036]), np.array([0.150, 0.134, 0.112])
FIELD, BANK = np.array([0.0944, 0.0902, 0.0427]), np.array([0.088, 0.072, 0.050])
GRASS, HAY = np.array([0.076, 0.088, 0.034]), np.array([0.105, 0.095, 0.045])
STUBBLE, PLOUGHED = np.array([0.125, 0.100, 0.060]), np.array([0.085, 0.062, 0.040])
TILLED, HEDGES, SWATH = 0.21, 0.10, 9.0


def cover(site: Sites) -> Covers:
    """What covers places."""
    east, north, step, seed = site.east, site.north, np.asarray(site.step, float), site.seed
    region = wide(east, north, 14, seed + 318)[0]
    large = 0.7 * (speckle(east, north, 12, step, seed + 319) + speckle(east, north, 11, step, seed + 301))
    middle = 0.6 * speckle(east, north, 10, step, seed + 320) + 0.8 * speckle(
        east, north, 9, step, seed + 302
    )
    small = speckle(east, north, 6, step, seed + 303)
    groves = speckle(east, north, 5, step, seed + 316)
    clumps = faded(east, north, 4, step, seed + 314)
    tufts = speckle(east, north, 3, step, seed + 317)
    twigs = faded(east, north, 1, step, seed + 311)

    gentle = 4.0 * (0.16 - site.slope) - 0.35 * np.maximum(site.relief, 0.0)
    drained = 0.40 - 0.5 * smoothstep(0.3, 0.8, site.hollow)
    open_ = np.clip(drained + gentle + 0.5 * region + 0.65 * large + 0.5 * middle, 0.0, 1.0)
    parcel = cells(
        east + 24.0 * small + 12.0 * clumps[1] + 1.5 * twigs[1],
        north + 24.0 * middle + 12.0 * clumps[2] + 1.5 * twigs[2],
        8,
        0.85,
        seed + 306,
    )
    seen = np.where(open_ > 0.1, np.clip(2.0 - step / 40.0, 0.0, 1.0), 0.0)
    field = _mix(np.clip((open_ - 0.12) / 0.76, 0, 1), open_ > 0.12 + 0.76 * random(parcel.hash, 5), seen)
    kind = np.searchsorted([0.45, 0.72, 0.92], random(parcel.hash, 3), side="right")
    own = np.stack([GRASS, HAY, STUBBLE, PLOUGHED])[kind]
    inside = smoothstep(0.004, 0.02, parcel.border)
    shade = (0.8 + 0.4 * random(parcel.hash, 4))[..., None]
    crop = _mix(FIELD, _mix(FIELD, own * shade, inside[..., None]), seen[..., None])
    tilled = _mix(TILLED, np.array([0.0, 0.1, 0.5, 1.0])[kind] * inside, seen)
    lined = 1.0 - smoothstep(0.02, 0.05, parcel.border + 0.12 * small)
    hedge = _mix(HEDGES, lined, np.where(seen > 0.0, np.clip(2.0 - step / 8.0, 0.0, 1.0), 0.0))
    angle = 2.0 * np.pi * random(parcel.hash, 6)
    along = (parcel.centre[0] * np.cos(angle) + parcel.centre[1] * np.sin(angle)) * (256.0 / SWATH)
    carried = np.where(seen > 0.0, np.clip(2.0 - 4.0 * step / SWATH, 0.0, 1.0), 0.0)
    swath = np.sin(2.0 * np.pi * along) * inside * carried * np.where(kind > 0, 1.0, 0.25)
    mottle = 0.35 * small + 0.25 * middle + 0.14 * (clumps[0] + tufts) + 0.2 * twigs[0] + 0.08 * swath
    crop = crop * (1.0 + mottle)[..., None]
    tilled = np.clip(tilled * (1.0 + 0.8 * (tufts + twigs[0])), 0.0, 1.0)

    lost_middle = 0.36 * missing(10, step) + 0.64 * missing(9, step)
    bumps = 0.1225 * missing(6, step) + 0.09 * lost_middle
    rock = threshold(site.slope + 0.35 * small + 0.3 * middle, 0.86, 0.12, bumps)
    rubble = 0.81 * lost_middle + 0.36 * missing(6, step)
    broken = threshold(site.slope - 0.9 * middle + 0.6 * small, 0.92, 0.25, rubble)
    shore = smoothstep(-1.4, -0.4, site.water)

    turned = 0.30 + 0.07 * site.relief - 0.14 * site.hollow + 0.5 * region
    season = np.clip(turned + 0.35 * large + 0.3 * middle + 0.35 * small, 0.0, 1.0)
    mottle = 1.0 + 0.5 * (clumps[0] + groves) + 0.35 * small
    forest = np.maximum((FOREST + TURN * season[..., None]) * mottle[..., None], 0.008)

    trees = _mix(1.0, hedge, field) * (1.0 - shore)
    soft = 1.0 - rock
    bank = _mix(crop, BANK, shore[..., None])
    barren = _mix(tilled, 0.8, shore)
    litter = 0.25 * np.clip(2.0 * clumps[0] + 1.5 * small, 0.0, 1.0)
    grown = soft * trees * (1.0 - litter)
    grass, soil = soft * (1.0 - trees) * (1.0 - barren), soft * (1.0 - trees) * barren
    shares = (grass, soft * trees * litter, grown, soil, rock * broken, rock * (1.0 - broken))
    rocky = ROCK * (1.0 + 0.5 * small + 0.3 * twigs[0])[..., None]
    woods = _mix(forest, LITTER, 0.3 * litter[..., None])
    tint = _mix(_mix(bank, woods, trees[..., None]), rocky, rock[..., None])
    wetness = np.maximum(0.3 * np.maximum(site.hollow, 0.0) * soft, shore)
    return Covers(np.stack(np.broadcast_arrays(*shares), -1), tint, wetness, grown)


def _mix(a, b, t):
    return a + (b - a) * t
