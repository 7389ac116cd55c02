"""The sprites' textures, and the command that bakes them and looks at models."""

from __future__ import annotations

import numpy as np
import pytest
from PIL import Image

from fallstreak.cli import main
from fallstreak.clouds.shapes import load
from fallstreak.clouds.shapes.portrait import SIDE as VIEW
from fallstreak.clouds.shapes.portrait import portrait
from fallstreak.clouds.sprites.bake import STEEPEST, write
from fallstreak.clouds.sprites.textures import COUNT, SHEET, SIDE, apart, sheet, together


def test_the_sheet_is_baked_again(tmp_path):
    """Byte for byte on the processor that baked it; others may round a texel otherwise."""
    write(tmp_path / "textures.png")
    baked, shipped = (np.asarray(Image.open(p), int) for p in (tmp_path / "textures.png", SHEET))
    assert np.abs(baked - shipped).max() <= 1


def test_textures_are_sixteen_different_ones():
    textures = sheet()
    assert textures.shape == (COUNT, SIDE, SIDE, 4) and textures.dtype == np.uint8
    assert np.array_equal(apart(together(textures)), textures)
    thick = textures[..., 2].reshape(COUNT, -1).astype(float)
    alike = np.corrcoef(thick) - np.eye(COUNT)
    assert np.abs(alike).max() < 0.5
    assert thick.mean(1) == pytest.approx(127.5, abs=6.0)


def test_opacity_is_none_at_the_rim_and_torn_before_it():
    opacity = sheet()[..., 3].astype(float)
    y, x = (np.mgrid[0:SIDE, 0:SIDE] + 0.5) * 2.0 / SIDE - 1.0
    radius = np.hypot(x, y)
    assert opacity[:, radius > 1.0].max() == 0.0
    ring = opacity[:, (radius > 0.6) & (radius < 0.7)]
    assert (ring.std(1) > 20.0).all() and (ring.min(1) < 30.0).all()


def test_slopes_are_those_of_the_thickness():
    textures = sheet().astype(float)
    right = (textures[..., 0] - 127.5) / 127.5 * -STEEPEST
    made = np.gradient(textures[..., 2] / 255.0, 1.0 / SIDE, axis=2)
    inside = np.abs(right) < 0.9 * STEEPEST
    assert np.abs(made - right)[inside].mean() < 0.25  # of 10; steps of 8 bits


def test_portraits_show_south_west_and_above():
    views = portrait(load(["cumulus_congestus_a"]))
    rows = views.shape[0]
    assert views.shape == (rows, 3 * VIEW)
    assert (views[-VIEW:, 2 * VIEW :] > 0).mean() > 0.3
    assert views[-10:, :VIEW].max() == 0  # nothing below its base


def test_clouds_bake_on_the_command_line(tmp_path, capsys):
    assert main(["clouds", "bake"]) == 0
    told = capsys.readouterr().out
    assert "16 textures" in told
    rows = [line.split() for line in told.splitlines()[1:17]]
    assert [int(row[0]) for row in rows] == list(range(16))
    assert [row[1] for row in rows[::4]] == ["heaps", "lumps", "veil", "fibres"]
    assert all(0.1 < float(row[2]) < 0.9 and int(row[3].replace(",", "")) > 1000 for row in rows)
    picture = tmp_path / "humilis.png"
    assert main(["clouds", "bake", "cumulus_humilis_a", "-o", str(picture)]) == 0
    assert "12 boxes" in capsys.readouterr().out
    assert Image.open(picture).size[0] == 3 * VIEW
    bad = tmp_path / "bad.toml"
    bad.write_text('title = "bad"\nboxes = [{ centre = [0, 0, 0], size = [9, 9, 9], group = 99 }]')
    assert main(["clouds", "bake", str(bad)]) == 2
    told = capsys.readouterr().err
    assert "bad.toml, line 2: box 1, group = 99" in told and told.count("\n") == 1
    assert main(["clouds", "bake", "-o", "x.jpg"]) == 2
