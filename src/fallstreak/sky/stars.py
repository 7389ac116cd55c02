"""The fixed stars: a table of the naked-eye sky, and what each sends above the air.

Hipparcos positions and magnitudes to V = 8 (data/LICENSES.md). No proper motion: the table is of J2000, and
the fastest bright stars stray by a tenth of a degree only after a century.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from importlib.resources import files

import numpy as np
from numpy.typing import NDArray

from .colour import star_temperature, temperature_colour
from .light import MAGNITUDE_ZERO_LUX


@dataclass(frozen=True)
class StarTable:
    """Stars, brightest first.

    Attributes
    ----------
    direction : (n, 3) float64
        Unit vectors, J2000 equatorial axes.
    magnitude : (n,) float64
        Visual, above the air.
    colour_index : (n,) float64
        B-V.
    """

    direction: NDArray[np.float64]
    magnitude: NDArray[np.float64]
    colour_index: NDArray[np.float64]

    def illuminance(self) -> NDArray[np.float64]:
        """Rec. 709 illuminance above the air, lux, shape (n, 3)."""
        lux = MAGNITUDE_ZERO_LUX * 10 ** (-0.4 * self.magnitude)
        return lux[:, None] * temperature_colour(star_temperature(self.colour_index))


@lru_cache(maxsize=1)
def _table() -> StarTable:
    with files("fallstreak.sky").joinpath("data/stars.npz").open("rb") as file, np.load(file) as data:
        ascension = data["ascension"].astype(np.float64)
        declination = data["declination"].astype(np.float64)
        magnitude, colour_index = data["magnitude"] / 100.0, data["colour_index"] / 1000.0
    flat = np.cos(declination)
    direction = np.stack([flat * np.cos(ascension), flat * np.sin(ascension), np.sin(declination)], axis=1)
    return StarTable(direction, magnitude, colour_index)


def stars(magnitude_limit: float = 6.5) -> StarTable:
    """The stars up to a visual magnitude, at most 8."""
    table = _table()
    count = int(np.searchsorted(table.magnitude, magnitude_limit, side="right"))
    return StarTable(table.direction[:count], table.magnitude[:count], table.colour_index[:count])


def star_records(magnitude_limit: float) -> NDArray[np.float32]:
    """What the shader reads, two vec4 a star: direction and nothing, illuminance and nothing."""
    table = stars(magnitude_limit)
    records = np.zeros((max(len(table.magnitude), 1), 8), np.float32)
    if len(table.magnitude):
        records[:, 0:3] = table.direction
        records[:, 4:7] = table.illuminance()
    return records
