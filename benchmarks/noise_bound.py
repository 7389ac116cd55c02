"""How fast the loop of Perlin noise could be: its instructions, counted in the machine code, and the clock.

With 512-bit vectors, Intel's and AMD's cores of today start two vector instructions a cycle. So a loop cannot
take fewer cycles than half the vector instructions in it, however they are arranged: that is its issue bound.
Counted are those with a 512-bit register that compute; not loads and stores, which other ports take, nor
zeroing and copies between registers, which no port takes. ``vpmulld`` counts twice on Intel (uops.info).
"""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import tempfile
from collections import Counter

import numpy as np
from numba import njit

LANES, PORTS, TWICE = 16, 2, "vpmulld"


def instructions(assembly: str) -> Counter[str]:
    """The vector instructions of the loop with most of them, among loops without branches, by name."""
    lines = [line.strip() for line in assembly.splitlines()]
    labels = {line[:-1]: number for number, line in enumerate(lines) if re.fullmatch(r"\.LBB\w+:", line)}
    loops = []
    for number, line in enumerate(lines):
        jump = re.match(r"j\w+\s+(\.LBB\w+)", line)
        start = labels.get(jump[1], number) if jump else number
        body = lines[start + 1 : number]
        if start < number and not any(re.match(r"j|\.LBB", inside) for inside in body):
            loops.append(Counter(line.split()[0] for line in body if _computes(line)))
    return max(loops, key=lambda counted: counted.total(), default=Counter())


def _computes(line: str) -> bool:
    return "%zmm" in line and not re.match(r"vmov|\.|#", line)


def of_perlin() -> Counter[str]:
    """Of 3-D Perlin noise in fBm of float32 points, as compiled for this machine.

    In a new process that finds nothing compiled: what Numba loads from its cache cannot be looked into.
    """
    with tempfile.TemporaryDirectory() as folder:
        result = subprocess.run(
            [sys.executable, __file__],
            env=os.environ | {"NUMBA_CACHE_DIR": folder},
            stdout=subprocess.PIPE,
            text=True,
            check=True,
        )
    return Counter(json.loads(result.stdout))


def _count_here() -> Counter[str]:
    from fallstreak import noise
    from fallstreak.noise import loops

    noise.fbm(tuple(np.zeros((3, 256), np.float32)), 2, threads=1)
    (assembly,) = loops.run.inspect_asm().values()
    return instructions(assembly)


def issues(counted: Counter[str]) -> int:
    return counted.total() + counted[TWICE]


@njit(cache=True)
def _chain(x, count):
    for _ in range(count):  # 4 cycles: a product takes 3, the exclusive or that waits for it 1
        x = (x * np.uint64(6364136223846793005)) ^ (x >> np.uint64(7))
    return x


CHAIN = 15_000_000  # about as long as the loop takes: what disturbs one disturbs the other
CYCLES = 4 * CHAIN


def chain():
    """Work of `CYCLES` cycles exactly, by instructions that wait for each other: a clock for the clock."""
    return _chain(np.uint64(1), CHAIN)


if __name__ == "__main__":
    print(json.dumps(_count_here()))
