"""``fallstreak noise``: the picture it draws, and what it says to a wrong word."""

from __future__ import annotations

import numpy as np
import pytest
from PIL import Image

from fallstreak import noise
from fallstreak.cli import main
from fallstreak.commands.noise import COLORS, colour

SMALL = ("--size", "48x32")


@pytest.fixture
def draw(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)

    def run(*words):
        status = main(["noise", *words])
        captured = capsys.readouterr()
        return status, captured.out, captured.err

    return run


def test_the_picture_is_the_noise(draw):
    status, out, err = draw("-o", "a.png", *SMALL, "--seed", "4", "--octaves", "3", "--range=-1,1")
    assert (status, err) == (0, "")
    assert "a.png: perlin, 3 octaves of fbm, 48×32 on the CPU; -1 is black, 1 white" in out
    picture = np.asarray(Image.open("a.png"))
    expected = noise.grid((1, 32, 48), step=8 / 48, origin=(0, 0, 0.37), octaves=3, seed=4)[0]
    assert picture.shape == (32, 48) and picture.dtype == np.uint8
    assert np.abs(picture / 255.0 * 2 - 1 - expected).max() < 0.0045


def test_without_a_range_it_goes_from_black_to_white(draw):
    assert draw("-o", "a.png", *SMALL)[0] == 0
    picture = np.asarray(Image.open("a.png"))
    assert picture.min() == 0 and picture.max() == 255


def test_16_bits_and_colours(draw):
    assert draw("-o", "a.png", *SMALL, "--bits", "16")[0] == 0
    assert np.asarray(Image.open("a.png")).max() == 65535
    assert draw("-o", "b.png", *SMALL, "--colors", "land")[0] == 0
    assert np.asarray(Image.open("b.png")).shape == (32, 48, 3)


@pytest.mark.parametrize("colors", COLORS)
def test_colours_go_from_the_first_to_the_last(colors):
    values = np.array([[-3.0, 0.0, 1.0, 9.0]])
    pixels = colour(values, 0.0, 1.0, colors, 8)
    pixels = pixels if pixels.ndim == 3 else np.repeat(pixels[..., None], 3, -1)
    assert pixels[0].tolist() == [list(COLORS[colors][i]) for i in (0, 0, -1, -1)]


def test_a_period_makes_a_tile(draw):
    assert draw("-o", "a.png", "--size", "64x64", "--period", "4", "--octaves", "4")[0] == 0
    picture = np.asarray(Image.open("a.png")).astype(int)
    assert np.abs(picture[0] - picture[-1]).mean() < 2 * np.abs(np.diff(picture, axis=0)).mean()
    assert np.abs(picture[:, 0] - picture[:, -1]).mean() < 2 * np.abs(np.diff(picture, axis=1)).mean()


@pytest.mark.parametrize("dims", ["2", "3", "4"])
def test_planes_of_every_dimension(draw, dims):
    assert draw("-o", "a.png", *SMALL, "--dims", dims)[0] == 0


def test_warped_smooth_and_far_away(draw):
    words = ("--warp", "1.5", "--octaves", "5", "--smooth", "--at", "1e7,0,0.5")
    assert draw("-o", "a.png", *SMALL, *words)[0] == 0


def test_the_gpu_draws_the_same(draw, device):
    words = (*SMALL, "--octaves", "4", "--seed", "3", "--range=-1,1")
    assert draw("-o", "a.png", *words)[0] == 0
    status, out, _ = draw("-o", "b.png", *words, "--gpu")
    assert status == 0 and f"on {device.adapter.name}" in out
    cpu, gpu = (np.asarray(Image.open(name)).astype(int) for name in ("a.png", "b.png"))
    assert np.abs(cpu - gpu).max() <= 1


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--kind", "perln"), "--kind='perln' is not allowed: it must be perlin, "),
        (("--fractal", "fmb"), "(did you mean 'fbm'?)"),
        (("--octaves", "0"), "--octaves=0 is not allowed: it must be an integer from 1 to 32"),
        (("--seed", "-1"), "--seed=-1 is not allowed"),
        (("--dims", "5"), "--dims 5 is not allowed: it must be 2, 3 or 4"),
        (("--dims", "4", "--kind", "value"), "--kind='value' is not allowed with points in 4 dimensions"),
        (("--size", "9"), "WIDTHxHEIGHT"),
        (("--size", "9x9000"), "each side must be 16 to 8192 pixels"),
        (("--bits", "12"), "--bits 12 is not allowed: it must be 8 or 16"),
        (("--colors", "red"), "--colors red is not allowed: it must be grey, signed, fire, land"),
        (("--range=1,-1",), "--range 1,-1 is empty"),
        (("--range=nan,1",), "--range nan,1 is not allowed: write 2 numbers"),
        (("--at", "1,2"), "--at 1,2 is not allowed: write 3 numbers with commas between them"),
        (("--frequency", "0"), "--frequency 0 is not allowed"),
        (("--frequency", "nan"), "--frequency nan is not allowed"),
        (("--lacunarity", "1.5", "--period", "4", "--octaves", "2"), "must be an integer"),
        (("--warp", "inf"), "--warp=inf is not allowed"),
        (("--warp", "1", "--fractal", "ridged"), "--warp does not go with --fractal ridged"),
        (("-o", "a.jpg"), "-o a.jpg is not a PNG"),
        (("-o", "nowhere/a.png"), "there is no folder nowhere"),
        (("--kind",), "--kind"),
        (("--nonesuch", "1"), "--nonesuch"),
    ],
)
def test_mistakes_are_one_sentence_and_exit_status_2(draw, tmp_path, words, message):
    given = () if "-o" in words else ("-o", "a.png")
    status, out, err = draw(*given, *(() if "--size" in words else SMALL), *words)
    assert status == 2 and out == "" and message in err and err.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


def test_help_teaches(draw):
    status, out, _ = draw("--help")
    assert status == 0
    for word in ("perlin", "ridged", "Examples:", "cells.png", "--smooth", "copies"):
        assert word in out
    assert "frequency" in out
