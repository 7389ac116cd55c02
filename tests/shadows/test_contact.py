"""Contact shadows: at the foot of a box, and nowhere on planes and on lit faces."""

from __future__ import annotations

from datetime import UTC, datetime

import numpy as np
import pytest

from fallstreak.gpu import VIEW, FrameGraph
from fallstreak.world.state import CameraState, FrameState, camera_rotation, view_values

SIZE = (160, 90)
MODULE = "package::shadows::contact::selftest_contact"


class Stage:
    """A depth buffer that numpy has cast, and the contact shadows in it."""

    def __init__(self, device):
        self.graph = graph = FrameGraph(device)
        self.view = graph.uniform("view", VIEW)
        graph.buffer_data("numbers", np.zeros(SIZE[0] * SIZE[1], np.float32))
        graph.buffer_data("probe", np.zeros(4, np.float32))
        graph.texture("depth", "depth32float", SIZE)
        graph.texture("light", "r32float", SIZE)
        graph.render(
            "depth",
            MODULE,
            depth="depth",
            fragment="depth_main",
            depth_compare="always",
            bind={"numbers": "numbers", "view": "view", "probe": "probe"},
            structs=[VIEW],
        )
        graph.render(
            "light",
            MODULE,
            color=["light"],
            fragment="light_main",
            bind={"depth": "depth", "view": "view", "probe": "probe"},
            structs=[VIEW],
        )
        graph.output("light")
        graph.compile()

    def light(self, camera, distance, key, length=0.3, frame=0):
        """Share of light per pixel, of distances along the view axis, inf where there is nothing."""
        now = datetime(2026, 6, 1, tzinfo=UTC)
        state = FrameState(frame, 0.0, now, 0.0, 1, SIZE, 6.36e6, camera, camera)
        self.view.set(**view_values(state))
        self.graph.upload("numbers", (camera.near / distance).astype(np.float32))
        self.graph.upload("probe", np.array([*key, length], np.float32))
        self.graph.execute()
        return np.array(self.graph.read("light"))


@pytest.fixture(scope="module")
def stage(device):
    return Stage(device)


def camera_at(position, heading=0.0, pitch=-25.0, fov=45.0):
    rotation = camera_rotation(np.radians(heading), np.radians(pitch), 0.0, np.eye(3))
    return CameraState(np.asarray(position, float), rotation, np.radians(fov))


def rays(camera):
    """World directions through the middles of pixels, of length 1 along the view axis: (H, W, 3)."""
    width, height = SIZE
    t = np.tan(camera.fov / 2)
    x = (2 * (np.arange(width) + 0.5) / width - 1) * t * width / height
    y = (1 - 2 * (np.arange(height) + 0.5) / height) * t
    return np.stack(np.broadcast_arrays(x[None, :], y[:, None], -1.0), -1) @ camera.rotation.T


def plane(camera, normal, through):
    """Distance along the view axis to a plane."""
    with np.errstate(divide="ignore"):
        distance = (normal @ (np.asarray(through, float) - camera.position)) / (rays(camera) @ normal)
    return np.where(distance > camera.near, distance, np.inf)


def box(camera, low, high):
    """Distance along the view axis to a box with the axes' directions, and which face: 0 x, 1 y, 2 z."""
    way = rays(camera)
    a, b = (np.asarray(low) - camera.position) / way, (np.asarray(high) - camera.position) / way
    enters, leaves = np.minimum(a, b), np.maximum(a, b).min(-1)
    face, enter = enters.argmax(-1), enters.max(-1)
    return np.where((enter < leaves) & (enter > 0), enter, np.inf), face


def sun(azimuth, elevation):
    a, e = np.radians(azimuth), np.radians(elevation)
    return np.array([np.sin(a) * np.cos(e), np.cos(a) * np.cos(e), np.sin(e)])


UP = np.array([0.0, 0.0, 1.0])


@pytest.mark.parametrize("height", [0.3, 1.7, 12.0])
def test_planes_of_any_tilt_shade_nothing_of_themselves(stage, height):
    camera = camera_at((0.0, 0.0, height))
    for tilt in (0, 15, 40, 60, 75, 85):
        for towards in (0, 70, 180, 250):
            normal = sun(towards, 90 - tilt)
            distance = plane(camera, normal, (0.0, height, 0.0))
            if camera.position @ normal < normal @ np.array([0.0, height, 0.0]):
                continue  # seen from below
            for key in (sun(90, 2), sun(0, 20), sun(200, 50), normal):
                if key @ normal < 0.01:
                    continue
                light = stage.light(camera, distance, key)
                assert light.min() == 1.0, (tilt, towards)


def boxed(camera):
    """A box of .4 m on level ground at (0, 2, 0): distance, what it is (0 ground, 1..3 faces), places."""
    ground = plane(camera, UP, np.zeros(3))
    thing, face = box(camera, (-0.2, 1.8, 0.0), (0.2, 2.2, 0.4))
    distance = np.minimum(ground, thing)
    place = camera.position + rays(camera) * np.where(np.isinf(distance), 1e9, distance)[..., None]
    return distance, np.where(thing < ground, face + 1, 0), place


def test_a_box_has_its_shadow_at_its_foot(stage):
    camera = camera_at((0.0, 0.0, 1.0))
    distance, what, place = boxed(camera)
    key = sun(270, 45)  # from the left: the shadow lies to the right, .4 m long
    light = np.mean([stage.light(camera, distance, key, frame=k) for k in range(16)], 0)
    aside, along = place[..., 0] - 0.2, np.abs(place[..., 1] - 2.0)
    # what lies more than a ray's length behind the box's front is past what the box counts as deep
    foot = (what == 0) & (place[..., 1] > 1.85) & (place[..., 1] < 2.08) & (aside > 0.0) & (aside < 0.1)
    assert foot.sum() >= 16
    assert light[foot].max() < 0.1
    # the rays are .3 m long: further from the box the light comes back, and on the sunny side it never left
    far = (what == 0) & ((np.abs(place[..., 0]) > 0.55) | (place[..., 1] < 1.55))
    assert light[far].min() == 1.0
    sunny = (what == 0) & (along < 0.2) & (place[..., 0] < -0.2)
    assert sunny.sum() > 50 and light[sunny].min() == 1.0


def inner(mask):
    """Where the four neighbours belong too."""
    inside = mask.copy()
    for axis in (0, 1):
        inside &= np.roll(mask, 1, axis) & np.roll(mask, -1, axis)
    return inside


@pytest.mark.parametrize("azimuth", [100, 150, 180, 210, 260])
@pytest.mark.parametrize("elevation", [3, 20, 45, 70])
def test_lit_faces_are_not_shaded(stage, azimuth, elevation):
    camera = camera_at((0.6, 0.2, 0.9), heading=-17.0)
    distance, what, _ = boxed(camera)
    key = sun(azimuth, elevation)
    light = stage.light(camera, distance, key)
    for face, normal in ((1, (1.0, 0.0, 0.0)), (2, (0.0, -1.0, 0.0)), (3, UP)):
        assert (what == face).sum() > 50
        if key @ np.asarray(normal) > 0.02:
            # a pixel that is all of the face that the picture shows thereabouts tells no plane
            assert (light[what == face] < 1.0).sum() <= 1, face
            assert light[inner(what == face)].min() == 1.0, face


def test_they_fade_with_distance(stage):
    found = []
    for away in (10.0, 40.0, 60.0):
        pitch = -np.degrees(np.arctan2(8.0, away + 2.0))
        camera = camera_at((0.0, -away, 8.0), pitch=pitch, fov=40.0 / away)
        distance, what, place = boxed(camera)
        light = np.mean([stage.light(camera, distance, sun(270, 45), frame=k) for k in range(8)], 0)
        foot = (what == 0) & (np.abs(place[..., 1] - 1.95) < 0.1) & (np.abs(place[..., 0] - 0.25) < 0.03)
        assert foot.sum() > 5
        found.append(light[foot].mean())
    assert found[0] < 0.2 < found[1] < 0.95 and found[2] == 1.0


def test_no_length_no_shadow(stage):
    camera = camera_at((0.0, 0.0, 1.0))
    assert stage.light(camera, boxed(camera)[0], sun(270, 45), length=0.0).min() == 1.0
