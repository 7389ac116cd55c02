"""The meter reads known pictures right, and the exposure follows."""

import numpy as np
import pytest

from fallstreak.frame import model
from fallstreak.frame.exposure import Exposure, add_exposure_buffer
from fallstreak.gpu import EXPOSURE
from fallstreak.world.film import Film

from .probes import SIZE, new_graph, picture


class Meter:
    """A meter before a fixed picture, given in cd/m²."""

    def __init__(self, device, luminance, start=10.0, **film):
        self.graph = new_graph(device)
        self.film = Film(**film)
        # the first frame's pre-exposure is that of the guess, or of the fixed exposure
        scale = float(model.auto_scale(model.guess_luminance(np.radians(start)), self.film.compensation))
        if self.film.exposure == "fixed":
            scale = float(model.scale_from_ev100(self.film.ev100 - self.film.compensation))
        data = np.broadcast_to(np.asarray(luminance, float)[..., None], (SIZE[1], SIZE[0], 3)) * scale
        picture(self.graph, data, "frame.resolved")
        add_exposure_buffer(self.graph)
        self.exposure = Exposure(self.graph, self.film, SIZE)
        self.graph.output("frame.exposure")
        self.graph.compile()
        self.exposure.begin(np.radians(start))

    def step(self, delta=0.0, instant=True):
        self.exposure.update(delta, instant=instant)
        self.graph.execute()
        return self.graph.read("frame.exposure").view(np.uint8)[: EXPOSURE.size].view(EXPOSURE.dtype)[0]


@pytest.mark.parametrize("luminance", [3e-3, 1.0, 40.0, 4000.0])
def test_a_grey_wall(device, luminance):
    got = Meter(device, luminance, start=-8.0 if luminance < 10 else 10.0).step()
    assert got["luminance"] == pytest.approx(luminance, rel=0.01)
    assert got["scale"] == pytest.approx(float(model.auto_scale(luminance)), rel=0.01)
    assert got["ev100"] == pytest.approx(float(model.ev100_from_scale(got["scale"])), abs=1e-3)


def test_the_key_falls_in_the_dark():
    luminance = np.logspace(-4, 5, 50)
    key = model.exposure_key(luminance)
    assert (np.diff(key) > 0).all()
    assert model.exposure_key(4000.0) == pytest.approx(0.18)
    # a moonless night is printed two to three stops under grey
    assert 2 < np.log2(0.18 / model.exposure_key(5e-4)) < 3


def test_compensation_and_fixed(device):
    plain, brighter = Meter(device, 500.0).step(), Meter(device, 500.0, compensation=1.5).step()
    assert np.log2(brighter["scale"] / plain["scale"]) == pytest.approx(1.5, abs=1e-3)
    fixed = Meter(device, 500.0, exposure="fixed", ev100=12.0).step()
    assert fixed["ev100"] == pytest.approx(12.0, abs=1e-3)
    assert fixed["scale"] == pytest.approx(1 / (1.2 * 2**12), rel=1e-4)


def test_the_sun_and_space_do_not_count(device):
    scene = np.full((SIZE[1], SIZE[0]), 3000.0)
    alone = Meter(device, scene).step()["luminance"]
    sun = scene.copy()
    sun[30:33, 60:63] = 1e8
    assert Meter(device, sun).step()["luminance"] == pytest.approx(alone, rel=0.05)
    space = scene.copy()
    space[:40] = 0.02
    assert Meter(device, space).step()["luminance"] == pytest.approx(alone, rel=0.05)
    black = scene.copy()
    black[:40] = 0.0
    assert Meter(device, black).step()["luminance"] == pytest.approx(alone, rel=0.05)


def test_the_middle_counts_most(device):
    y, x = np.mgrid[-1 : 1 : SIZE[1] * 1j, -1 : 1 : SIZE[0] * 1j]
    middle = np.where(np.hypot(x, y) < 0.6, 1000.0, 100.0)
    edge = np.where(np.hypot(x, y) < 0.6, 100.0, 1000.0)
    share = (middle == 1000.0).mean()
    assert share < 0.5
    got = [np.log10(Meter(device, s).step()["luminance"]) - 2 for s in (middle, edge)]
    # weight of the middle is more than its area
    assert got[0] > share * 1.15 and 1 - got[1] > share * 1.15


def test_two_runs_meter_alike(device):
    scene = np.exp2(np.random.default_rng(4).uniform(-4, 12, (SIZE[1], SIZE[0])))
    assert Meter(device, scene).step()["scale"] == Meter(device, scene).step()["scale"]


def test_adaptation_takes_time_and_closes_faster_than_it_opens(device):
    def half_way(luminance):
        meter = Meter(device, luminance, start=10.0)
        goal = np.log2(float(model.auto_scale(luminance)))
        begin = np.log2(float(model.auto_scale(model.guess_luminance(np.radians(10.0)))))
        return (np.log2(meter.step(0.2, instant=False)["scale"]) - begin) / (goal - begin)

    assert half_way(4e4) == pytest.approx(1 - np.exp(-0.2 / 0.4), rel=0.05)
    assert half_way(3.0) == pytest.approx(1 - np.exp(-0.2 / 1.6), rel=0.05)


def test_no_light_at_all_is_no_nonsense(device):
    got = Meter(device, 0.0, start=-30.0).step()
    assert np.isfinite(got["scale"]) and got["scale"] > 0
