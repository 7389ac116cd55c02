"""GeoTIFF: the tags that place a raster on the planet."""

from __future__ import annotations

import numpy as np
import pytest
import tifffile

from fallstreak.terrain.elevation import read_elevation
from fallstreak.terrain.projection import geographic_from_utm
from fallstreak.world.errors import WorldError

PLACE, RADIUS = (46.0, 8.0), 6.36e6


def write(path, heights, scale, tie, keys, nodata=None):
    """A minimal GeoTIFF; `keys` are GeoKeys with short values."""
    directory = [1, 1, 0, len(keys)]
    for key, value in keys.items():
        directory += [key, 0, 1, value]
    tags = [
        (33550, "d", 3, (*scale, 0.0), True),
        (33922, "d", 6, (0.0, 0.0, 0.0, *tie, 0.0), True),
        (34735, "H", len(directory), directory, True),
    ]
    if nodata is not None:
        tags.append((42113, "s", 0, str(nodata), True))
    tifffile.imwrite(path, heights, extratags=tags)
    return path


def heights():
    return (np.arange(20)[:, None] * 50 + np.arange(30)[None, :]).astype(np.float32)


def test_geographic(tmp_path):
    grid = read_elevation(
        write(tmp_path / "a.tif", heights(), (0.001, 0.002), (7.5, 46.5), {1024: 2, 1025: 1, 2048: 4326})
    )
    assert grid.crs == "geographic"
    assert grid.x == pytest.approx((7.5005, 0.001)) and grid.y == pytest.approx((46.499, -0.002))
    assert np.array_equal(grid.heights, heights())


def test_pixel_is_point_names_the_sample_itself(tmp_path):
    grid = read_elevation(
        write(tmp_path / "a.tif", heights(), (0.001, 0.002), (7.5, 46.5), {1024: 2, 1025: 2})
    )
    assert (grid.x[0], grid.y[0]) == pytest.approx((7.5, 46.5))


@pytest.mark.parametrize(("code", "south"), [(32632, False), (32732, True)])
def test_utm(tmp_path, code, south):
    place = geographic_from_utm(500_000.0, 5_000_000.0, 32, south)
    grid = read_elevation(
        write(tmp_path / "a.tif", heights(), (30.0, 30.0), (499_700.0, 5_000_300.0), {1024: 1, 3072: code})
    )
    assert grid.crs == ("utm", 32, south)
    # the file's middle lies at the anchor: column 9.5, row 9.5
    column, row = grid.pixels(0.0, 0.0, place, RADIUS)
    assert (column, row) == pytest.approx((9.5, 9.5), abs=1e-3)
    assert grid.spacing(place, RADIUS) == pytest.approx(30.0, rel=0.006)  # sphere for ellipsoid, UTM's scale


def test_nodata_is_filled(tmp_path):
    values = np.full((20, 20), 700.0, np.float32)
    values[5:9, 5:9] = -9999.0
    grid = read_elevation(
        write(tmp_path / "a.tif", values, (0.001, 0.001), (8.0, 46.0), {1024: 2}, nodata=-9999)
    )
    assert np.all(grid.heights == 700.0)


def test_what_cannot_be_placed_is_refused(tmp_path):
    with pytest.raises(WorldError, match="EPSG:2154 is not read"):
        read_elevation(write(tmp_path / "a.tif", heights(), (30.0, 30.0), (7e5, 6e6), {1024: 1, 3072: 2154}))
    tifffile.imwrite(tmp_path / "plain.tif", heights())
    with pytest.raises(WorldError, match="ModelTiepoint"):
        read_elevation(tmp_path / "plain.tif")
    with pytest.raises(WorldError, match="positive"):
        read_elevation(write(tmp_path / "b.tif", heights(), (0.0, 30.0), (7.0, 46.0), {1024: 2}))
    tifffile.imwrite(tmp_path / "rgb.tif", np.zeros((8, 8, 3), np.uint8))
    with pytest.raises(WorldError, match=r"rgb\.tif"):
        read_elevation(tmp_path / "rgb.tif")
