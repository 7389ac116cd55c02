"""Stars, planets and the moon as drawn: light adds up, places are right, what is nearer hides them."""

from __future__ import annotations

from datetime import UTC, datetime
from math import degrees

import numpy as np
import pytest

from fallstreak.gpu import EXPOSURE, VIEW, Device, FrameGraph
from fallstreak.sky.air import AIR, Air
from fallstreak.sky.celestial_passes import Celestial
from fallstreak.sky.ephemeris import elevation_azimuth, refract
from fallstreak.sky.light import MAGNITUDE_ZERO_LUX
from fallstreak.sky.model import transmittance
from fallstreak.sky.passes import _still_tables
from fallstreak.sky.stars import stars
from fallstreak.world import QUALITY, World
from fallstreak.world.state import CameraState, FrameState, camera_rotation, clip_from_camera, view_values

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
WINTER = datetime(2024, 1, 14, 3, 30, tzinfo=UTC)  # moonless, Orion in the south
SIZE = (160, 90)


class Night:
    """Celestial over nothing, with a fixed exposure and, if asked, a wall before it."""

    def __init__(self, device: Device, scale=100.0, wall=False, size=SIZE, **world):
        place = {"latitude": 33.2, "longitude": -98.1}
        self.world, self.scale, self.size = World(place=place, **world), scale, size
        graph = self.graph = FrameGraph(device)
        self.view = graph.uniform("view", VIEW)
        graph.texture("frame.hdr", "rgba16float", size)
        graph.texture("gbuffer.depth", "depth32float", size)
        graph.buffer("frame.exposure", EXPOSURE.size, history=True)
        graph.buffer_data("fixed", EXPOSURE.pack(scale=scale, ev100=0.0, luminance=1.0, pre_scale=scale))
        graph.add_pass("expose", reads=["fixed"], writes=["frame.exposure"], record=self._expose)
        graph.add_pass("depth", writes=["gbuffer.depth"], record=self._clear, order=-1)
        self._wall = wall
        self.celestial = Celestial(graph, self.world)
        graph.uniform("sky.air", AIR).set(**Air.of(self.world).uniform())
        _still_tables(graph, QUALITY["high"])
        self.celestial.draw()
        graph.output("frame.hdr", "frame.exposure")
        graph.compile()

    def _expose(self, ctx) -> None:
        ctx.encoder.copy_buffer_to_buffer(
            ctx.resource("fixed"), 0, ctx.resource("frame.exposure"), 0, EXPOSURE.size
        )

    def _clear(self, ctx) -> None:
        attachment = {
            "view": ctx.resource("gbuffer.depth").create_view(),
            "depth_clear_value": 0.01 if self._wall else 0.0,
            "depth_load_op": "clear",
            "depth_store_op": "store",
        }
        ctx.encoder.begin_render_pass(color_attachments=[], depth_stencil_attachment=attachment).end()

    def frame(self, utc, towards, fov=60.0, altitude=2.0) -> np.ndarray:
        """Luminance in cd/m2, (height, width, 3), towards a direction or (azimuth, elevation) in degrees."""
        if len(towards) == 3:
            elevation, azimuth = elevation_azimuth(np.asarray(towards))
        else:
            azimuth, elevation = np.radians(towards)
        rotation = camera_rotation(azimuth, elevation, 0.0, np.eye(3))
        self.camera = CameraState(np.array([0.0, 0.0, altitude]), rotation, np.radians(fov))
        radius = self.world.planet.radius
        for index in range(2):
            state = FrameState(index, 0.0, utc, 0.0, 0, self.size, radius, self.camera, self.camera)
            self.view.set(**view_values(state))
            self.celestial.update(state)
            self.graph.execute()
        return self.graph.read("frame.hdr")[..., :3].astype(float) / self.scale

    def pixel(self, direction) -> np.ndarray:
        """Pixel coordinates of a direction."""
        clip = clip_from_camera(self.camera.fov, self.size, 0.1, (0, 0)) @ np.append(
            self.camera.rotation.T @ direction, 0.0
        )
        return (clip[:2] / clip[3] * [1, -1] * 0.5 + 0.5) * self.size

    def solid_angles(self) -> np.ndarray:
        """Of each pixel, sr."""
        width, height = self.size
        step = 2 * np.tan(self.camera.fov / 2) / height
        x = (np.arange(width) + 0.5 - width / 2) * step
        y = (np.arange(height) + 0.5 - height / 2) * step
        return step**2 / (1 + x[None, :] ** 2 + y[:, None] ** 2) ** 1.5


def star(name_hours, name_degrees, heavens):
    a, d = np.radians([15 * name_hours, name_degrees])
    equatorial = np.array([np.cos(d) * np.cos(a), np.cos(d) * np.sin(a), np.sin(d)])
    return refract(heavens.equatorial_from_local.T @ equatorial, heavens.refraction)


BETELGEUSE, RIGEL, SIRIUS = (5.91953, 7.4071), (5.24230, -8.2016), (6.75248, -16.7161)


def dark(**sky):
    return {"sky": {"night_glow": 0.0, **sky}}


def test_the_table():
    table = stars(6.5)
    assert len(table.magnitude) == 8874
    assert table.magnitude[0] == pytest.approx(-1.44)  # Sirius
    assert np.all(np.diff(table.magnitude) >= 0)
    assert np.allclose(np.linalg.norm(table.direction, axis=1), 1.0)
    lux = table.illuminance() @ LUMINANCE
    assert np.allclose(lux, MAGNITUDE_ZERO_LUX * 10 ** (-0.4 * table.magnitude), rtol=1e-6)
    # All stars to 6.5 together: about as bright as magnitude -5 (Allen, section 117, sums them to -4.9).
    assert -2.5 * np.log10(lux.sum() / MAGNITUDE_ZERO_LUX) == pytest.approx(-4.9, abs=0.15)
    assert len(stars(-2).magnitude) == 0


@pytest.mark.parametrize("size", [(160, 90), (320, 180)])
def test_starlight_adds_up_at_any_size(device, size):
    """Sirius in a narrow view: lux through the air, whatever the pixels."""
    night = Night(device, size=size, **dark(star_magnitude_limit=-1.0))
    target = None
    night.frame(WINTER, (165, 30))
    target = star(*SIRIUS, night.celestial.heavens)
    picture = night.frame(WINTER, target, fov=10)
    glow = np.median(picture.reshape(-1, 3), axis=0)
    lux = np.sum((picture - glow) @ LUMINANCE * night.solid_angles())
    passed = transmittance(Air.of(night.world), 2.0, target[2]) @ LUMINANCE
    assert lux == pytest.approx(MAGNITUDE_ZERO_LUX * 10 ** (0.4 * 1.44) * passed, rel=0.04)


def test_orion_stands_where_it_should(device):
    night = Night(device, size=(320, 180), **dark(star_magnitude_limit=3.0))
    picture = night.frame(WINTER, (160, 45), fov=40) @ LUMINANCE
    for place in (BETELGEUSE, RIGEL):
        x, y = night.pixel(star(*place, night.celestial.heavens))
        assert 2 < x < 318 and 2 < y < 178
        near = picture[int(y) - 2 : int(y) + 3, int(x) - 2 : int(x) + 3]
        peak = np.unravel_index(np.argmax(near), near.shape)
        assert abs(peak[0] - 2 + int(y) + 0.5 - y) <= 1.0 and abs(peak[1] - 2 + int(x) + 0.5 - x) <= 1.0
        assert near.max() > 50 * np.median(picture)


def test_betelgeuse_is_red_and_rigel_blue(device):
    night = Night(device, size=(320, 180), **dark(star_magnitude_limit=1.0))
    picture = night.frame(WINTER, (160, 45), fov=40)
    ratio = []
    for place in (BETELGEUSE, RIGEL):
        x, y = (int(v) for v in night.pixel(star(*place, night.celestial.heavens)))
        red, _, blue = picture[y - 2 : y + 3, x - 2 : x + 3].sum(axis=(0, 1))
        ratio.append(red / blue)
    assert ratio[0] > 3 * ratio[1]


def test_what_is_nearer_hides_stars_and_moon(device):
    assert not np.any(Night(device, wall=True).frame(WINTER, (165, 30)))


def test_nothing_is_drawn_by_day(device):
    night = Night(device, scale=1e-3, sky={"moon": False})
    night.frame(WINTER, (165, 30))
    assert drawn(night) >= {"sky.stars", "sky.night"}
    night.frame(datetime(2024, 1, 14, 18, tzinfo=UTC), (165, 30))
    assert not drawn(night) & {"sky.stars", "sky.night"}


def drawn(night):
    """Names of the passes that ran in the last frame."""
    return {p["name"] for p in night.graph.stats()["passes"] if p["ran"]}


def test_stars_do_not_shine_through_the_planet(device):
    night = Night(device, **dark())
    picture = night.frame(WINTER, (165, -60), fov=50)
    assert not np.any(picture)


@pytest.mark.parametrize("utc", ["2024-03-24T06:00Z", "2024-03-21T04:00Z", "2024-04-16T02:30Z"])
def test_the_moons_disc_sends_moonlight(device, utc):
    """Summed over its pixels, the disc gives the illuminance of `sky.light` less the air."""
    night = Night(device, scale=1e-3, size=(160, 160), **dark(stars=False))
    moment = datetime.fromisoformat(utc)
    heavens = night.celestial.ephemeris.at(moment)
    picture = night.frame(moment, heavens.moon_direction, fov=0.7)
    lux = np.sum(picture @ LUMINANCE * night.solid_angles())
    above = night.celestial.shine(night.celestial.heavens, 2.0)["moon_illuminance"]
    passed = transmittance(Air.of(night.world), 2.0, heavens.moon_direction[2])
    assert lux == pytest.approx((above * passed) @ LUMINANCE, rel=0.12)  # the seas' share is the map's


def test_the_moon_keeps_its_light_when_small(device):
    """Three pixels across or a hundred: the same lux."""
    moment = datetime(2024, 3, 24, 6, tzinfo=UTC)
    night = Night(device, scale=1e-3, size=(160, 160), **dark(stars=False))
    towards = night.celestial.ephemeris.at(moment).moon_direction
    lux = []
    for fov in (0.8, 8.0, 25.0):
        lux.append(np.sum(night.frame(moment, towards, fov=fov) @ LUMINANCE * night.solid_angles()))
    assert lux[1] == pytest.approx(lux[0], rel=0.03)
    assert lux[2] == pytest.approx(lux[0], rel=0.06)


def test_the_lit_side_of_the_moon_faces_the_sun(device):
    moment = datetime(2024, 4, 16, 2, 30, tzinfo=UTC)  # first quarter, high in the west
    night = Night(device, scale=1e-3, size=(160, 160), **dark(stars=False))
    heavens = night.celestial.ephemeris.at(moment)
    picture = night.frame(moment, heavens.moon_direction, fov=0.7) @ LUMINANCE
    y, x = np.indices(picture.shape) - 79.5
    lean = np.arctan2(np.sum(picture * x), -np.sum(picture * y))  # from up towards the right
    assert degrees(abs(np.angle(np.exp(1j * (lean - heavens.moon_bright_limb))))) < 6


def test_stars_stay_behind_the_moon(device):
    """At the moon's dark limb nothing twinkles through: an occultation."""
    moment = datetime(2024, 4, 11, 2, 0, tzinfo=UTC)
    night = Night(device, scale=1.0, size=(160, 160), **dark(star_magnitude_limit=8.0))
    heavens = night.celestial.ephemeris.at(moment)
    with_stars = night.frame(moment, heavens.moon_direction, fov=0.45)
    alone = Night(device, scale=1.0, size=(160, 160), **dark(stars=False))
    inside = np.hypot(*(np.indices((160, 160)) - 79.5)) < 60
    difference = with_stars - alone.frame(moment, heavens.moon_direction, fov=0.45)
    assert np.abs(difference[inside]).max() < 1e-3


def test_planets_are_there(device):
    night = Night(device, size=(320, 180), **dark(star_magnitude_limit=-2.0))
    heavens = night.celestial.ephemeris.at(WINTER)
    jupiter = heavens.planet_directions[heavens.planet_names.index("Jupiter")]
    picture = night.frame(WINTER, jupiter, fov=20) @ LUMINANCE
    peak = np.unravel_index(np.argmax(picture), picture.shape)
    assert np.hypot(peak[0] - 89.5, peak[1] - 159.5) < 1.5


def test_the_milky_way_runs_through_cygnus(device):
    night = Night(device, **dark(star_magnitude_limit=-2.0))
    moment = datetime(2024, 8, 5, 5, tzinfo=UTC)
    heavens = night.celestial.ephemeris.at(moment)
    deneb, arcturus = star(20.69, 45.28, heavens), star(14.26, 19.18, heavens)
    bright, faint = (np.median(night.frame(moment, d, fov=5) @ LUMINANCE) for d in (deneb, arcturus))
    assert bright > 2 * faint
    assert 3e-5 < bright < 5e-4  # cd/m2
