"""Land made from noise and the seed: ranges, valleys and plains; on dry worlds craters and dunes too.

A hybrid multifractal (Musgrave in Ebert et al., "Texturing & Modeling", ch. 16): an octave is as strong as
what lies under it is high, so that valleys fill smooth and summits stay jagged; ridged noise makes the
crests, a warp of the coordinates takes the noise's straightness away. Octaves finer than the sampling are
left out. Craters follow the proportions of Melosh 1989, "Impact cratering": depth 0.2 of the diameter for
small, flat-floored ones from 7 km on; rims 0.04; sizes by a power law of cumulative slope −2.
"""

from __future__ import annotations

import numpy as np

from ..noise.patterns import value as noise_at


class FractalLand:
    """See `world.terrain` for the meaning of the parameters (m, seed int); ``dry`` adds craters and dunes."""

    def __init__(
        self,
        base_height: float,
        relief: float,
        feature_size: float,
        roughness: float,
        octaves: int,
        *,
        exaggeration: float = 1.0,
        seed: int = 0,
        extent: float = 160e3,
        dry: bool = False,
    ):
        self.base, self.relief, self.feature = base_height, relief, feature_size
        self.gain = 0.38 + 0.22 * roughness
        self.octaves, self.exaggeration, self.seed = octaves, exaggeration, seed
        self.dry, self.extent = dry, extent
        self.native = 150.0
        self.outside = base_height * exaggeration
        craters = _craters(seed, extent) if dry else np.zeros((0, 4))
        # the ground that each one hits, as a coarse eye sees it
        ground = self._hills(craters[:, 0], craters[:, 1], self.feature / 8.0)[0]
        self._craters = np.concatenate([craters, ground[:, None]], 1)

    def prepare(self, spacing: float, reach: float) -> None:
        """Noise needs no preparation."""

    def sample(self, east: np.ndarray, north: np.ndarray) -> np.ndarray:
        """Heights (m) on the grid of two ascending, evenly spaced axes, (len(north), len(east)) float64."""
        spacing = float(east[1] - east[0])
        e, n = np.meshgrid(east, north)
        height, mountains = self._hills(e, n, spacing)
        if self.dry:
            height += self._dunes(e, n, spacing, mountains)
            height = self._add_craters(height, east, north, spacing)
        return (self.base + height) * self.exaggeration

    def _hills(self, east, north, spacing):
        """Height above the base (m) and how mountainous it is (0..1), at any places."""
        e, n = east / self.feature, north / self.feature
        warp_e = noise_at(0.7 * e, 0.7 * n, self.seed + 901)
        warp_n = noise_at(0.7 * e, 0.7 * n, self.seed + 902)
        e, n = e + 0.9 * warp_e, n + 0.9 * warp_n
        # where the ranges are: 0 plains, 1 mountains
        region = noise_at(0.22 * e, 0.22 * n, self.seed + 903)
        region += 0.5 * noise_at(0.5 * e, 0.5 * n, self.seed + 904)
        mountains = _smoothstep(region, -0.25, 0.4)
        total, weight, amplitude, norm = np.zeros(e.shape), np.ones(e.shape), 1.0, 0.0
        for octave in range(self.octaves):
            scale = 2.0**octave
            if self.feature / scale < 2.0 * spacing:
                break
            noise = noise_at(e * scale, n * scale, self.seed + octave)
            signal = 0.5 + noise if self.dry else (1.0 - np.minimum(np.abs(2.4 * noise), 1.0)) ** 2
            total += amplitude * weight * signal
            norm += amplitude
            weight = np.clip(weight * signal * 1.9 if octave else 0.25 + signal, 0.0, 1.0)
            amplitude *= self.gain
        total /= max(norm, 1e-9)
        shape = 1.25 * (total - 0.25) * (0.12 + 0.88 * mountains) + 0.25 * (mountains - 0.4)
        return self.relief * shape, mountains

    def _dunes(self, east, north, spacing, mountains):
        """Transverse dunes on the plains, 700 m apart: gentle to the west wind, steep in the lee."""
        if spacing > 250.0:
            return 0.0
        bend = 500.0 * noise_at(east / 3000.0, north / 3000.0, self.seed + 910)
        wobble = noise_at(east / 900.0, north / 900.0, self.seed + 911)
        phase = (east + 0.35 * north + bend) / 700.0 + 0.35 * wobble
        f = phase - np.floor(phase)
        shape = np.where(f < 0.7, _smoothstep(f, 0.0, 0.7), _smoothstep(1.0 - f, 0.0, 0.3))
        field = _smoothstep(noise_at(east / 15e3, north / 15e3, self.seed + 912), 0.0, 0.3)
        return 28.0 * shape * field * (1.0 - mountains)

    def _add_craters(self, height, east, north, spacing):
        # A crater lies in the mean of what it hit, not in every hill: it takes the hills away as it comes.
        hills, remaining, out = height, np.ones(height.shape), height.copy()
        x, y, diameter = self._craters[:, :3].T
        near = (diameter >= 3.0 * spacing) & (np.abs(x - east.mean()) < 1.25 * diameter + 0.5 * np.ptp(east))
        near &= np.abs(y - north.mean()) < 1.25 * diameter + 0.5 * np.ptp(north)
        for x, y, diameter, freshness, ground in self._craters[near]:
            reach = 1.25 * diameter
            j0, j1 = np.searchsorted(east, (x - reach, x + reach))
            i0, i1 = np.searchsorted(north, (y - reach, y + reach))
            if j0 == j1 or i0 == i1:
                continue
            window = slice(i0, i1), slice(j0, j1)
            r = np.hypot(east[None, j0:j1] - x, north[i0:i1, None] - y) / (0.5 * diameter)
            depth = 0.16 * diameter if diameter < 7e3 else 0.16 * 7e3 * (diameter / 7e3) ** 0.3
            depth *= freshness
            rim = 0.25 * depth
            bowl = (depth + rim) * np.minimum(r * r, 1.0) - depth
            if diameter > 7e3:
                bowl = np.maximum(bowl, -0.75 * depth)
            outer = rim * np.maximum(r, 1.0) ** -3 * _smoothstep(2.5 - r, 0.0, 1.0)
            flat = _smoothstep(1.2 - r, 0.0, 0.5) * 0.7 * remaining[window]
            out[window] += flat * (ground - hills[window]) + np.where(r < 1.0, bowl, outer)
            remaining[window] -= flat
        return out


def _craters(seed: int, extent: float) -> np.ndarray:
    """(count, 4): east, north, diameter in m, freshness 0.25..1 (wind fills them).

    Largest first, so that the young small ones lie on the old.
    """
    rng = np.random.default_rng([seed & 0xFFFFFFFF, 77])
    count = int(min(4000, 2600 * (extent / 160e3) ** 2 + 40))
    diameter = 450.0 * rng.uniform(2e-4, 1.0, count) ** -0.5
    near = rng.uniform(size=count) < 0.6
    span = np.where(near, 0.16, 0.85) * extent
    position = rng.uniform(-1.0, 1.0, (count, 2)) * span[:, None]
    order = np.argsort(-diameter)
    freshness = 0.25 + 0.75 * rng.uniform(size=count) ** 2
    return np.concatenate([position, diameter[:, None], freshness[:, None]], 1)[order]


def _smoothstep(x, low: float, high: float):
    t = np.clip((x - low) / (high - low), 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t)
