"""The base materials: how large a tile of each is, and what it looks like from far.

Albedos are linear Rec. 709 of dry surfaces, after field spectra: rocks, soils and sands of the USGS and
ECOSTRESS libraries, grass and canopies as seen from above with the shade between their leaves, Martian dust
after Bell et al. (2004).
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Material:
    """A base material.

    Attributes
    ----------
    layer : int
        Of the texture arrays.
    tile : float
        m, width of the picture that repeats; a power of two, so that the ground's origin of coordinates (a
        multiple of 4096 m) lies on the corner of a tile.
    albedo : (3,) floats
        Mean, linear Rec. 709.
    roughness : float
        Perceptual.
    relief : float
        m from the lowest to the highest point of a tile.
    steepest : float
        Rise over run that the texture's slopes can hold: their codes run from −steepest to +steepest.
    grows : float
        0 mineral … 1 plants: how much light goes through what stands there, and how little wetness shows.
    """

    layer: int
    tile: float
    albedo: tuple[float, float, float]
    roughness: float
    relief: float
    steepest: float
    grows: float = 0.0


def _library(**rows: tuple) -> dict[str, Material]:
    return {name: Material(layer, *row) for layer, (name, row) in enumerate(rows.items())}


MATERIALS = _library(
    sandstone=(8.0, (0.300, 0.200, 0.130), 0.85, 0.28, 2.0),
    limestone=(8.0, (0.330, 0.300, 0.250), 0.80, 0.28, 1.5),
    granite=(8.0, (0.240, 0.225, 0.210), 0.75, 0.40, 1.5),
    scree=(4.0, (0.200, 0.190, 0.175), 0.85, 0.30, 2.5),
    gravel=(2.0, (0.190, 0.175, 0.150), 0.85, 0.06, 2.5),
    sand=(4.0, (0.360, 0.280, 0.190), 0.90, 0.02, 0.6),
    soil=(2.0, (0.110, 0.078, 0.050), 0.95, 0.07, 2.0),
    grass=(2.0, (0.075, 0.088, 0.034), 0.93, 0.025, 1.0, 0.15),
    turf=(2.0, (0.085, 0.085, 0.040), 0.94, 0.022, 1.0, 0.15),
    forest_floor=(2.0, (0.075, 0.055, 0.032), 0.98, 0.06, 2.0, 0.3),
    canopy=(64.0, (0.045, 0.052, 0.020), 0.97, 7.0, 2.5, 1.0),
    shrubs=(16.0, (0.085, 0.080, 0.045), 0.96, 0.9, 2.0, 0.8),
    dust=(4.0, (0.330, 0.178, 0.086), 0.95, 0.05, 1.0),
    basalt=(8.0, (0.090, 0.070, 0.058), 0.80, 0.50, 2.0),
    mud=(2.0, (0.130, 0.100, 0.070), 0.85, 0.03, 1.5),
)
"""Name → material, in the order of the layers."""

SIDE = 512
"""Texels along a tile."""
