"""The geometry that every frame rests on: places, axes, cameras, projections."""

from __future__ import annotations

from datetime import UTC, datetime

import numpy as np
import pytest

from fallstreak.world.state import (
    CameraState,
    FrameState,
    camera_rotation,
    clip_from_camera,
    height_of,
    local_axes,
    map_coordinates,
    position_on_planet,
    view_values,
)

RADIUS = 6360e3


@pytest.mark.parametrize("place", [(0, 0, 1.7), (12.5, -3, 0), (30e3, -20e3, 500), (-150e3, 90e3, 400e3)])
def test_places_come_back(place):
    east, north, height = place
    position = position_on_planet(east, north, height, RADIUS)
    assert height_of(position, RADIUS) == pytest.approx(height, abs=1e-6)
    assert map_coordinates(position, RADIUS) == pytest.approx((east, north), abs=1e-6)
    assert np.linalg.norm(position + np.array([0, 0, RADIUS])) == pytest.approx(RADIUS + height, abs=1e-6)


def test_the_ground_falls_away_by_half_the_square_over_the_radius():
    drop = -position_on_planet(50e3, 0, 0, RADIUS)[2]
    assert drop == pytest.approx(50e3**2 / (2 * RADIUS), rel=1e-4)


def test_local_axes_are_a_rotation_that_leads_along_the_map():
    axes = local_axes(40e3, 70e3, RADIUS)
    np.testing.assert_allclose(axes.T @ axes, np.eye(3), atol=1e-12)
    assert np.linalg.det(axes) == pytest.approx(1)
    here = position_on_planet(40e3, 70e3, 0, RADIUS)
    outward = position_on_planet(40e3 * 1.0001, 70e3 * 1.0001, 0, RADIUS) - here
    along = axes @ (np.array([40, 70, 0]) / np.hypot(40, 70))
    assert outward @ along / np.linalg.norm(outward) == pytest.approx(1, abs=1e-6)


def test_cameras_look_where_they_are_told():
    east = camera_rotation(np.pi / 2, 0, 0, np.eye(3))
    np.testing.assert_allclose(east @ [0, 0, -1], [1, 0, 0], atol=1e-12)
    np.testing.assert_allclose(east @ [1, 0, 0], [0, -1, 0], atol=1e-12)
    up = camera_rotation(0, np.radians(30), 0, np.eye(3))
    np.testing.assert_allclose(up @ [0, 0, -1], [0, np.cos(np.pi / 6), 0.5], atol=1e-12)
    rolled = camera_rotation(0, 0, np.radians(10), np.eye(3))
    assert (rolled @ [1, 0, 0])[2] < 0, "a roll to the right lowers the right wing"


def test_depth_is_reversed_and_endless():
    matrix = clip_from_camera(1.0, (320, 180), 0.1, (0, 0))
    for distance, depth in [(0.1, 1.0), (1.0, 0.1), (1e6, 1e-7)]:
        clip = matrix @ [0, 0, -distance, 1]
        assert clip[2] / clip[3] == pytest.approx(depth)


def test_jitter_moves_the_sampling_point_right_and_down():
    size, jitter = (320, 180), (0.25, -0.4)
    point = np.array([1.0, 2.0, -7.0, 1.0])

    def pixel(j):
        clip = clip_from_camera(1.0, size, 0.1, j) @ point
        return np.array([clip[0] / clip[3] / 2 * size[0], -clip[1] / clip[3] / 2 * size[1]])

    np.testing.assert_allclose(pixel((0, 0)) - pixel(jitter), jitter, atol=1e-9)


def test_view_matrices_are_inverses_and_know_the_frame_before():
    now = CameraState(
        position_on_planet(900, -40, 30, RADIUS), camera_rotation(0.3, -0.2, 0.1, np.eye(3)), 0.8
    )
    before = CameraState(
        position_on_planet(880, -41, 29, RADIUS), camera_rotation(0.2, -0.1, 0.0, np.eye(3)), 0.7
    )
    state = FrameState(
        5, 0.0, datetime(2025, 1, 1, tzinfo=UTC), 0.1, 0, (320, 180), RADIUS, now, before, (0.2, 0.3)
    )
    values = view_values(state)
    np.testing.assert_allclose(values["world_from_clip"] @ values["clip_from_world"], np.eye(4), atol=1e-12)
    point = np.array([120.0, 300.0, -20.0])
    clip = values["previous_clip_from_world"] @ [*point, 1.0]
    seen = before.rotation.T @ (point + now.position - before.position)
    want = clip_from_camera(0.7, (320, 180), 0.1, (0, 0)) @ [*seen, 1.0]
    np.testing.assert_allclose(clip, want, atol=1e-9)
