"""Plateaus cut by gorges: float64 twin of ``canyons.wesl``.

First the mean slope of everything, with its gradient: three families of gorges (canyons_network.py), each
a trench whose walls are steep and whose foot is talus. Where that is steep it is a wall: there each layer of
rock (canyons_strata.py) moves height up into cliffs, and samples out along the map until those stand upright
and lean over. Long steps widen the trenches and lower them, so that the mean height is the same for all.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ..octaves import octave_weight
from ..pattern import smoothstep
from .canyons_graded import Graded, away, blend, edge, least, ramp, rounded_size
from .canyons_network import gorges, waves
from .canyons_strata import BED, FALL, LAYER, border, folds, hardness, rim_of, terrace, thickening
from .shape import LandShape

TALUS = 0.2  # share of the depth
WALL = 0.175  # half the width of a wall on the map, over the relief
MEAN_MAIN, MEAN_SIDE = 0.081, 0.031  # mean depth of the river's gorges, of side canyons, over the relief
REACH = 58.0  # m, of shifts
SPREAD = 0.35  # of a step, by which slopes are wider so that samples can carry them
FIN = 36.0  # m, how rounded crests between gorges are
GLOW = 0.3  # of what hides the sky, as bright as it
LEAST_RELIEF = 120.0  # m, more than layers fold: rivers stay below
BANK = 4.0  # m, of the gorge's floor above the river
JOINTS = ((20.0, 6, 47, 0.02), (7.0, 5, 48, 0.02), (2.2, 4, 45, 0.03), (1.2, 3, 46, 0.03))
"""Of cliffs: m, power of the wavelength, number of the noise, how rounded."""


class Canyons:
    """See `world.terrain` for the meaning of the parameters.

    Attributes
    ----------
    native : m, the step from which on only materials add detail
    outside : m, height of the globe beyond the map
    shift_bound : m, the largest shift of a sample from its place on the map
    """

    native = 1.0
    shift_bound = REACH + 1.0

    def __init__(self, land: Any, seed: int):
        self.base, self.relief = land.base_height, max(land.relief, LEAST_RELIEF)
        self.roughness, self.seed = land.roughness, seed
        self.power = int(np.clip(np.round(np.log2(land.feature_size)), 10, 14))
        self.outside = self.base
        self.rim = rim_of(self.base)
        self.top, above = (float(border(np.array(self.rim + i), LAYER, seed + 40)) for i in (0.0, 1.0))
        self.mesa = above - self.top

    def bounds(self) -> tuple[float, float]:
        """Lowest and highest height anywhere, m."""
        # of what leans over 160 km, folds and rolls by noise that is at most 0.77
        lean, rolling = 160e3 * FALL, 0.77 * (60.0 + 20.0 + 26.0 + 12.0 + 6.0)
        return self.top - self.relief - lean - 10.0, self.top + self.mesa + lean + rolling + 10.0

    def shape(self, east: np.ndarray, north: np.ndarray, step: np.ndarray | float) -> LandShape:
        """The land at places (m) as a mesh with `step` metres between vertices can carry it."""
        east, north, step = np.broadcast_arrays(*(np.asarray(x, np.float64) for x in (east, north, step)))
        seed, relief, span = self.seed, self.relief, 2.0**self.power
        one, zero = np.ones_like(east), np.zeros_like(east)
        e, n = Graded(east, one, zero), Graded(north, zero, one)

        def noise(power, number):
            return waves(e, n, power, seed + number) * octave_weight(power, step)

        lean = folds(e, n, seed)
        bedding = lean + self.top
        river = FALL * e + (self.top - relief)
        g = gorges(east, north, self.power, seed)

        # alcoves and spurs of the walls
        wave8, wave7 = noise(8, 30), noise(7, 31)
        # of the small ones not the slopes: on their way out from the wall neighbours shall stay side by side
        wave6, wave5 = (Graded(noise(*which).value, zero, zero) for which in ((6, 32), (5, 33)))
        bays = 40.0 * wave8 + 26.0 * wave7 + 10.0 * wave6 + 4.0 * wave5
        fans = 40.0 * wave7 - 26.0 * wave6
        place = waves(e, n, 12, seed + 34)

        # the plateau: domes of bare rock, shallow washes that lead to the heads of gorges
        domes = (
            26.0 * rounded_size(noise(8, 35), 0.04)
            + 12.0 * rounded_size(noise(7, 36), 0.04)
            + 6.0 * rounded_size(noise(6, 37), 0.05)
        )
        bare = ramp(noise(10, 38) + 0.5 * place, -0.25, 0.35)
        plateau = bedding + domes * bare + 20.0 * noise(10, 38) - 6.0
        # on it mesas, one layer high
        mesa = away(0.6 * place + noise(10, 38) + 0.3 * wave8 - 0.36, 6e-4) + 0.5 * bays
        plateau = plateau + edge(mesa, 22.0) * self.mesa
        wash = (1.0 - ramp(g.side, 0.0, 90.0)) * g.divide * g.side_there
        plateau = plateau - 10.0 * wash

        # the river's gorge, in places a wide valley with buttes
        width = 0.42 * relief * (0.95 + 0.6 * place.value)
        wide = ramp(waves(e, n, 13, seed + 39) + 0.3 * place, 0.26, 0.52).value
        width = width + 1.3 * relief * wide
        wall = g.main + bays
        fade = np.clip(2.0 - 8.0 * step / span, 0.0, 1.0)
        cut, foot = self._cut(wall, g.main + fans, width, step)
        butte = away(noise(9, 43) + 0.5 * wave8 - 0.22, 4e-4)
        kept = edge(butte, 0.16 * relief) * ramp(width - wall, 0.35 * relief, 0.8 * relief)
        kept = kept * ramp(g.main, 60.0, 140.0)
        cut = cut - cut * kept
        terraces = 14.0 * ramp(g.main, 40.0, 500.0)
        y = blend(plateau, river + BANK + terraces, cut * fade)
        open_ = _sky(wall.value, width, plateau.value - y.value)

        # side canyons
        mouth = ramp(g.main, 0.0, 0.2 * relief)
        width = relief * (0.20 + 0.16 * g.side_width) * (1.0 - 0.45 * np.clip(g.side_share.value, 0.0, 1.0))
        fade2 = np.clip(2.0 - 16.0 * step / span, 0.0, 1.0)
        cut, _ = self._cut(g.side + bays, g.side + fans, width, step)
        cut = cut * ramp(g.side_end + 0.7 * bays, -50.0, 50.0) * mouth * g.side_there * fade2
        floor = blend(river + (BANK + 1.0), plateau, 0.04 + 0.5 * ramp(g.side_share, -0.2, 1.2))
        y2 = blend(plateau + FIN, floor, cut)
        open_ = np.minimum(open_, _sky(g.side.value + bays.value, width, plateau.value - y2.value))
        united = _agreement(y, y2)
        y = least(y, y2, FIN)

        # slots
        width = relief * (0.10 + 0.08 * g.slot_width) * (1.0 - 0.3 * np.clip(g.slot_share.value, 0.0, 1.0))
        fade3 = np.clip(2.0 - 32.0 * step / span, 0.0, 1.0)
        cut, _ = self._cut(g.slot + 0.6 * bays, g.slot + fans, width, step)
        cut = (
            cut
            * ramp(g.slot_end + 0.5 * bays, -40.0, 40.0)
            * mouth
            * ramp(g.side, 0.0, 60.0)
            * g.rooted
            * g.slot_there
        )
        floor = blend(floor, plateau, 0.05 + 0.6 * ramp(g.slot_share, -0.2, 1.2))
        y3 = blend(plateau + FIN, floor, cut * fade3)
        open_ = np.minimum(open_, _sky(g.slot.value + 0.6 * bays.value, width, plateau.value - y3.value))
        united = united * _agreement(y, y3)
        y = least(y, y3, FIN)

        # what steps are too long for is taken from everywhere alike
        y = y - relief * (MEAN_MAIN * (1.0 - fade) + MEAN_SIDE * (1.0 - fade2))

        # walls: layers
        slope = y.slope
        along = y.value - lean.value + thickening(e, n, step, seed)
        layer = terrace(along, 0.02 + 1.1 * wave7.value, self.rim, seed + 40)
        steep = smoothstep(0.9, 1.7, slope)
        held = np.clip(2.0 - 2.0 * step * slope / layer.thick, 0.0, 1.0)
        height = y.value + steep * held * layer.rise
        # metres out from the wall: the layer, its beds, and joints and clefts that end where the layer does
        moved = e + layer.number * (5 * 4096.0)

        joints = sum(
            high
            * rounded_size(waves(moved, n, power, seed + number) * octave_weight(power, step), soft).value
            for high, power, number, soft in JOINTS
        )
        beds = hardness(along + steep * held * layer.rise, BED, seed + 42) * np.clip(
            2.0 - 11.0 * step * slope / BED, 0.0, 1.0
        )
        out = (
            steep
            * united
            * (3.6 * beds + held * (layer.firm * joints + 5.0 - layer.back / np.maximum(slope, 1.4)))
        )

        # what lies about: blocks on the talus, bars beside the river
        rubble = smoothstep(0.25, 0.5, slope) * (1.0 - steep)
        rough = 0.012 + 0.05 * rubble + 0.02 * steep
        bumps = zero
        for power in range(5, -1, -1):
            bumps = bumps + 2.0**power * noise(power, 50).value
        height = height + rough * (0.5 + self.roughness) * bumps

        # the river's bed; no slope under a cliff reaches below it
        height = np.maximum(height, np.minimum(y.value, river.value + BANK))
        room = np.clip(foot - 14.0, 0.0, 80.0)
        winding = room * np.clip(3.0 * waves(e, n, 9, seed + 44).value, -1.0, 1.0)
        channel = np.abs(g.line.value + winding + 12.0 * wave6.value + 8.0 * wave5.value)
        bed = np.maximum(9.0 + 7.0 * place.value + 9.0 * wave7.value, np.maximum(5.0, 0.8 * step))
        bank = river.value - 2.5 + (BANK + 2.5) * smoothstep(0.5 * bed, 2.7 * bed, channel)
        bank = bank + 2.0 * np.maximum(channel - 2.7 * bed, 0.0)
        flows = np.clip(2.0 - step / 24.0, 0.0, 1.0)
        height = height + flows * np.minimum(bank - height, 0.0)

        spread = np.hypot(WALL * relief, SPREAD * step) / (WALL * relief)
        # domes are some 0.1 steep, of each octave about the same
        gone = 3.0 - sum(octave_weight(power, step) for power in (8, 7, 6))
        lost = slope**2 * (spread - 1.0) + (2.0 * steep * (1.0 - held)) ** 2 + (0.11 * bare.value) ** 2 * gone
        lost = np.sqrt(lost)
        over = np.clip(out, -REACH, REACH) / np.maximum(slope, 1e-3)
        sky = open_ * (1.0 - 0.4 * steep * held * layer.under)
        # walls in the sun shine on those opposite about as bright as the sky would
        return LandShape(
            height, zero + river.value, -over * y.east, -over * y.north, lost, sky + GLOW * (1.0 - sky)
        )

    def _cut(self, wall: Graded, foot: Graded, width, step):
        """Share of the depth cut away at distances from the middle line; half the floor's width (m)."""
        half = np.minimum(WALL * self.relief, 0.42 * width)
        talus = np.minimum(TALUS / 1.2 * self.relief, 0.34 * width)
        at = width - half - 0.3 * talus
        cliff, slope = (
            _trench(*which)
            for which in (
                (wall, width, np.hypot(half, SPREAD * step)),
                (foot, at, np.hypot(talus, SPREAD * step)),
            )
        )
        return (1.0 - TALUS) * cliff + TALUS * slope, at - talus


def _agreement(a: Graded, b: Graded):
    """1 where one of two gorges makes the slope or both lean one way, 0 on the crest between them.

    What leans away from one would run through the other.
    """
    share = np.clip(0.5 + (b.value - a.value) / (6.0 * FIN), 0.0, 1.0)
    both = (a * share + b * (1.0 - share)).slope / np.maximum(a.slope * share + b.slope * (1.0 - share), 0.02)
    return np.minimum(both * both, 1.0)


def _trench(d: Graded, width, half) -> Graded:
    """A trench of a width on either side, convolved with a smooth kernel: its section keeps its area."""
    return edge(width - d, half) + edge(d + width, half) - 1.0


def _sky(d, width, below):
    """Share of the sky over a place in a trench, weighted by the cosine: half the sines of its two angles."""
    below = np.maximum(below, 0.0)
    d = np.abs(d)
    near, far = np.maximum(width - d, 0.0) + 0.1 * below + 1.0, width + d
    return 0.5 * (near / np.hypot(near, below) + far / np.hypot(far, below))
