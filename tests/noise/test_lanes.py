"""Lanes of every width compute what numpy computes, and every width gives the same noise."""

import numpy as np
import pytest
from numba import njit

from fallstreak import noise
from fallstreak.noise import tiles
from fallstreak.noise.lanes import (
    as_float,
    as_int,
    floor,
    fma,
    larger,
    multiply16,
    multiply16_high,
    select,
    shift_right,
    smaller,
    to_float,
)
from fallstreak.noise.memory import load_floats, load_ints, pointer_at, store, width_of
from fallstreak.noise.static import Static, StaticType

WIDTHS = 1, 4, 8, 16
COUNT = 64


@njit
def _compute(static, x, y, i, j, floats, ints):
    """All operations on 64 floats x, y and integers i, j, one row of the results for each."""
    px, py, pi, pj = pointer_at(x), pointer_at(y), pointer_at(i), pointer_at(j)
    to_floats, to_ints = pointer_at(floats), pointer_at(ints)
    for k in range(0, COUNT, width_of(static)):
        a, b = load_floats(static, px, k), load_floats(static, py, k)
        c, d = load_ints(static, pi, k), load_ints(static, pj, k)
        store(to_floats, k, a + b * 2.0 - 1.0)
        store(to_floats, k + COUNT, fma(a, b, 0.5))
        store(to_floats, k + 2 * COUNT, floor(a) / b)
        store(to_floats, k + 3 * COUNT, select((a > b) & ~(b < 0.0), a, -b))
        store(to_floats, k + 4 * COUNT, larger(a, smaller(b, 0.25)))
        store(to_floats, k + 5 * COUNT, to_float(c) + as_float(as_int(b)))
        store(to_ints, k, (c + 0x9E3779B1) * d)
        store(to_ints, k + COUNT, (c >> 3) ^ shift_right(d, 5))
        store(to_ints, k + 2 * COUNT, (c & 0xFF) | (d << 8))
        store(to_ints, k + 3 * COUNT, multiply16(c, d) & 0xFFFF)
        store(to_ints, k + 4 * COUNT, multiply16_high(c, d) & 0xFFFF)
        store(to_ints, k + 5 * COUNT, select(c == d, c, -d))


@pytest.mark.parametrize("width", WIDTHS)
def test_operations_are_numpys(width):
    random = np.random.default_rng(width)
    x, y = random.uniform(-9, 9, (2, COUNT)).astype(np.float32)
    i, j = random.integers(-(2**31), 2**31, (2, COUNT)).astype(np.int32)
    i[::5] = j[::5]
    floats, ints = np.empty((6, COUNT), np.float32), np.empty((6, COUNT), np.int32)
    _compute(Static("", 3, width), *(a.ctypes.data for a in (x, y, i, j, floats, ints)))
    u, v = i.view(np.uint32), j.view(np.uint32)
    low, wide = np.uint32(0xFFFF), np.uint32(16)
    expected = (
        x + y * np.float32(2) - np.float32(1),
        (x.astype(np.float64) * y + 0.5).astype(np.float32),
        np.floor(x) / y,
        np.where((x > y) & ~(y < 0), x, -y),
        np.maximum(x, np.minimum(y, np.float32(0.25))),
        i.astype(np.float32) + y,
    )
    np.testing.assert_allclose(floats, expected, rtol=2e-6, atol=1e-6)
    expected = (
        (u + np.uint32(0x9E3779B1)) * v,
        (i >> 3).view(np.uint32) ^ (v >> np.uint32(5)),
        (u & np.uint32(0xFF)) | (v << np.uint32(8)),
        (u & low) * (v & low) & low,
        (u & low) * (v & low) >> wide,
        np.where(i == j, i, -j).view(np.uint32),
    )
    np.testing.assert_array_equal(ints.view(np.uint32), expected)


@pytest.mark.parametrize("kind", ["perlin", "simplex"])
def test_every_width_gives_the_same_noise(kind, monkeypatch):
    points = np.random.default_rng(1).uniform(-20, 20, (1000, 3)).astype(np.float32)
    found = []
    for width in WIDTHS:
        monkeypatch.setattr(tiles, "_width", lambda width=width: width)
        found.append(noise.fbm(points, 3, kind=kind, seed=2, threads=1))
    for other in found[1:]:
        np.testing.assert_allclose(other, found[0], atol=5e-7)


def test_an_edit_of_the_folder_makes_other_types():
    """The digest of the source is part of what machine code is found by."""
    choice = Static("perlin", 3, 8)
    assert StaticType(choice, "before") != StaticType(choice, "after")
    assert StaticType(choice, "before") == StaticType(choice, "before")


def test_the_width_can_be_forced_and_is_checked(monkeypatch):
    from fallstreak.noise.vectors import host_width

    monkeypatch.setenv("FALLSTREAK_NOISE_WIDTH", "4")
    assert host_width() == 4
    monkeypatch.setenv("FALLSTREAK_NOISE_WIDTH", "5")
    with pytest.raises(ValueError, match="FALLSTREAK_NOISE_WIDTH='5' is not allowed"):
        host_width()
