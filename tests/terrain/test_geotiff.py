"""GeoTIFF: the tags that place a raster on the planet."""

from __future__ import annotations

import resource
import sys
import zlib

import numpy as np
import pytest
import tifffile
from PIL import Image, TiffImagePlugin

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


def tiled(path, heights, nodata=None, **options):
    """Like `write`, with tifffile's options for tiles and compression."""
    tags = [
        (33550, "d", 3, (0.001, 0.001, 0.0), True),
        (33922, "d", 6, (0.0, 0.0, 0.0, 7.0, 46.0, 0.0), True),
        (42113, "s", 0, str(nodata), True),
    ]
    tifffile.imwrite(path, heights, extratags=tags if nodata is not None else tags[:2], **options)
    return path


def rough(dtype, shape=(300, 210)):
    """Heights that hardly pack, with a step in every row."""
    rng = np.random.default_rng(2)
    return (1000 + np.cumsum(rng.normal(0, 3, shape), 1)).astype(dtype)


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


@pytest.mark.parametrize("byteorder", ["<", ">"])
@pytest.mark.parametrize("dtype", ["i2", "u2", "i4", "f4", "f8"])
@pytest.mark.parametrize(
    "options",
    [
        {},
        {"tile": (64, 48)},
        {"rowsperstrip": 7},
        {"tile": (64, 48), "compression": "zlib"},
        {"rowsperstrip": 40, "compression": "zlib", "predictor": 2},
    ],
)
def test_layouts(tmp_path, options, dtype, byteorder):
    values = rough(dtype)
    if options.get("predictor") and dtype[0] == "f":
        options = {**options, "predictor": None}
    grid = read_elevation(tiled(tmp_path / "a.tif", values, byteorder=byteorder, **options))
    assert np.array_equal(grid.heights, values.astype(np.float32))
    # a window of a coarser level is the mean of what it covers
    exact = values[40:200, 48:144].astype(float).reshape(40, 4, 24, 4).mean((1, 3))
    assert np.abs(grid.window((10, 50), (12, 36), 2) - exact).max() < 1e-3


@pytest.mark.parametrize("compression", ["tiff_lzw", "tiff_adobe_deflate", "packbits"])
@pytest.mark.parametrize(("dtype", "predictor"), [("u2", 1), ("u2", 2), ("f4", 1), ("f4", 3)])
def test_what_libtiff_packs(tmp_path, compression, dtype, predictor):
    """Pillow writes by libtiff, which knows codecs that tifffile leaves to others."""
    if compression == "packbits" and predictor != 1:
        pytest.skip("no predictors with packbits")
    info = TiffImagePlugin.ImageFileDirectory_v2()
    for tag, value in ((33550, (0.001, 0.001, 0.0)), (33922, (0.0, 0.0, 0.0, 7.0, 46.0, 0.0))):
        info.tagtype[tag] = 12
        info[tag] = value
    if predictor != 1:
        info[317] = predictor
    values = rough(dtype)
    Image.fromarray(values).save(tmp_path / "a.tif", compression=compression, tiffinfo=info)
    assert np.array_equal(read_elevation(tmp_path / "a.tif").heights, values.astype(np.float32))


def test_tiles_left_out_are_unknown(tmp_path, caplog):
    path = tiled(tmp_path / "a.tif", rough("i2", (96, 96)), tile=(32, 32), compression="zlib")
    with tifffile.TiffFile(path, mode="r+") as tiff:
        tags = tiff.pages.first.tags
        for name in ("TileOffsets", "TileByteCounts"):
            tags[name].overwrite([0, *tags[name].value[1:]])
    grid = read_elevation(path)
    assert grid.overview.unknown == {str(path): 1024} and "1,024 samples" in caplog.text
    assert np.array_equal(grid.heights[32:], rough("i2", (96, 96))[32:].astype(np.float32))
    assert grid.heights.min() > 900 and grid.heights.max() < 1100


def refuse(path, *expected):
    with pytest.raises(WorldError) as caught:
        read_elevation(path)
    message = str(caught.value)
    assert all(text in message for text in (str(path), *expected)), message
    assert "\n" not in message and len(message) < 500


def test_tags_that_are_text(tmp_path):
    for kind, text in ((33550, "ModelPixelScale"), (33922, "ModelTiepoint")):
        tags = [(33550, "d", 3, (1.0, 1.0, 0.0), True), (33922, "d", 6, (0.0,) * 6, True)]
        tags = [(code, "s", 0, "far away", True) if code == kind else (code, *rest) for code, *rest in tags]
        tifffile.imwrite(tmp_path / "a.tif", heights(), extratags=tags)
        refuse(tmp_path / "a.tif", text)


@pytest.mark.parametrize("options", [{}, {"tile": (64, 64), "compression": "zlib"}])
def test_cut_off_files(tmp_path, options):
    path = tiled(tmp_path / "a.tif", rough("f4"), **options)
    whole = path.read_bytes()
    for share in (0.95, 0.5, 0.01):
        path.write_bytes(whole[: int(share * len(whole))])
        refuse(path)


def test_damaged_tiles(tmp_path):
    path = tiled(tmp_path / "a.tif", rough("i2"), tile=(64, 64), compression="zlib")
    with tifffile.TiffFile(path) as tiff:
        offset, size = tiff.pages.first.dataoffsets[3], tiff.pages.first.databytecounts[3]
    whole = bytearray(path.read_bytes())
    whole[offset : offset + size] = bytes(size)
    path.write_bytes(whole)
    refuse(path, "tile or strip 3 is damaged")


def test_bombs(tmp_path):
    path = tiled(tmp_path / "a.tif", rough("i2", (128, 128)), tile=(64, 64), compression="zlib")

    def patched(**values):
        copy = tmp_path / "b.tif"
        copy.write_bytes(path.read_bytes())
        with tifffile.TiffFile(copy, mode="r+") as tiff:
            for name, value in values.items():
                tiff.pages.first.tags[name].overwrite(value)
        return copy

    refuse(patched(ImageWidth=10**6, ImageLength=10**6), "1,000,000,000,000 samples; at most")
    refuse(patched(ImageWidth=6000, ImageLength=6000), "names 4 of 8,836 tiles")
    refuse(patched(TileWidth=60_000, TileLength=60_000), "60000 × 60000 samples, too many")
    # a tile that unpacks to far more than a tile: only as much as it has room for is unpacked
    data = zlib.compress(bytes(10**8), 9)
    with open(path, "ab") as file:
        file.write(data)
    end = path.stat().st_size - len(data)
    with tifffile.TiffFile(path, mode="r+") as tiff:
        tags = tiff.pages.first.tags
        tags["TileOffsets"].overwrite([end, *tags["TileOffsets"].value[1:]])
        tags["TileByteCounts"].overwrite([len(data), *tags["TileByteCounts"].value[1:]])
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    assert np.all(read_elevation(path).heights[:64, :64] == 0.0)
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 40_000


def test_a_codec_that_is_not_there(tmp_path, monkeypatch):
    path = tiled(tmp_path / "a.tif", rough("i2"), compression="zlib")
    with tifffile.TiffFile(path, mode="r+") as tiff:
        tiff.pages.first.tags["Compression"].overwrite(50000)
    monkeypatch.setitem(sys.modules, "imagecodecs", None)
    refuse(path, "ZSTD", "imagecodecs", "COMPRESS=DEFLATE")
    with tifffile.TiffFile(path, mode="r+") as tiff:
        tiff.pages.first.tags["BitsPerSample"].overwrite(12)
    refuse(path)
