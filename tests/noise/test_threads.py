"""Noise from several threads and processes at a time: the same values, and nobody waits for ever."""

from __future__ import annotations

import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from fallstreak import noise


def test_threads_may_call_at_the_same_time():
    points = np.random.default_rng(0).uniform(-50, 50, (40_000, 3)).astype(np.float32)
    expected = [noise.fbm(points, 5, seed=seed, threads=1) for seed in range(8)]
    with ThreadPoolExecutor(8) as pool:
        found = list(pool.map(lambda seed: noise.fbm(points, 5, seed=seed), range(8)))
    assert all(np.array_equal(a, b) for a, b in zip(found, expected, strict=True))


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork on this system")
def test_a_forked_process_has_threads_of_its_own():
    """As in the workers of a data loader: the pool is inherited, its threads are not."""
    code = """
import multiprocessing, numpy as np
from fallstreak import noise
points = np.random.default_rng(0).random((100_000, 3), np.float32)
def work(_):
    return float(noise.fbm(points, 5, threads=4).sum())
here = work(0)
with multiprocessing.get_context("fork").Pool(2) as pool:
    print(pool.map_async(work, (1, 2)).get(timeout=60) == [here, here])
"""
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=120)
    assert result.stdout == "True\n", result.stderr


def test_a_new_process_reads_what_this_one_compiled():
    """The second process compiles nothing that the first has left in the cache."""
    code = """
import numba.core.dispatcher as d
compiled, original = [], d._FunctionCompiler.compile
d._FunctionCompiler.compile = lambda self, *a: compiled.append(self.py_func.__name__) or original(self, *a)
import numpy as np
from fallstreak import noise
noise.fbm(np.zeros((10, 3), np.float32), 3)
print(compiled)
"""
    for _ in range(2):
        result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert result.stdout == "[]\n", result.stdout + result.stderr
