"""Machine code on disk: found by the next process, and never another signature's."""

import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

SCRIPT = """
import sys, numpy as np
from fallstreak import noise
from fallstreak.noise import loops
points = np.random.default_rng(1).uniform(-9, 9, (300, int(sys.argv[1]))).astype(np.float32)
value = noise.sample(points, "value", seed=5, threads=1)
print(f"{value.astype(float).sum():.4f}", sum(loops.run.stats.cache_misses.values()))
"""


def _sample(dimensions, folder):
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(folder)}
    command = [sys.executable, "-c", SCRIPT, str(dimensions)]
    value, misses = subprocess.run(
        command, env=environment, capture_output=True, text=True, check=True
    ).stdout.split()
    return value, int(misses)


def test_processes_that_compile_at_a_time_do_not_mix_up_their_code(tmp_path):
    """Numba's own index lets two signatures share a file: wrong numbers without an error."""
    with ThreadPoolExecutor() as pool:
        first = list(pool.map(_sample, (2, 3), (tmp_path, tmp_path)))
    again = [_sample(d, tmp_path) for d in (2, 3)]
    assert [value for value, _ in again] == [value for value, _ in first]
    assert all(misses > 0 for _, misses in first)
    assert all(misses == 0 for _, misses in again)
