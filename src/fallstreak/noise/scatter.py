"""Random numbers of places, for what is scattered one to a cell; the numpy twin of ``scatter.wesl``."""

from __future__ import annotations

import numpy as np


def hash_lattice(x: np.ndarray, y: np.ndarray, seed: int) -> np.ndarray:
    """Hash integer lattice points to uint32, two full rounds so that neighbouring seeds do not correlate.

    Parameters
    ----------
    x, y : integer arrays of one shape (any integer type; taken modulo 2^32)
    seed : int
    """
    with np.errstate(over="ignore"):
        row = mix_bits(np.asarray(y).astype(np.uint32) + np.uint32(seed & 0xFFFFFFFF) * np.uint32(0x9E3779B1))
        return mix_bits(np.asarray(x).astype(np.uint32) + row)


def mix_bits(h: np.ndarray) -> np.ndarray:
    """A bijection of 32 bits with low bias (constants found by search: C. Wellons, "hash prospector")."""
    h = np.asarray(h, np.uint32)
    with np.errstate(over="ignore"):
        h = (h ^ (h >> np.uint32(16))) * np.uint32(0x7FEB352D)
        h = (h ^ (h >> np.uint32(15))) * np.uint32(0x846CA68B)
    return h ^ (h >> np.uint32(16))


def unit_float(h: np.ndarray) -> np.ndarray:
    """Hashes as numbers from 0 to 1, exclusive."""
    return (h >> np.uint32(8)) / 16777216.0
