"""Tone maps are monotone, stay in the gamut and equal their float64 twins; dithering hides steps and
keeps the mean.
"""

import numpy as np
import pytest

from fallstreak.frame import model
from fallstreak.frame.exposure import Exposure, add_exposure_buffer
from fallstreak.frame.tonemap import ToneMap
from fallstreak.world.film import Film

from .probes import evaluate, new_graph, picture, set_view

MAPS = ("agx", "neutral")


def colours(n=4000):
    rng = np.random.default_rng(2)
    return np.exp2(rng.uniform(-12, 6, (n, 3)))


@pytest.mark.parametrize("name", MAPS)
def test_grey_stays_grey_and_rises(name):
    grey = np.exp2(np.linspace(-14, 12, 2000))[:, None] * np.ones(3)
    out = model.TONE_MAPS[name](grey)
    assert np.ptp(out, axis=1).max() < 1e-9
    assert (np.diff(out[:, 0]) >= -1e-12).all()
    assert out.min() >= 0 and out.max() <= 1


@pytest.mark.parametrize("name", MAPS)
def test_colours_stay_in_the_gamut_and_brighten(name):
    out = model.TONE_MAPS[name](colours())
    assert out.min() >= -1e-9 and out.max() <= 1 + 1e-9
    brighter = model.TONE_MAPS[name](colours() * 1.1)
    assert ((brighter - out) @ model.LUMINANCE > -1e-6).all()


def test_published_points():
    # AgX: middle grey lands in the middle of the signal; six and a half stops above it is white
    assert model.agx(np.full(3, 0.18)) == pytest.approx(0.5**2.2, rel=1e-6)
    assert model.agx(np.full(3, 0.18 * 2**6.5)) == pytest.approx(1, abs=1e-6)
    # Neutral: what is darker than 0.76 loses only the 4 % that a dielectric mirrors
    assert model.neutral([0.5, 0.3, 0.2]) == pytest.approx([0.46, 0.26, 0.16])
    assert model.neutral([0.04, 0.04, 0.04]) == pytest.approx(6.25 * 0.04**2)
    # sRGB: IEC 61966-2-1
    assert model.srgb_encode([0.0, 0.0031308, 0.2140411, 1.0]) == pytest.approx(
        [0.0, 0.04045, 0.5, 1.0], abs=1e-5
    )


@pytest.mark.parametrize("name", [*MAPS, "srgb"])
def test_the_shader_equals_the_model(device, name):
    values = colours() if name != "srgb" else colours() / 64
    expected = (model.TONE_MAPS | {"srgb": model.srgb_encode})[name](values)
    got = evaluate(device, "tones", values, flags={name.upper(): True})[:, :3]
    # a quarter of a step of 8 bits
    assert np.abs(got - expected).max() < 1e-3


def test_two_curves_in_one(device):
    signal = np.linspace(0.0, 1.0, 3000).reshape(-1, 3)
    got = evaluate(device, "tones", signal, flags={"GAMMA": True})[:, :3]
    assert np.abs(got - model.srgb_encode(signal**2.2)).max() < 1e-4


@pytest.mark.parametrize("look", ["medium", "punchy"])
def test_looks(device, look):
    values = colours()
    flags = {"AGX": True, "GRADED": True}
    got = evaluate(device, "tones", values, flags=flags, constants={"LOOK": model.AGX_LOOKS[look]})
    assert np.abs(got[:, :3] - model.agx(values, look)).max() < 1e-3
    assert model.agx(np.full(3, 0.18), "medium") == pytest.approx(0.18, abs=0.01)


def test_night_takes_colour_from_the_dark_only(device):
    values = colours() * 2.0 ** np.random.default_rng(3).uniform(-10, 4, (4000, 1))
    expected = model.night_vision(values)
    assert np.allclose(
        evaluate(device, "tones", values, flags={"NIGHT": True})[:, :3], expected, rtol=3e-3, atol=1e-7
    )
    dark, bright = np.array([2.0, 1.0, 0.5]) * 1e-4, np.array([2.0, 1.0, 0.5]) * 1e2
    assert np.allclose(model.night_vision(bright), bright)
    seen = model.night_vision(dark)
    assert seen[2] / seen[0] > 2 * dark[2] / dark[0]
    # white keeps its luminance
    white = np.full(3, 1e-4)
    assert model.night_vision(white) @ model.LUMINANCE == pytest.approx(1e-4, rel=0.02)


def develop(device, data, bits=8, **film):
    """A picture whose 1.0 is the sensor's saturation, through the film."""
    graph = new_graph(device)
    size = picture(graph, data, "frame.resolved")
    film = Film(exposure="fixed", ev100=14.0, look="base", **{"white_balance": 6504.0, **film})
    add_exposure_buffer(graph)
    exposure = Exposure(graph, film, size)
    ToneMap(graph, film, size, bits=bits)
    graph.output("frame.ldr")
    graph.compile()
    set_view(graph, size=size)
    exposure.begin(0.5)
    graph.execute()
    return graph.read("frame.ldr")[..., :3]


@pytest.mark.parametrize("name", ["agx", "neutral", "none"])
def test_the_whole_film(device, name):
    data = colours(128 * 72).reshape(72, 128, 3).astype(np.float16).astype(float)
    expected = model.srgb_encode(model.TONE_MAPS[name](data @ model.white_balance(6504.0).T))
    got = develop(device, data, tone_map=name, dither=False, night_vision=False)
    assert np.abs(got / 255 - expected).max() < 0.6 / 255
    deep = develop(device, data, bits=16, tone_map=name, dither=False, night_vision=False)
    assert deep.dtype == np.uint16
    assert np.abs(deep / 65535 - expected).max() < 6e-4


def test_white_balance(device):
    # CIE 015: D50, D55, D75
    daylight = {5000: (0.3457, 0.3585), 5500: (0.3324, 0.3474), 7504: (0.2990, 0.3149)}
    for kelvin, (x, y) in daylight.items():
        light = np.linalg.inv(model.RGB_TO_XYZ) @ (x / y, 1.0, (1 - x - y) / y)
        seen = model.white_balance(kelvin) @ light
        assert seen == pytest.approx(np.ones(3), abs=0.006)
    assert model.white_balance(6504.0) == pytest.approx(np.eye(3), abs=0.002)
    # the sun above the air is nearly daylight of 5900 K, and white on a camera's usual film
    data = np.broadcast_to([0.30, 0.25, 0.22], (72, 128, 3))
    for kelvin in (4000.0, 5500.0, 20000.0):
        got = develop(
            device, data, tone_map="none", dither=False, night_vision=False, white_balance=kelvin
        ).mean((0, 1))
        balanced = data[0, 0].astype(np.float16).astype(float) @ model.white_balance(kelvin).T
        assert got / 255 == pytest.approx(model.srgb_encode(np.clip(balanced, 0, 1)), abs=1.2e-3 + 0.5 / 255)


def test_noise_is_triangular_and_centred(device):
    y, x = np.mgrid[0:72, 0:128]
    values = np.stack([x, y, np.full_like(x, 5)], -1).reshape(-1, 3) + np.array([0.5, 0.5, 0])
    got = evaluate(device, "tones", values, flags={"DITHER": True})[:, 0]
    expected = model.triangular_noise(x, y, 5).ravel()
    # float32 blurs the fraction of a large number
    assert np.abs(got - expected).mean() < 0.03
    noise = model.triangular_noise(*np.meshgrid(np.arange(512), np.arange(512)))
    assert abs(noise.mean()) < 2e-3
    assert noise.var() == pytest.approx(1 / 6, rel=0.02)


def test_dithering_keeps_the_mean_and_removes_bands(device):
    # a ramp of four code values over 128 pixels, as a dusk sky has it
    code = np.broadcast_to(np.linspace(99.0, 103.0, 128), (72, 128))
    signal = code / 255
    linear = np.where(signal <= 0.04045, signal / 12.92, ((signal + 0.055) / 1.055) ** 2.4)
    data = np.repeat(linear[..., None], 3, -1)
    exact = model.srgb_encode(data.astype(np.float16).astype(float)) * 255
    film = {"tone_map": "none", "night_vision": False}
    plain = develop(device, data, dither=False, **film).astype(float)
    noisy = develop(device, data, dither=True, **film).astype(float)

    def bands(values):
        """Greatest error of a column's mean over 9 neighbours: what the eye sees as a step."""
        error = (values - exact).mean((0, 2))
        return np.abs(np.convolve(error, np.ones(9) / 9, "valid")).max()

    assert abs((noisy - exact).mean()) < 0.02
    assert bands(plain) > 0.3
    assert bands(noisy) < 0.08
