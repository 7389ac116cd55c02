"""Several elevation files as one: rims, overlaps, holes, other systems; and which files a scene may mean."""

from __future__ import annotations

import os
import subprocess
import sys

import numpy as np
import pytest
from elevation_files import hill, tile_of, write_hgt, write_terrarium

import fallstreak as fs
from fallstreak.terrain.elevation import read_elevation
from fallstreak.terrain.model import terrain_model
from fallstreak.world.errors import WorldError


def truth(grid, rows=slice(None), columns=slice(None)):
    """The hill at samples of the grid."""
    row, column = np.arange(grid.shape[0])[rows], np.arange(grid.shape[1])[columns]
    x, y = np.meshgrid(grid.x[0] + grid.x[1] * column, grid.y[0] + grid.y[1] * row)
    return hill(*grid.geographic(x, y))


def plateau(path, west, east, south, north, shape, height):
    """An .npz, all of one height; or with `height` a function of latitude and longitude."""
    latitude = north - (np.arange(shape[0]) + 0.5) / shape[0] * (north - south)
    longitude = west + (np.arange(shape[1]) + 0.5) / shape[1] * (east - west)
    values = height(latitude[:, None], longitude[None, :]) if callable(height) else np.full(shape, height)
    np.savez(path, elevation=values.astype(np.float32), west=west, east=east, south=south, north=north)
    return path


def test_srtm_tiles_share_their_rims(tmp_path):
    paths = [write_hgt(tmp_path, south, west) for south in (45, 46) for west in (8, 9)]
    grid = read_elevation(paths)
    assert grid.shape == (2401, 2401) and (grid.x[0], grid.y[0]) == (8.0, 47.0)
    assert np.abs(grid.heights - truth(grid)).max() <= 0.51
    # a block of four samples over the corner where the tiles meet
    part = grid.window((590, 610), (590, 610), 1)
    exact = truth(grid)[1180:1220, 1180:1220].reshape(20, 2, 20, 2).mean((1, 3))
    assert np.abs(part - exact).max() <= 0.51


def test_a_missing_tile_is_a_hole_that_is_filled_and_said(tmp_path, caplog):
    paths = [write_hgt(tmp_path, *corner) for corner in ((45, 8), (45, 9), (46, 8))]
    grid = read_elevation(paths)
    known = grid.overview.known
    assert known is not None and known[: known.shape[0] // 2 - 2, known.shape[1] // 2 + 2 :].sum() == 0
    heights = grid.overview.heights
    assert np.isfinite(heights).all() and heights.min() > 200 and heights.max() < 1800
    assert caplog.messages == [
        "N45E008.hgt and 2 more: 25.0% of the area around the files lies in none of them"
    ]


def test_terrarium_tiles_of_two_zooms(tmp_path):
    x, y = tile_of(46.5, 8.5, 9)
    paths = [write_terrarium(tmp_path, 9, x + i, y) for i in range(2)]
    paths += [write_terrarium(tmp_path, 10, 2 * x + 1 + i, 2 * y) for i in range(2)]
    grid = read_elevation(paths)
    assert grid.shape == (512, 1024)  # on the lattice of the finer
    off = np.abs(grid.heights - truth(grid))
    assert off[4:-4, 4:-4].max() < 0.1
    assert off[20:220, 280:740].max() < 0.02  # where that is


def test_tiles_across_the_antimeridian(tmp_path):
    grid = read_elevation([write_hgt(tmp_path, 52, 179), write_hgt(tmp_path, 52, -180)])
    assert grid.shape == (1201, 2401) and grid.x[0] == 179.0
    latitude, longitude = 53.0 - 600 / 1200, np.array([179.5, -179.5])
    assert np.abs(grid.heights[600, [600, 1800]] - hill(latitude, longitude)).max() <= 0.51


def test_the_finer_file_counts_and_passes_into_the_coarser(tmp_path):
    coarse = plateau(tmp_path / "coarse.npz", 8.0, 9.0, 46.0, 47.0, (100, 100), 500.0)
    fine = plateau(tmp_path / "fine.npz", 8.4, 8.6, 46.4, 46.6, (200, 200), 800.0)
    for order in ((coarse, fine), (fine, coarse)):
        grid = read_elevation(order)
        assert grid.x[1] == pytest.approx(0.001) and grid.shape == (1000, 1000)
        heights = grid.heights
        middle = heights.shape[0] // 2
        assert heights[middle - 60 : middle + 60, middle - 60 : middle + 60] == pytest.approx(800.0, abs=0.01)
        assert heights[:300] == pytest.approx(500.0, abs=0.01)
        # 300 m of difference, spread over the 12 samples at the fine file's edge
        assert np.abs(np.diff(heights, axis=0)).max() < 50.0
        assert np.abs(np.diff(heights, axis=1)).max() < 50.0


def test_a_hole_in_the_finer_file_shows_the_coarser_one_without_a_step(tmp_path):
    def holed(latitude, longitude):
        heights = hill(latitude, longitude) + 50.0  # surveyed from another level
        heights[80:120, 60:130] = np.nan
        return heights

    coarse = plateau(tmp_path / "coarse.npz", 8.0, 9.0, 46.0, 47.0, (200, 200), hill)
    fine = plateau(tmp_path / "fine.npz", 8.4, 8.6, 46.4, 46.6, (200, 200), holed)
    grid = read_elevation([coarse, fine])
    assert grid.overview.unknown == {str(fine): 40 * 70}
    off = grid.heights - truth(grid)
    row, column = (round(v) for v in ((46.5 - grid.y[0]) / grid.y[1], (8.5 - grid.x[0]) / grid.x[1]))
    inside = off[row - 70 : row + 70, column - 70 : column + 70]
    assert np.abs(inside - 50.0).max() < 2.0


def test_files_of_different_systems(tmp_path):
    """A picture in UTM that overlaps an SRTM tile by a strip."""
    tile = write_hgt(tmp_path, 46, 8)
    other = plateau(tmp_path / "b.npz", 8.9, 9.9, 46.0, 47.0, (700, 700), hill)
    from fallstreak.terrain.projection import geographic_from_utm

    east, north = 240e3 + 200.0 * (np.arange(400) + 0.5), 5160e3 - 200.0 * (np.arange(300) + 0.5)
    latitude, longitude = geographic_from_utm(*np.meshgrid(east, north), 33, False)
    utm = tmp_path / "utm.npz"
    np.savez(
        utm, z=hill(latitude, longitude), crs="EPSG:32633", west=240e3, east=320e3, south=5100e3, north=5160e3
    )
    grid = read_elevation([tile, other, utm])
    assert grid.crs == "geographic"
    known = grid.overview.known
    assert known is not None and grid.overview.reduction == 1
    assert 0.4 < known.mean() < 0.7  # 1.7° between the files are in none of them
    rows, columns = known.shape
    exact = truth(grid)[: 2 * rows, : 2 * columns].reshape(rows, 2, columns, 2).mean((1, 3))
    off = np.abs(grid.overview.heights - exact)[known]
    # next to its edges a file is continued by half a sample
    assert np.quantile(off, 0.99) < 0.6 and off.max() < 12.0


def test_metres_and_degrees_cannot_be_joined(tmp_path):
    np.savez(tmp_path / "m.npz", z=np.ones((8, 8)), crs="metres", west=0.0, east=1.0, south=0.0, north=1.0)
    with pytest.raises(WorldError, match=r'm\.npz has crs = "metres" and .*N46E008\.hgt lies by latitude'):
        read_elevation([tmp_path / "m.npz", write_hgt(tmp_path, 46, 8)])


def test_files_on_opposite_sides_are_refused(tmp_path):
    fine = plateau(tmp_path / "a.npz", 8.0, 8.00001, 46.0, 46.00001, (8, 8), 1.0)
    with pytest.raises(WorldError, match="together would be"):
        read_elevation([fine, plateau(tmp_path / "b.npz", 150.0, 151.0, 0.0, 1.0, (8, 8), 1.0)])


SCENE = '[terrain]\nsource = "file"\nfile = {}\n[place]\nlatitude = 46.5\nlongitude = 8.5\n'


def load(tmp_path, file):
    (tmp_path / "scene.toml").write_text(SCENE.format(file))
    return fs.load(tmp_path / "scene.toml")


@pytest.mark.parametrize(
    "file", ['["dem/N46E008.hgt", "dem/N46E009.hgt"]', '"dem/"', '"dem/*.hgt"', '"d?m/N46E00[89].*"']
)
def test_lists_folders_and_patterns(tmp_path, file):
    (tmp_path / "dem").mkdir()
    paths = [write_hgt(tmp_path / "dem", 46, west) for west in (8, 9)]
    (tmp_path / "dem" / "readme.txt").write_text("not heights")
    world = load(tmp_path, file)
    assert list(world.terrain.paths) == paths
    assert fs.loads(world.to_toml(), folder=tmp_path) == world and str(tmp_path) not in world.to_toml()
    assert fs.World(**world.model_dump()) == world and hash(world) is not None


def test_a_list_or_a_pattern_on_the_command_line(tmp_path, monkeypatch):
    (tmp_path / "dem").mkdir()
    paths = [write_hgt(tmp_path / "dem", 46, west) for west in (8, 9)]
    monkeypatch.chdir(tmp_path)
    for file in ("dem/*.hgt", "dem/", '["dem/N46E008.hgt", "dem/N46E009.hgt"]'):
        world = fs.load("orbit", ["terrain.source=file", f"terrain.file={file}"])
        assert list(world.terrain.paths) == paths
    assert list(fs.World(terrain={"source": "file", "file": paths}).terrain.paths) == paths


def test_a_pipe_in_a_folder(tmp_path):
    os.mkfifo(tmp_path / "N46E008.hgt")
    write_hgt(tmp_path, 46, 9)
    with pytest.raises(WorldError, match=r"N46E008\.hgt"):
        terrain_model(load(tmp_path, '"*.hgt"'))


def test_a_folder_of_terrarium_tiles(tmp_path):
    x, y = tile_of(46.5, 8.5, 10)
    tiles = [write_terrarium(tmp_path / "tiles", 10, x + i, y) for i in range(2)]
    (tmp_path / "tiles" / "10" / "loop").symlink_to(tmp_path / "tiles")
    (tmp_path / "tiles" / "10" / "7").symlink_to(tmp_path / "tiles" / "10")
    assert list(load(tmp_path, '"tiles/"').terrain.paths) == tiles
    assert list(load(tmp_path, '"tiles/10/*/*.png"').terrain.paths) == tiles


def test_shipped_and_own_files_in_one_list(tmp_path):
    plateau(tmp_path / "a.npz", -84.3, -84.2, 36.55, 36.65, (200, 200), 400.0)
    (tmp_path / "scene.toml").write_text(
        'extends = "jacksboro"\n[terrain]\nextent = 4e3\nfile = ["jacksboro", "a.npz"]\n'
    )
    world = fs.load(tmp_path / "scene.toml")
    assert world.terrain.names == ("jacksboro", str(tmp_path / "a.npz"))
    assert terrain_model(world).height(0.0, 0.0) == pytest.approx(400.0, abs=8.0)


@pytest.mark.parametrize(
    ("file", "expected"),
    [
        ('"../dem.hgt"', "leaves the scene's folder"),
        ('["a.npz", "../dem.hgt"]', "leaves the scene's folder"),
        ('"/etc/*.hgt"', "leaves the scene's folder"),
        ('"../*/a.npz"', "leaves the scene's folder"),
        ('"out/*.npz"', "leads out of"),
        ('"out/"', "leads out of"),
        ('"none/*.npz"', "holds no elevation file"),
        ('"empty/"', "holds no elevation file"),
        ('"**/a.npz"', "** is not allowed"),
        ('["a.npz", "b.npz"]', "no such file"),
        ("[]", "1 to 256 files"),
        ('["a.npz", ""]', "empty name"),
        ('["a.npz", 3]', "a list of paths"),
        ('[["a.npz"]]', "a list of paths"),
        ("7", "a path or a list of paths"),
        ('"a.npz\\u0000"', "NUL"),
        ('["a.npz\\u0000"]', "NUL"),
    ],
)
def test_what_a_scene_may_not_name(tmp_path, file, expected):
    (tmp_path / "scene").mkdir()
    (tmp_path / "scene" / "empty").mkdir()
    (tmp_path / "scene" / "out").mkdir()
    plateau(tmp_path / "secret.npz", 8.0, 9.0, 46.0, 47.0, (8, 8), 1.0)
    plateau(tmp_path / "scene" / "a.npz", 8.0, 9.0, 46.0, 47.0, (8, 8), 1.0)
    (tmp_path / "scene" / "out" / "link.npz").symlink_to(tmp_path / "secret.npz")
    with pytest.raises(WorldError) as caught:
        load(tmp_path / "scene", file)
    message = str(caught.value)
    assert expected in message and "scene.toml" in message and "terrain.file" in message
    assert "\n" not in message and len(message) < 700


@pytest.mark.parametrize("reach", [1e-9, 1e9, 1e300])
def test_samples_absurdly_near_or_far(tmp_path, reach):
    edges = {"west": -reach, "east": reach, "south": -reach, "north": reach}
    np.savez(tmp_path / "a.npz", z=np.ones((8, 8)), crs="metres", **edges)
    with pytest.raises(WorldError, match=r"a\.npz: its samples are .* apart; allowed are 0.01 m to 1000 km"):
        terrain_model(load(tmp_path, '"a.npz"'))


def test_too_many_files(tmp_path, monkeypatch):
    monkeypatch.setattr("fallstreak.world.files.MOST", 3)
    for index in range(5):
        (tmp_path / f"{index}.npz").touch()
    with pytest.raises(WorldError, match="more than 3 files"):
        load(tmp_path, '"./"')
    with pytest.raises(WorldError, match="more than 3 files"):
        load(tmp_path, '["0.npz", "[123].npz"]')


def test_check_says_what_was_filled(tmp_path):
    write_hgt(tmp_path, 46, 8, void=(slice(0, 9), slice(0, 9)))
    (tmp_path / "scene.toml").write_text(SCENE.format('"N46E008.hgt"'))
    command = [sys.executable, "-m", "fallstreak", "check", str(tmp_path / "scene.toml")]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0 and done.stdout.startswith("ok ")
    assert done.stderr.count("\n") == 1 and "81 samples hold no height" in done.stderr
    (tmp_path / "N46E008.hgt").write_bytes(b"short")
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 2 and done.stderr.count("\n") == 1 and "5 bytes are no SRTM tile" in done.stderr


@pytest.mark.skipif(os.geteuid() == 0, reason="root reads everything")
def test_a_file_that_may_not_be_read(tmp_path):
    path = write_hgt(tmp_path, 46, 8)
    path.chmod(0)
    with pytest.raises(WorldError, match="cannot be read"):
        read_elevation(path)
