"""What the moon's near side looks like: seas and rayed craters as ellipses at their real places.

Positions and sizes: IAU Gazetteer of Planetary Nomenclature (selenographic degrees, east positive,
diameters in km). A sea is an ellipse or several; its shore is frayed by noise in moon_face.wesl.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

# Longitude, latitude, half-axes east-west and north-south (degrees on the sphere), darkness against the
# darkest sea.
SEAS = {
    "Imbrium": (-16.0, 34.0, 18.5, 16.5, 0.85),
    "Serenitatis": (18.0, 27.5, 11.0, 10.5, 0.85),
    "Tranquillitatis": (31.5, 8.5, 14.5, 11.0, 1.0),
    "Tranquillitatis, west": (22.0, 4.0, 6.5, 6.0, 0.95),
    "Crisium": (59.1, 17.0, 8.8, 6.9, 1.0),
    "Serenitatis to Tranquillitatis": (25.0, 18.0, 5.0, 5.5, 0.9),
    "Asperitatis": (31.5, -5.0, 4.5, 6.0, 0.8),
    "Fecunditatis": (51.3, -4.0, 9.5, 11.5, 0.85),
    "Fecunditatis, south": (51.0, -14.0, 5.0, 6.0, 0.8),
    "Nectaris": (34.6, -15.2, 5.6, 5.8, 0.85),
    "Vaporum": (3.6, 13.3, 4.2, 4.0, 0.9),
    "Sinus Medii": (1.7, 2.4, 5.5, 3.2, 0.75),
    "Sinus Aestuum": (-8.8, 11.5, 4.5, 4.0, 0.8),
    "Frigoris, east": (22.0, 56.0, 11.5, 3.6, 0.7),
    "Frigoris, west": (-18.0, 57.5, 15.0, 3.4, 0.7),
    "Lacus Somniorum": (30.0, 38.0, 6.0, 5.0, 0.55),
    "Insularum": (-30.0, 6.5, 9.5, 8.0, 0.8),
    "Cognitum": (-22.5, -10.0, 6.5, 5.5, 0.9),
    "Nubium": (-16.0, -20.5, 9.5, 9.5, 0.85),
    "Humorum": (-38.6, -24.0, 6.9, 7.0, 0.95),
    "Procellarum, north": (-53.0, 34.0, 12.0, 15.0, 0.9),
    "Procellarum, middle": (-55.0, 15.0, 13.5, 15.5, 0.95),
    "Procellarum, south": (-48.0, -3.0, 13.0, 10.0, 0.9),
    "Sinus Roris": (-50.0, 52.0, 7.5, 5.0, 0.75),
    "Humboldtianum": (81.5, 56.8, 4.0, 4.0, 0.7),
    "Marginis": (86.0, 13.0, 5.0, 6.5, 0.65),
    "Smythii": (87.0, -1.7, 5.5, 6.5, 0.7),
    "Undarum and Spumans": (66.5, 4.0, 2.5, 4.5, 0.6),
    "Australe": (91.0, -40.0, 11.0, 11.0, 0.45),
    "Grimaldi": (-68.3, -5.4, 2.4, 3.2, 1.1),
    "Plato": (-9.4, 51.6, 1.75, 1.6, 1.0),
}

# Longitude, latitude, radius of the bright floor and reach of the rays (degrees), brightness.
RAYED_CRATERS = {
    "Tycho": (-11.4, -43.3, 2.4, 38.0, 1.0),
    "Copernicus": (-20.1, 9.6, 2.2, 12.0, 0.9),
    "Kepler": (-38.0, 8.1, 1.2, 8.0, 0.85),
    "Aristarchus": (-47.5, 23.7, 1.1, 5.0, 1.3),
    "Proclus": (46.8, 16.1, 0.9, 6.0, 0.8),
    "Langrenus": (61.0, -8.9, 2.4, 6.0, 0.6),
    "Stevinus": (54.2, -32.5, 1.3, 9.0, 0.7),
    "Anaxagoras": (-10.1, 73.4, 1.2, 9.0, 0.7),
    "Byrgius A": (-63.7, -24.5, 0.8, 7.0, 0.7),
}


def feature_records() -> NDArray[np.float32]:
    """What the shader reads: three texels of four numbers in a row per feature, seas first.

    Of a sea: middle and darkness; east and north, each over the sine of its half-axis. Of a crater: middle
    and brightness; east and the sine of its floor's radius; north and the sine of its rays' reach.
    """
    rows = []
    for longitude, latitude, across, along, strength in SEAS.values():
        middle, east, north = _axes(longitude, latitude)
        a, b = np.sin(np.radians([across, along]))
        rows.append([[*middle, strength], [*(east / a), 0.0], [*(north / b), 0.0]])
    for longitude, latitude, floor, rays, strength in RAYED_CRATERS.values():
        middle, east, north = _axes(longitude, latitude)
        a, b = np.sin(np.radians([floor, rays]))
        rows.append([[*middle, strength], [*east, a], [*north, b]])
    return np.array(rows, np.float32)


def _axes(longitude: float, latitude: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    l, b = np.radians([longitude, latitude])
    middle = np.array([np.cos(b) * np.cos(l), np.cos(b) * np.sin(l), np.sin(b)])
    east = np.array([-np.sin(l), np.cos(l), 0.0])
    return middle, east, np.cross(middle, east)
