"""Large files: the same land by windows as from the whole, in little memory; land in wide holes."""

from __future__ import annotations

import json
import subprocess
import sys

import numpy as np
import pytest
from elevation_files import hill, write_hgt

import fallstreak as fs
from fallstreak.terrain.continuation import FileLand
from fallstreak.terrain.elevation import grid as grids
from fallstreak.terrain.elevation import read_elevation
from fallstreak.terrain.elevation.coverage import distance, room_around_holes
from fallstreak.terrain.elevation.raster import ArrayRaster
from fallstreak.terrain.model import shipped_path
from fallstreak.terrain.pyramid import axis, build

RADIUS = 6.36e6


def land(paths, place, surroundings="continue"):
    return FileLand(read_elevation(paths), place, RADIUS, surroundings, 3)


def test_windows_give_what_the_whole_gives(monkeypatch):
    place = (36.59, -84.246)
    whole = land(shipped_path("jacksboro"), place)
    monkeypatch.setattr(grids, "OVERVIEW", 60)
    part = land(shipped_path("jacksboro"), place)
    assert whole.mips.first == 0 and part.mips.first == 3 and max(part.mips.kept[0].shape) < 60
    for spacing in (30.0, 75.0, 170.0, 400.0):
        # the middle of the file is the file alone
        east, north = np.arange(-8e3, 8e3, spacing), np.arange(-7e3, 6e3, spacing)
        expected = whole.sample(east, north)
        assert np.abs(part.sample(east, north) - expected).max() < 2e-3
        part.prepare(spacing, 9e3)
        window = part.mips._window
        assert (window is not None) == (part._level(spacing) < 3 or spacing > 30.0)
        assert np.abs(part.sample(east, north) - expected).max() < 2e-3


def test_all_of_a_level_is_prepared_at_once(tmp_path, monkeypatch):
    """Reading anew for every strip would unpack a file dozens of times."""
    monkeypatch.setattr(grids, "OVERVIEW", 100)
    reads = []
    ground = land([write_hgt(tmp_path, 46, west) for west in (8, 9)], (46.5, 9.0))
    read = type(ground.grid.raster).read
    monkeypatch.setattr(
        type(ground.grid.raster), "read", lambda *a, **k: reads.append(a[-1]) or read(*a, **k), raising=True
    )
    pyramid = build(ground, 60e3)
    assert 0 < len(reads) <= pyramid.levels and reads == sorted(reads) and reads[-1] < ground.mips.first
    centre = axis(pyramid.spacing)
    from fallstreak.terrain.spline import evaluate

    row = np.arange(300, 460)
    e, n = np.meshgrid(centre[row], centre[row])
    latitude, longitude = (v for v in ground.grid.geographic(*_degrees(ground, e, n)))
    found = evaluate(pyramid.coefficients[0], *np.meshgrid(row, row))
    assert np.abs(found - hill(latitude, longitude)).max() < 1.5


def _degrees(ground, east, north):
    column, row = ground.grid.pixels(east, north, ground.place, ground.radius)
    grid = ground.grid
    return grid.x[0] + grid.x[1] * column, grid.y[0] + grid.y[1] * row


@pytest.mark.parametrize("surroundings", ["continue", "sea"])
def test_a_missing_corner_is_land_like_the_rest_or_sea(tmp_path, surroundings):
    rng = np.random.default_rng(1)
    rough = np.cumsum(np.cumsum(rng.normal(size=(240, 240)), 0), 1)
    rough = 800.0 + 200.0 * (rough - rough.mean()) / rough.std() + rng.normal(0, 15, rough.shape)
    rough[:120, 120:] = np.nan
    path = tmp_path / "l.npz"
    np.savez(path, z=rough, crs="metres", west=-12e3, east=12e3, south=-12e3, north=12e3)
    ground = land(path, (0.0, 0.0), surroundings)
    east, north = np.arange(5e3, 10e3, 100.0), np.arange(5e3, 10e3, 100.0)
    there = ground.sample(east, north)
    if surroundings == "sea":
        assert np.all(there == 0.0)
    else:
        # invented, not smoothly filled, which would be 20 times smoother than the file
        inside = ground.sample(-east[::-1], -north[::-1])
        assert 1.0 < np.diff(there, axis=0).std() / np.diff(inside, axis=0).std() < 2.5
    # no step where the file ends: nothing steeper than what is found in land beyond the file
    across = ground.sample(np.arange(2e3, 9e3, 20.0), np.arange(-3e3, 4e3, 20.0))
    beyond = ground.sample(np.arange(22e3, 29e3, 20.0), np.arange(-3e3, 4e3, 20.0))
    limit = np.abs(np.diff(beyond, axis=0)).max() if surroundings == "continue" else 25.0
    assert np.abs(np.diff(across, axis=0)).max() < 1.3 * limit


def test_small_holes_are_no_coast(tmp_path):
    known = np.ones((200, 200), bool)
    known[90:96, 90:100] = False
    assert room_around_holes(known, 16.0) is None
    known[60:140, 60:140] = False
    room, step = room_around_holes(known, 16.0)
    assert step == 1 and room[100, 100] == 0.0 and room[100, 20] == pytest.approx(39.5, abs=1.5)


def test_distance():
    marks = np.zeros((40, 50), bool)
    marks[7, 9] = marks[30, 41] = True
    i, j = np.mgrid[:40, :50]
    exact = np.minimum(np.hypot(i - 7, j - 9), np.hypot(i - 30, j - 41))
    assert np.abs(distance(marks) - exact).max() < 1e-9
    assert np.isinf(distance(np.zeros((3, 4), bool))).all()


@pytest.mark.parametrize("reduction", [0, 1, 3, 5])
def test_blocks_over_pieces_that_do_not_fit_them(reduction, monkeypatch):
    """Means of blocks do not depend on how the file is cut into pieces."""
    rng = np.random.default_rng(4)
    values = rng.integers(-500, 4000, (203, 317)).astype(np.int16)
    holes = rng.random(values.shape) < 0.3
    values[holes] = -32768
    monkeypatch.setattr("fallstreak.terrain.elevation.raster.STRIP", 7 * 317)
    raster = ArrayRaster(values, "a", -32768.0)
    monkeypatch.setattr("fallstreak.terrain.elevation.raster.strips", lambda rows, _: _pieces(rows, 7))
    block = 1 << reduction
    rows, columns = (1, 203 >> reduction), (2, 317 >> reduction)
    window = raster.read(rows, columns, reduction)
    part = np.where(holes, np.nan, values)[block : rows[1] * block, 2 * block : columns[1] * block]
    blocks = part.reshape(rows[1] - 1, block, columns[1] - 2, block)
    with np.errstate(invalid="ignore"):
        exact = np.nansum(blocks, (1, 3)) / np.isfinite(blocks).sum((1, 3))
    assert np.allclose(window.heights, exact, atol=1e-3, equal_nan=True)
    assert window.unknown == {"a": int(np.isnan(part).sum())}


def _pieces(rows, height):
    return ((i, min(i + height, rows[1])) for i in range(rows[0], rows[1], height))


def test_a_file_larger_than_what_it_may_take(tmp_path):
    """400 MB of uncompressed heights, most of them never written to disk, with 150 MB to spare."""
    import tifffile

    path = tmp_path / "large.tif"
    side = 10_000
    tags = [
        (33550, "d", 3, (0.0003, 0.0003, 0.0), True),
        (33922, "d", 6, (0.0, 0.0, 0.0, 7.0, 48.0, 0.0), True),
    ]
    tifffile.memmap(path, shape=(side, side), dtype="f4", extratags=tags).flush()
    code = """
import json, sys
from pathlib import Path
from fallstreak.terrain.elevation import read_elevation
read_elevation(sys.argv[2])
def peak():
    status = Path("/proc/self/status").read_text()
    return int(status.partition("VmHWM:")[2].split()[0]) / 1024
before = peak()
grid = read_elevation(sys.argv[1])
grid.window((2000, 2500), (3000, 3600), 1)
print(json.dumps([peak() - before, grid.overview.reduction, float(grid.overview.heights.max())]))
"""
    command = [sys.executable, "-c", code, str(path), str(shipped_path("jacksboro"))]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    used, reduction, highest = json.loads(done.stdout)
    assert reduction == 3 and highest == 0.0 and used < 150.0


def test_jacksboro_is_one_window():
    assert fs.load("jacksboro").terrain.file == "jacksboro"
    assert read_elevation(shipped_path("jacksboro")).overview.reduction == 0
