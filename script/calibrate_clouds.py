"""Bake the clouds' noise, and find how many clouds give which coverage, for every genus.

Writes volume.npz and calibration.npz to src/fallstreak/clouds/field/data.

Run it when genera, shipped cloud models, or the field's cells, density or noise have changed; it takes two
minutes. Layers whose numbers differ from the usual are calibrated when they are first used, less exactly.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

import fallstreak as fs
from fallstreak.clouds.field import volume
from fallstreak.clouds.field.calibration import DATA, FIELDS, calibrate, key_of
from fallstreak.clouds.field.layers import Layer
from fallstreak.clouds.field.mean import fitted
from fallstreak.clouds.field.model import Field, model_names
from fallstreak.clouds.genera import GENERA
from fallstreak.clouds.shapes import load

SIDE = 90  # columns along a side of the patch looked at: shares are exact to .006

if __name__ == "__main__":
    DATA.parent.mkdir(exist_ok=True)
    np.savez_compressed(volume.DATA, volume=volume.baked())
    keys, found = [], []
    for genus in GENERA:
        world = fs.World(clouds={"layers": [{"genus": genus}]})
        layer = Layer.of(world, 0, tuple(load(model_names(world.clouds.layers[0]))))
        keys.append(key_of(layer))
        plain = calibrate(layer, SIDE)
        field = Field((replace(layer, coverage=0.4, clustering=0.0),), (None,), (plain,))
        found.append(replace(plain, blobs=fitted(field)))
        print(
            f"{genus:18} {' '.join(f'{n:5.2f}' for n in found[-1].knots)} | "
            f"{' '.join(f'{n:4.2f}' for n in found[-1].blobs)}"
        )
    np.savez_compressed(DATA, keys=keys, **{name: [getattr(f, name) for f in found] for name in FIELDS})
