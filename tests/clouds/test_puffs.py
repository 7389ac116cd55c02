"""Puffs over matter of known depth: they stay in their places, hand over, and cost what is in sight."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from fallstreak.clouds.puffs.levels import SIZES, Slab, fineness_of, grids, reaches

from .puff_stage import RADIUS, PuffStage


def smooth(low, high, x):
    t = np.clip((x - low) / (high - low), 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t)


SLAB = Slab(1000.0, 1600.0, 0.04, (0.0, 0.0), 7)


@pytest.mark.parametrize("height", [1200.0, 12e3, 400e3, 20_000e3])
def test_shares_of_all_sizes_make_one(height):
    found = grids((SLAB,), reaches(50.0), height, 6.0 * height + 160e3)
    distances = np.geomspace(max(height - 1600.0, 5.0), 4.0 * height + 100e3, 500)
    total = sum(
        smooth(g.reach[0], g.reach[1], distances) * (1.0 - smooth(g.reach[2], g.reach[3], distances))
        for g in found
    )
    np.testing.assert_allclose(total, 1.0, atol=1e-9)


def test_sizes_that_reach_no_cloud_are_left_out():
    assert SIZES[grids((SLAB,), reaches(50.0), 400e3, 2400e3)[0].level] > 3e3
    assert grids((SLAB,), reaches(50.0), 10e3, 5e3) == []
    assert grids((), reaches(50.0), 0.0, 160e3) == []


def test_fineness_changes_smoothly_on_the_way_to_orbit():
    heights = np.geomspace(10.0, 400e3, 400)
    found = [fineness_of((SLAB,), 8000.0, h, max(160e3, 6.0 * h), RADIUS) for h in heights]
    assert np.abs(np.diff(np.log(found))).max() < 0.05


def world_places(stage, **pose: Any):
    stage.draw(**pose)
    puffs = stage.placed()
    return puffs["centre"].astype(float) + stage.eye, puffs


def test_puffs_stay_where_they_are_as_the_camera_moves(device):
    stage = PuffStage(device, heap=3000.0)
    first, _ = world_places(stage, height=2500.0, pitch=-20.0)
    # far enough that every bucket of sizes up to 100 m is another one
    second, puffs = world_places(stage, north=1500.0, east=-700.0, height=2500.0, pitch=-20.0)
    distance = np.linalg.norm(second[:, None] - first[None], axis=2).min(1)
    same = distance < 1e-5 * puffs["distance"] + 0.01
    assert same.mean() > 0.35
    # nothing is just a little off its place
    spacing = np.linalg.norm(puffs["right"], axis=1)
    assert not ((distance < 0.02 * spacing) & ~same).any()


def test_puffs_drift_with_their_layer(device):
    stage = PuffStage(device, slab=Slab(1000.0, 1600.0, 0.04, (10.0, -4.0), 7))
    first, _ = world_places(stage, height=4000.0, pitch=-90.0)
    second, _ = world_places(stage, height=4000.0, pitch=-90.0, time=2.0)
    moved = first + np.array([20.0, -8.0, 0.0])
    distance = np.linalg.norm(moved[:, None] - second[None], axis=2).min(1)
    assert (distance < 0.05).mean() > 0.9


@pytest.mark.parametrize("extinction", [0.0005, 0.0015, 0.004, 0.01])
def test_light_passes_alike_whatever_the_size(device, extinction):
    """Seen from above, at distances where sizes hand over and between them, against the slab itself."""
    stage = PuffStage(device, slab=Slab(1000.0, 1600.0, extinction, (0.0, 0.0), 7), size=(64, 64))
    across = np.tan(np.radians(20.0)) * (np.arange(64) - 31.5) / 32.0
    slant = np.sqrt(1.0 + across[:, None] ** 2 + across[None, :] ** 2)
    truth = np.exp(-extinction * 600.0 * slant).mean()
    found = [
        1.0 - stage.draw(height=1300.0 + away, pitch=-90.0, fov=40.0)[..., 3].mean()
        for away in np.geomspace(1500.0, 60e3, 12)
    ]
    errors = np.array(found) - truth
    print(f"\nextinction {extinction}: transmittance {truth:.3f}, errors {np.round(errors, 3)}")
    assert np.abs(errors).max() < 0.05


@pytest.mark.parametrize("height", [80e3, 400e3])
def test_from_high_above_there_are_patches(device, height):
    """Some of even a thin sheet hides the land and some does not: it is no veil, and as much light passes."""
    stage = PuffStage(device, slab=Slab(1000.0, 1600.0, 0.0015, (0.0, 0.0), 7), size=(64, 64))
    opacity = stage.draw(height=height, pitch=-90.0, fov=40.0)[..., 3]
    print(f"\nopacity from {height:.0f} m: {opacity.mean():.2f} +- {opacity.std():.2f}")
    assert opacity.std() > 0.18
    assert abs(opacity.mean() - (1.0 - np.exp(-0.9))) < 0.1


def test_buckets_out_of_sight_cost_nothing(device):
    culled, every = PuffStage(device, heap=3000.0), PuffStage(device, heap=3000.0, everywhere=True)
    headings = np.arange(0.0, 360.0, 45.0)
    ratios = []
    for height, pitch in ((100.0, 8.0), (1300.0, 0.0), (12e3, -15.0)):
        seen, there = [], []
        for heading in headings:
            for stage, counts in ((culled, seen), (every, there)):
                stage.draw(height=height, heading=heading, pitch=pitch)
                counts.append(stage.blocks)
        ratios.append(np.mean(there) / np.mean(seen))
    print(f"blocks of cells over those in sight: {np.round(ratios, 2)}")
    assert min(ratios) > 2.0


def test_a_frame_is_the_same_twice(device):
    stage = PuffStage(device, heap=3000.0)
    first = stage.draw(height=1200.0, pitch=5.0)
    stage.draw(height=9000.0, pitch=-30.0, east=5000.0)
    np.testing.assert_array_equal(stage.draw(height=1200.0, pitch=5.0), first)


def test_of_too_many_the_nearest_are_drawn_and_always_the_same(device):
    few, every = PuffStage(device, heap=3000.0, most=400), PuffStage(device, heap=3000.0)
    pose: dict[str, Any] = {"height": 1900.0, "pitch": -20.0}
    first = few.draw(**pose)
    whole = every.draw(**pose)
    assert few.drawn == 400 < every.drawn
    few.draw(height=9000.0, pitch=-30.0, east=5000.0)
    np.testing.assert_array_equal(few.draw(**pose), first)
    # near puffs fill the lower border of the picture, far ones the horizon
    np.testing.assert_allclose(first[-1, :, 3], whole[-1, :, 3], atol=0.02)
    assert first[..., 3].sum() < 0.9 * whole[..., 3].sum()


def test_no_clouds_no_puffs(device):
    stage = PuffStage(device)
    assert not stage.draw(height=10e3, visibility=2e3, pitch=20.0).any()


@pytest.mark.parametrize("height", [0.0, 1300.0, 12e3, 100e3, 400e3, 30_000e3])
def test_pictures_are_finite_and_opaque_at_most(device, height):
    stage = PuffStage(device, heap=0.0)
    layer = stage.draw(height=height, pitch=5.0 if height < 2000.0 else -30.0 if height < 1e6 else -90.0)
    assert np.isfinite(layer).all()
    assert layer[..., 3].max() <= 1.0 + 1e-3
    assert layer[..., 3].max() > 0.1
    assert stage.drawn <= 30_000
