#!/usr/bin/env python3
"""Build src/fallstreak/sky/data/stars.npz from d3-celestial's star table (BSD-3-Clause, Olaf Frohn).

    python script/build_stars.py data/stars.8.json [src/fallstreak/sky/data/stars.npz]

The input is `data/stars.8.json` of d3-celestial 0.7.35: Hipparcos stars to magnitude 8, GeoJSON, right
ascension as a longitude of -180..180 degrees, J2000. Written: `ascension`, `declination` (float32,
radians), `magnitude` (int16, hundredths), `colour_index` (int16, thousandths of B-V), brightest first.
"""

import json
import sys
from pathlib import Path

import numpy as np

MISSING_COLOUR = 0.6  # of 52 stars without a B-V: the middle of the table


def main(source: str, target: str = "src/fallstreak/sky/data/stars.npz") -> None:
    features = json.loads(Path(source).read_text(encoding="utf-8"))["features"]
    stars = sorted(features, key=lambda f: (f["properties"]["mag"], f["id"]))
    place = np.radians([f["geometry"]["coordinates"] for f in stars])
    colours = [float(f["properties"]["bv"] or MISSING_COLOUR) for f in stars]
    np.savez_compressed(
        target,
        ascension=np.mod(place[:, 0], 2 * np.pi).astype(np.float32),
        declination=place[:, 1].astype(np.float32),
        magnitude=np.round([100 * float(f["properties"]["mag"]) for f in stars]).astype(np.int16),
        colour_index=np.round(1000 * np.array(colours)).astype(np.int16),
    )
    print(f"{len(stars)} stars, {Path(target).stat().st_size / 1024:.0f} KiB in {target}")


if __name__ == "__main__":
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    main(*sys.argv[1:])
