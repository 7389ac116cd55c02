"""Where gorges run: float64 twin of ``canyons_network.wesl``.

Three families, each a coordinate that warps across the land, cut into strips: a gorge runs along the middle
of every strip. The river's gorges run about eastward. Their banks, from the middle line to the divide, are
strips of their own for the side canyons, which climb upstream towards the divide and end in a headwall; and
the banks of those for slots.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...noise.scatter import hash_lattice
from ..octaves import octave
from .canyons_graded import Graded, away, ramp, size

LEAST_SLOPE = 0.45  # of a family's coordinate: where it is flatter, gorges grow wide


@dataclass(frozen=True)
class Gorges:
    """Distances from middle lines (m, graded) and what is known of each gorge.

    Attributes
    ----------
    line : m north of the middle line of the river's gorge
    main, side, slot : m from the middle line of the nearest of each family
    side_end, slot_end : m before the headwall, negative beyond it
    side_width, slot_width : 0…1, its own share between narrow and wide
    side_share, slot_share : 0…1 of the way from mouth to head
    side_there, slot_there : 1 where the strip has one at all, else 0
    rooted : 1 where slots may be, 0 near the head of their side canyon
    divide : 1 up to near the divide between two rivers, 0 on it
    """

    line: Graded
    main: Graded
    side: Graded
    slot: Graded
    side_end: Graded
    slot_end: Graded
    side_width: np.ndarray
    slot_width: np.ndarray
    side_share: Graded
    slot_share: Graded
    side_there: np.ndarray
    slot_there: np.ndarray
    rooted: Graded
    divide: Graded


def waves(east: Graded, north: Graded, power: int, seed: int) -> Graded:
    """Noise of wavelength 2^power m at a graded place."""
    v, a, b = octave(east.value, north.value, power, seed)
    return Graded(v, a * east.east + b * north.east, a * east.north + b * north.north)


def gorges(east: np.ndarray, north: np.ndarray, power: int, seed: int) -> Gorges:
    """The network at places (m); ``power``: the river's gorges lie 2^power m apart."""
    span = 2.0**power
    one = np.ones_like(east)
    e, n = Graded(east, one, 0.0 * one), Graded(north, 0.0 * one, one)
    # windings
    we = 0.40 * span / 2 * waves(e, n, power - 1, seed + 1) + 0.34 * span / 4 * waves(
        e, n, power - 2, seed + 2
    )
    wn = 0.40 * span / 2 * waves(e, n, power - 1, seed + 3) + 0.34 * span / 4 * waves(
        e, n, power - 2, seed + 4
    )
    e, n = e + we, n + wn
    across = (
        n
        + 0.30 * 4 * span * waves(e, n, power + 2, seed + 11)
        + 0.34 * 2 * span * waves(e, n, power + 1, seed + 5)
    )
    across = across + 0.40 * span * waves(e, n, power, seed + 6)
    strip = np.floor(across.value / span + 0.5)
    across = across - strip * span
    line = away(across, LEAST_SLOPE)
    main = size(line)
    bank = 2.0 * strip + np.where(across.value < 0.0, 0.0, 1.0)

    # side canyons join pointing downstream, which is west
    out = size(across)
    spacing = span / 4
    moved = e + bank * (37.0 * 4096.0)  # each bank has its own
    along = e - 0.55 * out + 0.45 * span / 4 * waves(moved, n, power - 2, seed + 7)
    cell = np.floor(along.value / spacing + 0.5)
    r0, r1, r2, r3 = draws(cell, bank, seed + 8)
    along = along - (cell + 0.3 * (r2 - 0.5)) * spacing
    length = span * (0.16 + 0.28 * r1)
    side = away(size(along), LEAST_SLOPE)
    share = out * (1.0 / length)
    end = away(length - out, LEAST_SLOPE)

    # slots
    bank2 = 2.0 * cell + np.where(along.value < 0.0, 0.0, 1.0)
    away_side = size(along)
    spacing2 = span / 8
    climb = out - 0.4 * away_side + 0.35 * span / 8 * waves(moved, n, power - 3, seed + 9)
    cell2 = np.floor(climb.value / spacing2 + 0.5)
    s0, s1, s2, s3 = draws(cell2 + 64.0 * bank, bank2, seed + 10)
    climb = climb - (cell2 + 0.4 * (s2 - 0.5)) * spacing2
    length2 = spacing * (0.14 + 0.18 * s1)
    slot = away(size(climb), LEAST_SLOPE)
    # none where its canyon is near its own head
    rooted = ramp(end, 0.03 * span, 0.07 * span)
    return Gorges(
        line,
        main,
        side,
        slot,
        end,
        away(length2 - away_side, LEAST_SLOPE),
        r3,
        s3,
        share,
        away_side * (1.0 / length2),
        np.where(r0 < 0.85, 1.0, 0.0),
        np.where((s0 < 0.7) & (r0 < 0.85), 1.0, 0.0),
        rooted,
        1.0 - ramp(out, 0.36 * span, 0.47 * span),
    )


def draws(x, y, seed: int):
    """Four numbers 0…1 of a cell, in steps of 1/255."""
    h = hash_lattice(np.asarray(x).astype(np.int64), np.asarray(y).astype(np.int64), seed)
    return tuple(((h >> np.uint32(8 * k)) & np.uint32(255)) / 255.0 for k in range(4))
