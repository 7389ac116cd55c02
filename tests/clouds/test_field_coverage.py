"""Coverage: as much of the sky as was asked for, maps from files, files that are refused."""

from __future__ import annotations

import numpy as np
import pytest
from PIL import Image

import fallstreak as fs
from fallstreak.clouds.field import field_of
from fallstreak.clouds.field.calibration import _shipped, calibrate, key_of
from fallstreak.clouds.field.coverage import read_coverage
from fallstreak.clouds.genera import GENERA

from .stage import Stage

ASKED = (0.1, 0.25, 0.5, 0.75, 0.9, 1.0)
HEIGHTS = 14


def covered(sky, places, time=4321.0):
    """Whether the sky over map places (n, 2) is covered by the first layer."""
    field = field_of(sky)
    low, high = field.layers[0].bounds
    height = low + (np.arange(HEIGHTS) + 0.5) * (high - low) / HEIGHTS
    points = np.column_stack([np.repeat(places, HEIGHTS, 0), np.tile(height, len(places))])
    depth = field.extinction(points, time).reshape(-1, HEIGHTS).sum(1) * (high - low) / HEIGHTS
    return depth > field.layers[0].genus.visible_depth


def scattered(cell, side=34):
    """A place in each of many cells that lie apart, so that patches even out."""
    i, j = np.meshgrid(np.arange(side), np.arange(side))
    random = np.random.default_rng(5).uniform(size=(side * side, 2))
    return (np.stack([i.ravel(), j.ravel()], 1) * 7.3 + random) * cell


@pytest.mark.parametrize("genus", GENERA)
def test_the_sky_is_covered_as_asked(genus):
    """Within .05, of which sampling here is .015 (one standard deviation)."""
    places = scattered(GENERA[genus].cell)
    for asked in ASKED:
        sky = fs.World(clouds={"layers": [{"genus": genus, "coverage": asked}]})
        assert covered(sky, places).mean() == pytest.approx(asked, abs=0.05), asked


def test_oktas_count_and_none_is_none():
    places = scattered(GENERA["stratocumulus"].cell, 20)
    sky = fs.World(clouds={"layers": [{"genus": "stratocumulus", "oktas": 4}]})
    assert covered(sky, places).mean() == pytest.approx(0.5, abs=0.08)
    sky = fs.World(clouds={"layers": [{"genus": "stratocumulus", "coverage": 0.0}]})
    assert not covered(sky, places).any()


def test_more_is_covered_where_more_is_asked_for():
    places = scattered(GENERA["cumulus_humilis"].cell, 20)
    skies = [fs.World(clouds={"layers": [{"coverage": c, "genus": "cumulus_humilis"}]}) for c in (0.3, 0.4)]
    few, many = (covered(sky, places) for sky in skies)
    assert few.sum() < many.sum()
    assert (few & ~many).mean() < 0.01  # the same clouds, and others


@pytest.mark.parametrize("genus", GENERA)
def test_the_shipped_calibration_is_that_of_these_genera_and_models(genus):
    """If this fails, run script/calibrate_clouds.py."""
    layer = field_of(fs.World(clouds={"layers": [{"genus": genus}]})).layers[0]
    assert key_of(layer) in _shipped()


def test_another_layer_is_calibrated_anew():
    sky = fs.World(clouds={"layers": [{"genus": "cumulus_humilis", "thickness": 700.0, "coverage": 0.5}]})
    assert key_of(field_of(sky).layers[0]) not in _shipped()
    assert covered(sky, scattered(1120.0, 24)).mean() == pytest.approx(0.5, abs=0.07)


def test_the_shipped_calibration_is_that_of_the_code():
    layer = field_of(fs.World(clouds={"layers": [{"genus": "stratus"}]})).layers[0]
    fresh, kept = calibrate(layer, 30), _shipped()[key_of(layer)]
    np.testing.assert_allclose(fresh.knots, kept.knots, rtol=0.08, atol=0.15)
    np.testing.assert_allclose(fresh.profile[:, -1], kept.profile[:, -1], rtol=0.3, atol=0.05)


# ---- maps ------------------------------------------------------------------------------------------------


def sky_with(path, **more):
    layer = {"genus": "stratocumulus", "coverage": 1.0, "clustering": 0.0, "coverage_map": str(path), **more}
    return fs.World(clouds={"layers": [layer]}, place={"latitude": 45.0, "longitude": 10.0})


def half(path, bits=8):
    """White in the west, black in the east."""
    top = 255 if bits == 8 else 65535
    pixels = np.zeros((40, 80), np.uint8 if bits == 8 else np.uint16)
    pixels[:, :40] = top
    Image.fromarray(pixels).save(path)


@pytest.mark.parametrize("bits", [8, 16])
def test_a_picture_covers_where_it_is_white(tmp_path, bits):
    half(tmp_path / "map.png", bits)
    sky = sky_with(tmp_path / "map.png", coverage_extent=80e3)
    random = np.random.default_rng(0).uniform(-1.0, 1.0, (300, 2)) * np.array([14e3, 15e3])
    west, east = (random + np.array([middle, 0.0]) for middle in (-20e3, 20e3))
    assert covered(sky, west, 0.0).mean() > 0.95 and covered(sky, east, 0.0).mean() == 0.0


def test_the_shaders_read_the_same_map(tmp_path, device):
    half(tmp_path / "map.png")
    stage = Stage(device, sky_with(tmp_path / "map.png", coverage=0.7, coverage_extent=40e3))
    cells = stage.window_cells(0, 3000.0, 0.0, 600.0)
    want = stage.field.clouds(0, cells, 600.0)["formation"]
    got = stage.look(3000.0, 0.0, 600.0)[0][0].ravel()["formation"]
    assert 0.1 < (want > 0).mean() < 0.9
    np.testing.assert_allclose(got, want, atol=1e-3)


def test_sidecars_and_arrays_say_where_a_map_lies(tmp_path):
    half(tmp_path / "a.png")
    (tmp_path / "a.toml").write_text(
        'crs = "metres"\nwest = 1e4\neast = 5e4\nsouth = -1e4\nnorth = 1e4\n', encoding="utf-8"
    )
    values = np.tile(np.where(np.arange(80) < 40, 1.0, 0.0), (41, 1))
    metres = {"east": np.linspace(10.25e3, 49.75e3, 80), "north": np.linspace(1e4, -1e4, 41)}
    degree = np.pi / 180.0 * 6_371_000.0
    degrees = {
        "lon": 10.0 + metres["east"] / (degree * np.cos(np.radians(45.0))),
        "lat": 45.0 + metres["north"] / degree,
    }
    np.savez(tmp_path / "b.npz", coverage=values, **metres)
    np.savez(tmp_path / "c.npz", coverage=values, **degrees)
    for name in ("a.png", "b.npz", "c.npz"):
        plan = read_coverage(sky_with(tmp_path / name), 0)
        np.testing.assert_allclose(plan.at(np.array([12e3, 25e3, 35e3, 48e3]), 0.0), [1, 1, 0, 0], atol=0.02)
        assert plan.at(30e3, 0.0) == pytest.approx(0.5, abs=0.15)
        # outside there is the mean
        np.testing.assert_allclose(
            plan.at(np.array([-3e5, 3e5, 0.0]), np.array([0.0, 0.0, 4e5])), 0.5, atol=0.02
        )


def test_north_is_up(tmp_path):
    pixels = np.zeros((20, 20), np.uint8)
    pixels[:10] = 255
    Image.fromarray(pixels).save(tmp_path / "north.png")
    np.savez(tmp_path / "north.npz", coverage=pixels / 255.0)
    for name in ("north.png", "north.npz"):
        plan = read_coverage(sky_with(tmp_path / name, coverage_extent=2e4), 0)
        np.testing.assert_allclose(plan.at(0.0, np.array([6e3, -6e3])), [1.0, 0.0], atol=0.02)


def write(path, **arrays):
    np.savez(path, **arrays)


BAD = {
    "colour.png": (
        lambda p: Image.fromarray(np.zeros((4, 4, 3), np.uint8)).save(p),
        "its pixels are RGB; coverage is read from grey PNG",
    ),
    "broken.png": (lambda p: p.write_bytes(b"\x89PNG\r\n\x1a\nnothing"), "not a readable PNG"),
    "map.jpg": (lambda p: p.write_bytes(b"x"), "coverage is read from .png and .npz"),
    "other.npz": (lambda p: write(p, cloud=np.ones((3, 3))), "has no array coverage; it holds cloud"),
    "range.npz": (lambda p: write(p, coverage=np.full((3, 3), 7.5)), "from 7.5 to 7.5; allowed is 0 to 1"),
    "nan.npz": (lambda p: write(p, coverage=np.full((3, 3), np.nan)), "not finite"),
    "flat.npz": (lambda p: write(p, coverage=np.ones(3)), "must be numbers in 2 dimensions"),
    "text.npz": (lambda p: write(p, coverage=np.array([["a"]])), "must be numbers in 2 dimensions"),
    "alone.npz": (
        lambda p: write(p, coverage=np.ones((3, 3)), east=np.arange(3.0)),
        "has no array north, though it has east",
    ),
    "axis.npz": (
        lambda p: write(p, coverage=np.ones((3, 3)), east=np.array([0.0, 2.0, 1.0]), north=np.arange(3.0)),
        "east has 3 values; it must have 3, all rising or all falling",
    ),
    "pole.npz": (
        lambda p: write(p, coverage=np.ones((2, 2)), lon=np.arange(2.0), lat=np.array([80.0, 95.0])),
        "latitudes lie in -90 to 90",
    ),
    "zip.npz": (lambda p: p.write_bytes(b"PK\x03\x04"), "not a readable .npz"),
}


@pytest.mark.parametrize("name", BAD)
def test_a_wrong_map_is_refused_in_a_sentence(tmp_path, name):
    make, told = BAD[name]
    make(tmp_path / name)
    with pytest.raises(fs.WorldError) as refused:
        field_of(sky_with(tmp_path / name))
    message = str(refused.value)
    assert told in message and name in message and "clouds.layers[0].coverage_map" in message
    assert "\n" not in message


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("west = 1\n", "has no east"),
        ("west = 2\neast = 1\nsouth = 0\nnorth = 1\n", "west must be less than east"),
        ("west = 0\neast = 400\nsouth = 0\nnorth = 1\n", "longitudes must span at most 360"),
        ('west = "a"\neast = 1\nsouth = 0\nnorth = 1\n', 'west = "a"; it must be a number'),
        ("left = 1\n", '"left" is not known'),
        ('crs = "utm"\n', "geographic"),
        ("west = [", "not readable as TOML"),
    ],
)
def test_a_wrong_sidecar_is_refused_in_a_sentence(tmp_path, text, told):
    half(tmp_path / "map.png")
    (tmp_path / "map.toml").write_text(text, encoding="utf-8")
    with pytest.raises(fs.WorldError, match=r"map\.toml") as refused:
        field_of(sky_with(tmp_path / "map.png"))
    assert told in str(refused.value)
