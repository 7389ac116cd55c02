"""PNG, SRTM and Terrarium files: heights where they belong, and one sentence for what is wrong."""

from __future__ import annotations

import json
import os
import struct
import zipfile
import zlib

import numpy as np
import pytest
from elevation_files import hill, tile_of, write_hgt, write_png, write_terrarium
from PIL import Image

from fallstreak.terrain.elevation import read_elevation
from fallstreak.world.errors import WorldError

PLACE, RADIUS = (46.5, 8.5), 6.36e6


def error(grid, points=400, inset=2.0):
    """Largest difference from the hill at random samples of the grid, m."""
    rng = np.random.default_rng(1)
    row, column = (rng.integers(inset, n - inset, points) for n in grid.shape)
    y, x = grid.y[0] + grid.y[1] * row, grid.x[0] + grid.x[1] * column
    latitude, longitude = grid.geographic(x, y)
    return np.abs(grid.heights[row, column] - hill(latitude, longitude)).max()


def refuse(path, *expected):
    with pytest.raises(WorldError) as caught:
        read_elevation(path)
    message = str(caught.value)
    assert all(text in message for text in expected), message
    assert "\n" not in message and len(message) < 600


@pytest.mark.parametrize("zipped", [False, True])
def test_srtm_tile_lies_where_its_name_says(tmp_path, zipped):
    grid = read_elevation(write_hgt(tmp_path, 46, 8, zipped=zipped))
    assert grid.shape == (1201, 1201) and grid.crs == "geographic"
    assert grid.x == pytest.approx((8.0, 1 / 1200)) and grid.y == pytest.approx((47.0, -1 / 1200))
    assert error(grid) <= 0.51


@pytest.mark.parametrize(
    "name", ["S01W001.hgt", "s01w001.HGT", "S01W001.SRTMGL3.hgt", "s01_w001_3arc_v2.hgt"]
)
def test_spellings_of_srtm_names(tmp_path, name):
    write_hgt(tmp_path, -1, -1).rename(tmp_path / name)
    grid = read_elevation(tmp_path / name)
    assert (grid.x[0], grid.y[0]) == (-1.0, 0.0) and error(grid) <= 0.51


def test_terrarium_tile(tmp_path):
    x, y = tile_of(46.5, 8.5, 10)
    grid = read_elevation(write_terrarium(tmp_path, 10, x, y))
    assert grid.shape == (256, 256) and error(grid) < 0.01
    column, row = grid.pixels(0.0, 0.0, PLACE, RADIUS)
    assert -0.5 <= column <= 255.5 and -0.5 <= row <= 255.5
    back = grid.pixels(*grid.map_position(17.0, 200.0, PLACE, RADIUS), PLACE, RADIUS)
    assert back == pytest.approx((17.0, 200.0), abs=1e-6)


@pytest.mark.parametrize("sidecar", ["toml", "json", "pgw", "wld"])
def test_sixteen_bit_png(tmp_path, sidecar):
    edges = {"west": 8.0, "east": 9.0, "south": 46.0, "north": 47.0}
    values = {"scale": 0.05, "offset": -100.0}
    path = write_png(tmp_path / "dem.png", *edges.values())
    text = "".join(f"{k} = {v}\n" for k, v in {**values, **({} if sidecar != "toml" else edges)}.items())
    if sidecar == "json":
        path.with_suffix(".json").write_text(json.dumps({**edges, **values}))
    else:
        path.with_suffix(".toml").write_text(text)
    if sidecar in ("pgw", "wld"):
        lines = [1 / 80, 0.0, 0.0, -1 / 60, 8.0 + 0.5 / 80, 47.0 - 0.5 / 60]
        path.with_suffix(f".{sidecar}").write_text("\n".join(map(str, lines)))
    grid = read_elevation(path)
    assert grid.shape == (60, 80)
    assert grid.x == pytest.approx((8.0 + 0.5 / 80, 1 / 80))
    assert error(grid) <= 0.026


def test_png_in_utm_and_in_metres(tmp_path):
    path = write_png(tmp_path / "dem.png", 0.0, 1.0, 0.0, 1.0)
    path.with_suffix(".toml").write_text(
        'crs = "EPSG:32632"\nwest = 400e3\neast = 480e3\nsouth = 5100e3\nnorth = 5160e3'
    )
    grid = read_elevation(path)
    assert grid.crs == ("utm", 32, False) and grid.spacing((46.5, 8.3), RADIUS) == pytest.approx(
        1000.0, rel=0.01
    )
    path.with_suffix(".toml").write_text('crs = "metres"\nwest = -40\neast = 40\nsouth = -30\nnorth = 30')
    assert read_elevation(path).map_position(0, 0, PLACE, RADIUS) == pytest.approx((-39.5, 29.5))


def test_voids_are_filled_and_said(tmp_path, caplog):
    path = write_hgt(tmp_path, 46, 8, void=(slice(500, 530), slice(700, 740)))
    grid = read_elevation(path)
    assert grid.overview.unknown == {str(path): 1200}
    assert caplog.messages == [f"{path}: 1,200 samples hold no height; they are filled from around"]
    latitude, longitude = 47.0 - np.arange(1201) / 1200, 8.0 + np.arange(1201) / 1200
    off = np.abs(grid.heights - hill(latitude[:, None], longitude[None, :]))
    assert off[500:530, 700:740].max() < 40.0 and np.delete(off, np.s_[500:530], 0).max() <= 0.51
    caplog.clear()
    read_elevation(write_hgt(tmp_path, 47, 8))
    assert not caplog.messages


def test_wrong_srtm_tiles(tmp_path):
    (tmp_path / "N46E008.hgt").write_bytes(bytes(2 * 1201 * 1201 - 2))
    refuse(tmp_path / "N46E008.hgt", "N46E008.hgt", "2,884,800 bytes", "1201", "3601")
    for name in ("alps.hgt", "N96E008.hgt", "N46E208.hgt", "N46.hgt"):
        (tmp_path / name).write_bytes(bytes(2 * 1201 * 1201))
        refuse(tmp_path / name, name, "south-western corner", "N46E008.hgt")
    write_hgt(tmp_path, 45, 8, void=np.s_[:])
    refuse(tmp_path / "N45E008.hgt", "holds no height between")


def test_wrong_zip_archives(tmp_path):
    path = tmp_path / "N46E008.hgt.zip"
    path.write_bytes(b"PK not a zip")
    refuse(path, "not a readable zip")
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("readme.txt", "nothing")
    refuse(path, "holds 0 .hgt files")
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("N46E008.hgt", bytes(50_000_000))
    refuse(path, "50,000,000 bytes")
    whole = write_hgt(tmp_path, 46, 8, zipped=True).read_bytes()
    path.write_bytes(whole[:30_000] + bytes(20_000) + whole[50_000:])
    refuse(path, "zip archive")
    other = tmp_path / "N46E008.zip"
    other.write_bytes(whole)
    refuse(other, 'ends in ".zip"')


def test_wrong_pngs(tmp_path):
    path = tmp_path / "dem.png"
    Image.fromarray(np.zeros((40, 40), np.uint8)).save(path)
    refuse(path, "8-bit grey", "16-bit grey")
    Image.fromarray(np.zeros((40, 40, 4), np.uint8)).save(path)
    refuse(path, "8-bit RGBA", "16-bit grey")
    path.write_bytes(b"GIF89a" + bytes(100))
    refuse(path, "not a readable PNG")
    write_png(path, 8.0, 9.0, 46.0, 47.0)
    refuse(path, "does not say where it lies", "dem.toml", "west, east, south and north")
    whole = path.read_bytes()
    path.with_suffix(".toml").write_text("west = 8\neast = 9\nsouth = 46\nnorth = 47\n")
    path.write_bytes(whole[: len(whole) // 2])
    refuse(path, "not a readable PNG")


def test_a_png_that_claims_a_million_squared(tmp_path):
    def chunk(kind, data):
        body = kind + data
        return struct.pack(">I", len(data)) + body + struct.pack(">I", zlib.crc32(body))

    path = tmp_path / "bomb.png"
    header = struct.pack(">IIBBBBB", 10**6, 10**6, 16, 0, 0, 0, 0)
    path.write_bytes(
        b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(bytes(10**6)))
    )
    path.with_suffix(".toml").write_text("west = 8\neast = 9\nsouth = 46\nnorth = 47\n")
    refuse(path, "samples; at most")


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("west = 8\neast = 9\nsouth = 46\n", "no north"),
        ("west = 8\neast = 8\nsouth = 46\nnorth = 47\n", "enclose no area"),
        ("west = 8\neast = 9\nsouth = 46\nnorth = 470\n", "are no degrees"),
        ("west = 8\neast = 9\nsouth = 46\nnorth = 47\nscale = 0\n", "scale = 0"),
        ("west = 8\neast = 9\nsouth = 46\nnorth = nan\n", "north = nan"),
        ("west = 8\neast = 9\nsouth = 46\nnorth = 47\nunits = 'feet'\n", '"units" is not known'),
        ("west = 8\neast = 9\nsouth = 46\nnorth = 47\nscale = true\n", "scale = true"),
        ('west = 8\neast = 9\nsouth = 46\nnorth = 47\ncrs = "EPSG:2154"\n', "EPSG:2154"),
        ("west = [\n", "not readable as toml"),
    ],
)
def test_wrong_sidecars(tmp_path, text, expected):
    write_png(tmp_path / "dem.png", 8.0, 9.0, 46.0, 47.0)
    (tmp_path / "dem.toml").write_text(text)
    refuse(tmp_path / "dem.png", expected, str(tmp_path / "dem."))


def test_wrong_world_files(tmp_path):
    write_png(tmp_path / "dem.png", 8.0, 9.0, 46.0, 47.0)
    for text in ("1\n0\n0\n-1\n8\n", "a\nb\nc\nd\ne\nf\n"):
        (tmp_path / "dem.pgw").write_text(text)
        refuse(tmp_path / "dem.png", "six numbers")
    (tmp_path / "dem.pgw").write_text("1\n0.5\n0.5\n-1\n8\n46\n")
    refuse(tmp_path / "dem.png", "dem.pgw", "turn or fold")


def test_wrong_tiles(tmp_path):
    folder = tmp_path / "10" / "536"
    folder.mkdir(parents=True)
    Image.fromarray(np.zeros((100, 100, 3), np.uint8)).save(folder / "358.png")
    refuse(folder / "358.png", "256 × 256")
    write_png(folder / "359.png", 8.0, 9.0, 46.0, 47.0, shape=(256, 256))
    refuse(folder / "359.png", "8-bit RGB")
    write_terrarium(tmp_path, 10, 536, 360).write_bytes(b"\x89PNG")
    refuse(folder / "360.png", "not a readable PNG")


def test_what_is_no_file(tmp_path):
    os.mkfifo(tmp_path / "pipe.hgt")
    refuse(tmp_path / "pipe.hgt", "a device or a pipe")
    (tmp_path / "folder.tif").mkdir()
    refuse(tmp_path / "folder.tif", "is a folder")
    (tmp_path / "loop.npz").symlink_to(tmp_path / "loop.npz")
    refuse(tmp_path / "loop.npz", "cannot be read")
    refuse(tmp_path / ("x" * 300 + ".npz"), "cannot be read")
