"""Land under clouds: an overcast sky's white light and no shadows, broken clouds' shadows, air that dims."""

from types import SimpleNamespace

import numpy as np
import pytest

import fallstreak as fs
from fallstreak.clouds import light, passes

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
NOON = "2025-06-21T12:30:00-04:00"
SINE = 0.94  # of the sun's elevation then and there


class Nothing:
    """A technique that leaves its layer empty: here the land is looked at."""

    def __init__(self, graph, clouds):
        graph.textures["clouds.layer"].usage |= 0x10  # an attachment

        def clear(context):
            view = context.resource("clouds.layer").create_view()
            colour = {"view": view, "clear_value": (0, 0, 0, 0), "load_op": "clear", "store_op": "store"}
            context.encoder.begin_render_pass(color_attachments=[colour]).end()

        graph.add_pass("nothing", writes=["clouds.layer"], record=clear)

    def update(self, state):
        pass


@pytest.fixture(scope="module", autouse=True)
def _no_technique():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(passes, "import_module", lambda *_: SimpleNamespace(Puffs=Nothing))
        yield


def ground(layers, pitch=-60.0, **clouds):
    """Luminance of land below the camera, (36, 64, 3)."""
    world = fs.load("jacksboro").updated(
        {
            "time": NOON,
            "camera": {
                "east": 0.0,
                "north": 0.0,
                "height": 400.0,
                "above": "ground",
                "heading": 20.0,
                "pitch": pitch,
                "fov": 70.0,
            },
            "clouds": {"technique": "puffs", "layers": layers, **clouds},
        }
    )
    hdr = fs.render(world, (64, 36), "low").hdr
    assert hdr is not None
    return hdr.astype(float)


@pytest.fixture(scope="module")
def clear(_no_technique):
    return ground([])


def test_an_overcast_sky_passes_what_its_clouds_do(clear):
    depth = 30.0
    layer = {"genus": "stratus", "coverage": 1.0, "base": 2500.0, "extinction": 0.16}
    under = ground([layer])
    part = (under @ LUMINANCE).mean() / (clear @ LUMINANCE).mean()
    # noise leaves the layer thinner here and thicker there
    assert light.layer_passes(4 * depth, SINE) < part < light.layer_passes(depth / 4, SINE)


def test_thick_clouds_throw_dark_shadows_and_leave_the_rest(clear):
    layer = {"genus": "cumulus_mediocris", "coverage": 0.5, "base": 2500.0, "lifetime": 0.0}
    part = (ground([layer], pitch=-20.0) @ LUMINANCE) / (ground([], pitch=-20.0) @ LUMINANCE)
    below = part[20:]
    assert below.min() < 0.45  # in a shadow the sky is left, and what clouds scatter
    assert below.max() < 1.35 and np.percentile(below, 95) > 0.75


def test_haze_under_an_overcast_sky_is_lit_by_the_clouds():
    """Hills far away: the air before them gets what comes down on the land; less blue than in the sun."""
    layer = {"genus": "stratus", "coverage": 1.0, "base": 2500.0, "extinction": 0.16}
    clear, under = (ground(layers, pitch=0.0) for layers in ([], [layer]))
    far = under[18:20].mean((0, 1)), clear[18:20].mean((0, 1))
    near = under[-6:] @ LUMINANCE, clear[-6:] @ LUMINANCE
    # light from half of all directions is a source twice as strong as a beam of as many lux
    assert 1.0 < (far[0] @ LUMINANCE) / (far[1] @ LUMINANCE) / (near[0].mean() / near[1].mean()) < 3.0
    assert far[0][2] / far[0][0] < 0.9 * far[1][2] / far[1][0]


def test_clouds_without_shadows_leave_the_land_as_it_was(clear):
    layer = {"genus": "stratus", "coverage": 1.0, "base": 2500.0}
    assert ground([layer], shadows=False) == pytest.approx(clear, rel=5e-3)


def sea(layers, **camera):
    """Luminance of a sea below and before the camera, (36, 64, 3)."""
    at = {"height": 60.0, "pitch": -14.0, "heading": 0.0, "fov": 22.0, **camera}
    world = fs.load("towering").updated(
        {
            "time": "2025-06-21T12:30:00-10:00",
            "camera": at,
            "clouds": {"technique": "puffs", "layers": layers},
        }
    )
    hdr = fs.render(world, (64, 36), "low").hdr
    assert hdr is not None
    return hdr.astype(float)


def test_water_mirrors_clouds():
    """Blue under a clear sky, grey and about as bright as the clouds' undersides under an overcast one."""
    layer = {"genus": "stratocumulus", "coverage": 1.0, "lifetime": 0.0}
    clear, under = (sea(layers).mean((0, 1)) for layers in ([], [layer]))
    half = sea([{**layer, "coverage": 0.5}]).mean((0, 1))
    bluish = [float(c[2] / c[0]) for c in (clear, half, under)]
    assert bluish[0] > 1.6 * bluish[2] and bluish[0] > 1.1 * bluish[1] > 1.1 * bluish[2]
    assert 0.7 < bluish[2] < 1.5
    assert half @ LUMINANCE > 1.1 * (clear @ LUMINANCE)


def test_from_orbit_clouds_shadows_are_their_mean():
    """The map of shadows is 96 km wide: no square of that size in the middle of the picture."""
    layer = {"genus": "cumulus_mediocris", "coverage": 0.5, "lifetime": 0.0}
    seen = sea([layer], height=300e3, pitch=-90.0, fov=40.0) @ LUMINANCE
    bent = seen[1:-1] - 0.5 * (seen[:-2] + seen[2:])
    assert np.abs(bent).max() < 0.03 * seen.mean()  # the sun's glitter alone, no edges and no streaks
