"""Write data/sunsky.json: the sky of Mitsuba's `sunsky` emitter, for bench_sky.py to compare with.

    python -m venv /tmp/mitsuba && /tmp/mitsuba/bin/pip install mitsuba==3.9.1
    /tmp/mitsuba/bin/python benchmarks/mitsuba_sunsky.py

Mitsuba is no dependency of ours, so the table is committed and the script needs nothing of Fallstreak. The
emitter is the fit of Hosek and Wilkie 2012 to path-traced skies; the sun's disc is left out. Values are
linear Rec. 709 in the emitter's own unit.
"""

import json
from pathlib import Path

import mitsuba as mi
import numpy as np

ELEVATIONS = (10.0, 30.0, 60.0)
TURBIDITIES = (2.0, 3.0)
ALBEDO = 0.3
ZENITH = (5.0, 20.0, 35.0, 50.0, 65.0, 75.0, 83.0, 88.0)
AZIMUTH = (0.0, 30.0, 60.0, 90.0, 120.0, 150.0, 180.0)


def main():
    mi.set_variant("scalar_rgb")
    skies = []
    for turbidity in TURBIDITIES:
        for elevation in ELEVATIONS:
            e = np.radians(elevation)
            emitter = mi.load_dict(
                {
                    "type": "sunsky",
                    "turbidity": turbidity,
                    "albedo": ALBEDO,
                    "sun_scale": 0.0,
                    # z is up in the emitter's own axes
                    "sun_direction": [float(np.cos(e)), 0.0, float(np.sin(e))],
                }
            )
            rows = [[_seen(emitter, zenith, azimuth) for azimuth in AZIMUTH] for zenith in ZENITH]
            skies.append({"turbidity": turbidity, "elevation": elevation, "luminance": rows})
    table = {
        "how": f"mitsuba {mi.__version__}, scalar_rgb, sunsky without sun, albedo {ALBEDO}",
        "zenith": ZENITH,
        "azimuth_from_sun": AZIMUTH,
        "skies": skies,
    }
    path = Path(__file__).parent / "data" / "sunsky.json"
    path.parent.mkdir(exist_ok=True)
    path.write_text(json.dumps(table, indent=1) + "\n")
    print(f"wrote {path}")


def _seen(emitter, zenith, azimuth):
    """Linear Rec. 709 of the sky in a direction, degrees."""
    t, p = np.radians([zenith, azimuth])
    surface = mi.SurfaceInteraction3f()
    # an emitter is evaluated along the way its light travels
    surface.wi = [float(-np.sin(t) * np.cos(p)), float(-np.sin(t) * np.sin(p)), float(-np.cos(t))]
    return [round(float(v), 6) for v in emitter.eval(surface)]


if __name__ == "__main__":
    main()
