"""Light on clouds: the sky's own sun, sky and ground, seen through the air, over the picture."""

import numpy as np
import pytest

from .cloud_stage import CloudStage, coded

SIZE = (64, 36)
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


def full(key, ambient, distance=500.0, opacity=1.0, size=SIZE):
    return coded(key, ambient, distance, np.full(size[::-1], opacity))


def test_no_cloud_changes_nothing(device):
    nothing = CloudStage(device, full(0, 0, opacity=0.0))
    over = CloudStage(device, full(1, 1, opacity=0.5))
    sky = nothing.frame()
    assert np.all(sky > 500)
    half = over.frame()
    cloud = CloudStage(device, full(1, 1)).frame()
    assert half == pytest.approx((sky + cloud) / 2, rel=5e-3)


def test_white_in_the_sun_is_what_the_sky_gives(device):
    """E / π, with E the sun's through the air above."""
    got = CloudStage(device, full(1, 0)).frame() - CloudStage(device, full(0, 0)).frame()
    lux = got.mean((0, 1)) @ LUMINANCE * np.pi
    # sun at 50°: 133 klx less what 1.3 air masses of clear air take
    assert 95e3 < lux < 115e3
    assert np.ptp(got @ LUMINANCE) < 0.01 * got.max()


def test_colours_of_day_and_dusk(device):
    lit, shade = CloudStage(device, full(0.8, 0.8)), CloudStage(device, full(0.02, 0.7))
    noon, evening = lit.frame()[18, 32], lit.frame(sun=(1.0, 270.0))[18, 32]
    assert noon[2] / noon[0] == pytest.approx(1.0, abs=0.25)  # white
    assert evening[0] / evening[2] > 1.8  # orange
    dark = shade.frame(sun=(1.0, 270.0))[18, 32]
    assert dark[2] / dark[0] > 0.8 * noon[2] / noon[0]  # shade keeps the blue
    assert dark @ LUMINANCE < 0.5 * evening @ LUMINANCE


def test_high_clouds_glow_when_the_land_is_dark(device):
    """The sun 2° under the horizon reaches clouds at 10 km, not those at 1 km."""
    high = CloudStage(device, full(1, 0, 12e3))
    low = CloudStage(device, full(1, 0, 1.2e3))
    options = {"sun": (-2.0, 270.0), "pitch": 55.0, "scale": 1e-1}
    assert high.frame(**options)[18, 32] @ LUMINANCE > 3 * low.frame(**options)[18, 32] @ LUMINANCE


def test_a_full_moon_lights_them_at_night(device):
    stage, bare = CloudStage(device, full(0.8, 0.5)), CloudStage(device, full(0, 0, opacity=0.0))
    options = {"sun": (-40.0, 0.0), "moon": (50.0, 180.0), "scale": 1.0}
    moonlit, sky = (s.frame(**options)[18, 32] @ LUMINANCE for s in (stage, bare))
    assert moonlit == pytest.approx(0.8 * 0.25 / np.pi, rel=0.35)
    assert moonlit > 3 * sky


def test_far_clouds_fade_into_the_air(device):
    options = {"pitch": 4.0}
    near, far = (CloudStage(device, full(0.9, 0.8, d)).frame(**options)[18, 32] for d in (500.0, 80e3))
    air = CloudStage(device, full(0.0, 0.0, 80e3)).frame(**options)[18, 32]
    assert far[2] < near[2]
    assert (far - air)[2] < 0.6 * (near - air)[2]
    # blue light is lost first, red last
    assert (far - air)[0] / (far - air)[2] > 1.2 * near[0] / near[2]


def test_a_coarse_layer_is_the_same_where_it_is_smooth(device):
    fine = CloudStage(device, full(0.7, 0.6)).frame()
    coarse = CloudStage(device, full(0.7, 0.6, size=(32, 18))).frame()
    odd = CloudStage(device, full(0.7, 0.6, size=(33, 19)), size=(65, 37)).frame()
    assert coarse == pytest.approx(fine, rel=5e-3)
    assert odd[18, 32] == pytest.approx(fine[18, 32], rel=1e-2)


def test_seen_from_far_above(device):
    """Above the table of the air each pixel's air is marched; the picture does not jump there."""
    stage = CloudStage(device, full(0.8, 0.7, 30e3))
    below, above = (stage.frame(altitude=h, pitch=-50.0)[18, 32] for h in (19.9e3, 20.1e3))
    assert above == pytest.approx(below, rel=0.03)


def test_artists_colours_keep_their_hue_at_every_hour(device):
    """1 is as bright as white paper on level ground there, whatever colour the light has."""
    pink = np.broadcast_to(np.array([1.0, 0.6, 0.7, 1.0], np.float16), (*SIZE[::-1], 4))
    stage = CloudStage(device, full(1, 1), colour=pink)
    for sun in ((50.0, 180.0), (2.0, 180.0)):
        got = stage.frame(sun=sun)[18, 32]
        assert got[1] / got[0] == pytest.approx(0.6, abs=0.03)
        assert got[2] / got[0] == pytest.approx(0.7, abs=0.05)
