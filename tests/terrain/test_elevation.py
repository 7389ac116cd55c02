"""Elevation files: what is read, where it lies, what is refused and how."""

from __future__ import annotations

import numpy as np
import pytest

from fallstreak.terrain.elevation import fill_voids, read_elevation
from fallstreak.terrain.model import shipped_path
from fallstreak.world.errors import WorldError

PLACE, RADIUS = (36.59, -84.246), 6.36e6


def ramp(rows=12, columns=16):
    """Heights that tell row and column apart."""
    return (np.arange(rows)[:, None] * 100 + np.arange(columns)[None, :]).astype(np.int16)


def write(path, **data):
    np.savez(path, **data)
    return path


def test_shipped_model_has_its_swapped_bounds_put_right():
    grid = read_elevation(shipped_path("jacksboro"))
    with np.load(shipped_path("jacksboro")) as file:
        assert file["ymin"] > file["ymax"]  # as matplotlib ships it
    assert grid.heights.shape == (344, 403)
    assert (grid.heights.min(), grid.heights.max()) == (236.0, 1076.0)
    # SRTM samples lie on whole multiples of 3 arc-seconds; row 0 is the northern one
    assert grid.x[0] * 1200 == pytest.approx(round(grid.x[0] * 1200), abs=1e-6)
    assert grid.y[0] == pytest.approx(36.7325) and grid.y[1] < 0
    # the plateau is in the north-west, the valley in the south-east
    assert grid.heights[250:, :100].mean() > grid.heights[250:, 300:].mean() + 200


@pytest.mark.parametrize("swapped", [False, True])
def test_edges_name_the_outer_border_and_the_first_row_is_north(tmp_path, swapped):
    y = dict(ymin=40.0, ymax=39.0) if swapped else dict(ymin=39.0, ymax=40.0)
    grid = read_elevation(write(tmp_path / "a.npz", elevation=ramp(), xmin=-2.0, xmax=0.0, **y))
    assert grid.x == pytest.approx((-2.0 + 1 / 16, 2 / 16))
    assert grid.y == pytest.approx((40.0 - 0.5 / 12, -1 / 12))


def test_axes_name_the_samples_in_either_direction(tmp_path):
    latitude = np.linspace(10.0, 11.0, 12)
    grid = read_elevation(
        write(tmp_path / "a.npz", topo=ramp(), latitude=latitude, longitude=np.linspace(5, 6, 16))
    )
    assert grid.y == pytest.approx((10.0, 1 / 11))
    column, row = grid.pixels(*grid.map_position(3.0, 7.0, PLACE, RADIUS), PLACE, RADIUS)
    assert (column, row) == pytest.approx((3.0, 7.0), abs=1e-6)


def test_metres_stand_east_and_north_of_the_anchor(tmp_path):
    grid = read_elevation(
        write(tmp_path / "a.npz", z=ramp(), crs="metres", west=-800.0, east=800.0, south=-600.0, north=600.0)
    )
    assert grid.map_position(0, 0, PLACE, RADIUS) == pytest.approx((-750.0, 550.0))
    assert grid.spacing(PLACE, RADIUS) == pytest.approx(100.0)


def test_unknown_samples_are_filled_from_around(tmp_path):
    heights = np.full((32, 32), 500.0, np.float32)
    heights[10:20, 10:20] = -32768.0
    heights[2, 2] = np.nan
    grid = read_elevation(
        write(tmp_path / "a.npz", elevation=heights, nodata=-32768.0, xmin=0.0, xmax=1.0, ymin=0.0, ymax=1.0)
    )
    assert np.all(grid.heights == 500.0)


def test_filling_continues_a_slope():
    slope = np.tile(np.arange(64, dtype=np.float32), (64, 1))
    hole = np.zeros((64, 64), bool)
    hole[28:36, 28:36] = True
    filled = fill_voids(np.where(hole, -9999, slope), hole)
    assert np.abs(filled - slope)[hole].max() < 4.0
    assert np.all(filled[~hole] == slope[~hole])


BROKEN = {
    "nothing": (dict(), "one of the keys elevation"),
    "no position": (dict(elevation=ramp()), "xmin, xmax, ymin, ymax"),
    "one row": (dict(elevation=ramp(1, 16), xmin=0.0, xmax=1.0, ymin=0.0, ymax=1.0), "at least 4 × 4"),
    "text": (
        dict(elevation=np.full((8, 8), "x"), xmin=0.0, xmax=1.0, ymin=0.0, ymax=1.0),
        "2-D array of numbers",
    ),
    "objects": (dict(elevation=np.full((8, 8), None)), "not a readable .npz"),
    "no area": (dict(elevation=ramp(), xmin=1.0, xmax=1.0, ymin=0.0, ymax=1.0), "enclose no area"),
    "infinite edge": (dict(elevation=ramp(), xmin=np.inf, xmax=1.0, ymin=0.0, ymax=1.0), "xmin is inf"),
    "edge is a list": (dict(elevation=ramp(), xmin=[1, 2], xmax=1.0, ymin=0.0, ymax=1.0), "one number"),
    "metres as degrees": (dict(elevation=ramp(), xmin=0.0, xmax=9e5, ymin=0.0, ymax=9e5), 'crs = "metres"'),
    "unknown crs": (
        dict(elevation=ramp(), crs="mars", xmin=0.0, xmax=1.0, ymin=0.0, ymax=1.0),
        '"geographic"',
    ),
    "uneven axis": (
        dict(elevation=ramp(), latitude=np.arange(12.0) ** 2, longitude=np.arange(16.0)),
        "evenly spaced",
    ),
    "short axis": (dict(elevation=ramp(), latitude=np.arange(3.0), longitude=np.arange(16.0)), "12 finite"),
    "all unknown": (
        dict(elevation=np.full((8, 8), np.nan), xmin=0.0, xmax=1.0, ymin=0.0, ymax=1.0),
        "no height between",
    ),
}


@pytest.mark.parametrize("case", BROKEN)
def test_broken_npz_gives_one_sentence(tmp_path, case):
    data, expected = BROKEN[case]
    path = tmp_path / "broken.npz"
    np.savez(path, **data)
    check_sentence(path, expected)


def test_files_that_are_none(tmp_path):
    check_sentence(tmp_path / "missing.npz", "does not exist")
    (tmp_path / "text.npz").write_text("not a zip")
    check_sentence(tmp_path / "text.npz", "not a readable .npz")
    (tmp_path / "text.tif").write_text("not a tiff")
    check_sentence(tmp_path / "text.tif", "not a readable TIFF")
    (tmp_path / "a.jpg").write_bytes(b"")
    check_sentence(tmp_path / "a.jpg", ".npz, .tif")
    with pytest.raises(WorldError, match="jacksboro"):
        shipped_path("everest")


def check_sentence(path, expected):
    with pytest.raises(WorldError) as caught:
        read_elevation(path)
    message = str(caught.value)
    assert expected in message and str(path) in message and "\n" not in message
