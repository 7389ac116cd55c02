"""The same source at other widths of vectors gives the same noise: what other processors will run."""

import os
import subprocess
import sys

import numpy as np
import pytest

from fallstreak import noise

from . import reference

KINDS = ("value", "cellular_f2f1", "improved")  # `test_lanes.py` has perlin and simplex
SCRIPT = """
import sys, numpy as np
from fallstreak import noise
points = np.load(sys.argv[1])
np.save(sys.argv[2], np.stack([noise.sample(points, kind, seed=4) for kind in sys.argv[3:]]))
"""


@pytest.mark.parametrize("width", [1, 8])
def test_every_width_gives_the_same_noise(width, tmp_path):
    points = reference.scattered(3, 1000).astype(np.float32)
    np.save(tmp_path / "points.npy", points)
    files = [str(tmp_path / name) for name in ("points.npy", "noise.npy")]
    environment = {**os.environ, "FALLSTREAK_NOISE_WIDTH": str(width)}
    subprocess.run([sys.executable, "-c", SCRIPT, *files, *KINDS], env=environment, check=True)
    for kind, found in zip(KINDS, np.load(files[1]), strict=True):
        assert np.abs(found - reference.sample(points, kind, seed=4)).max() <= 1e-6, kind
        assert np.abs(found - noise.sample(points, kind, seed=4)).max() <= 1e-6, kind
