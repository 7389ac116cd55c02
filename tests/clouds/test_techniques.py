"""What all techniques have to do alike: one cloud of a user's own model as sprites, puffs and spheres."""

from __future__ import annotations

import hashlib
import subprocess
import sys
from types import SimpleNamespace

import numpy as np
import pytest

import fallstreak as fs
from fallstreak.clouds.field import field_of

pytestmark = pytest.mark.xdist_group("techniques")  # the frames are rendered once, for all tests

TECHNIQUES = ("sprites", "puffs", "spheres")
SIZE = (72, 48)
LIFE = 1000.0
AWAY, EYE = 3200.0, 300.0  # m from the camera to the cloud, its height
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])

BUN = """
title = "a bun with a hat"
boxes = [
    { centre = [0, 0, 260], size = [1500, 1200, 520] },
    { centre = [150, 60, 620], size = [800, 760, 700], turn = 30, group = 1 },
]
"""
FULL_MOON, NEW_MOON = 12 * 3600, int(14.5 * 86400)  # s after noon of 11 June 2025: midnights

SCRIPT = """
import hashlib, sys
import fallstreak as fs
world = fs.loads(sys.argv[1])
for technique in sys.argv[2].split(","):
    with fs.Renderer(world.updated({"clouds.technique": technique}), (32, 18), "low", fps=4.0) as renderer:
        frames = [renderer.render(index).ldr.tobytes() for index in range(2)]
    print(technique, hashlib.sha256(b"".join(frames)).hexdigest())
"""


def sky(folder):
    """Few clouds over the sea, all of one model that the user wrote."""
    path = folder / "bun.toml"
    path.write_text(BUN, encoding="utf-8")
    layer = {
        "genus": "cumulus_mediocris",
        "coverage": 0.06,
        "clustering": 0.0,
        "lifetime": LIFE,
        "wind_speed": 0.0,
        "models": [str(path)],
    }
    return fs.World(
        name="bun",
        time="2025-06-11T12:00-03:00",
        place={"latitude": 20.0, "longitude": -45.0},
        planet={"surface": "ocean"},
        clouds={"layers": [layer]},
    )


def a_cloud(world):
    """A cloud that stands alone: its place, and seconds when it is not there, half there and whole."""
    field = field_of(world)
    i, j = np.meshgrid(np.arange(-8, 8), np.arange(-8, 8))
    cells = np.stack([i.ravel(), j.ravel()], 1)
    times = np.arange(0.0, LIFE, 10.0)
    frames = [field.clouds(0, cells, t) for t in times]
    formation = np.stack([f["formation"] for f in frames])
    whole = int(formation.sum(1).argmax())
    there = frames[whole]
    alone = np.hypot(*(there["place"][:, None] - there["place"][None]).transpose(2, 0, 1))
    alone = np.where((formation.max(0)[None] > 0.0) & (alone > 0.0), alone, np.inf).min(1)
    grown = (formation.max(0) == 1.0) & (formation.min(0) == 0.0)
    cell = int(np.where(grown, alone, 0.0).argmax())
    life = formation[:, cell]
    first = int(np.flatnonzero((life[1:] == 1.0) & (life[:-1] < 1.0))[0])
    full = times[first + 3]
    rising = times[: first + 1][np.abs(life[: first + 1] - 0.5).argmin()]
    none = times[life == 0.0][0]
    cloud = field.clouds(0, cells[cell : cell + 1], full)[0]
    return SimpleNamespace(
        place=cloud["place"],
        middle=0.5 * (cloud["base"] + cloud["top"]),
        radius=cloud["radius"],
        none=int(none),
        half=int(rising),
        whole=int(full),
        formation=float(life[np.abs(times - rising).argmin()]),
    )


@pytest.fixture(scope="module")
def stand(tmp_path_factory):
    """World, cloud, and every technique's frames by name."""
    world = sky(tmp_path_factory.mktemp("models"))
    cloud = a_cloud(world)
    east, north = (float(v) for v in cloud.place)
    eye = {"east": east, "north": north - AWAY, "height": EYE, "heading": 0.0, "pitch": 18.0, "fov": 34.0}
    # a ship in the air, before the cloud, behind it, and gone
    gone = {"north": north - 9e4, "height": 1000.0}
    way = [
        {"at": 0, **gone},
        {"at": cloud.whole - 1, **gone},
        {"at": cloud.whole, "north": north - 1500.0, "height": 800.0},
        {"at": cloud.whole + 1, "north": north + 2500.0, "height": 2000.0},
        {"at": cloud.whole + 2, **gone},
    ]
    ship = {"file": "ship", "above": "sea", "east": east, "scale": 0.4, "heading": 70.0}
    # it looks down for a moment
    pitches = {0: 18.0, cloud.whole + 2: 18.0, cloud.whole + 3: -10.0, cloud.whole + 4: 18.0}
    heights = {0: EYE, cloud.whole + 2: EYE, cloud.whole + 3: 800.0, cloud.whole + 4: EYE}
    eye["keyframes"] = [{"at": at, "pitch": pitches[at], "height": heights[at]} for at in pitches]
    times = {
        "none": cloud.none,
        "half": cloud.half,
        "behind it": cloud.whole,
        "before it": cloud.whole + 1,
        "whole": cloud.whole + 2,
        "sea": cloud.whole + 3,
        "full moon": FULL_MOON,
        "new moon": NEW_MOON,
    }
    world = world.updated({"camera": {"above": "sea", **eye}, "models": [{**ship, "keyframes": way}]})
    found = {}
    for technique in TECHNIQUES:
        own = world.updated({"clouds.technique": technique})
        with fs.Renderer(
            own, SIZE, "high", fps=1.0, still=True, samples=1, layers=("clouds", "depth", "hdr")
        ) as r:
            found[technique] = {name: r.render(at) for name, at in times.items()}
            rays = directions(r.state(0))
    start = np.array([east, north - AWAY, EYE])
    return SimpleNamespace(world=world, cloud=cloud, frames=found, start=start, rays=rays)


@pytest.mark.parametrize("technique", TECHNIQUES)
def test_one_flies_into_a_cloud_and_never_sees_through_it(stand, technique):
    cloud, steps = stand.cloud, 24
    east, north = (float(v) for v in cloud.place)
    way = [{"at": cloud.whole, "north": north - 850.0}, {"at": cloud.whole + steps, "north": north - 370.0}]
    pose = {"east": east + 40.0, "height": cloud.middle - 100.0, "pitch": 0.0, "fov": 60.0, "keyframes": way}
    world = stand.world.updated(
        {"clouds.technique": technique, "models": [], "camera": {"above": "sea", **pose}}
    )
    with fs.Renderer(world, (48, 32), "low", fps=1.0, still=True, layers=("clouds",)) as renderer:
        seen = [float(renderer.render(cloud.whole + step).clouds.mean()) for step in range(steps + 1)]
    print(f"\n{technique}: {np.round(seen, 2)}")
    assert np.diff(seen).min() > -0.1
    assert seen[-1] > 0.98


@pytest.mark.parametrize("technique", ("puffs", "spheres"))
def test_more_clouds_are_not_more_calls(stand, technique):
    """Of sprites `test_sprites` says so."""
    calls = []
    for coverage in (0.05, 0.8):
        layers = [{"genus": "cumulus_humilis", "coverage": coverage}]
        world = stand.world.updated({"clouds.technique": technique, "clouds.layers": layers, "models": []})
        with fs.Renderer(world, (32, 18), "low", still=True) as renderer:
            renderer.render(0)
            calls.append(renderer.stats()["calls"])
    assert calls[0] == calls[1]


def directions(state):
    """Unit vectors through the pixels, (H, W, 3)."""
    tangent = np.tan(state.camera.fov / 2.0)
    x = (2.0 * (np.arange(SIZE[0]) + 0.5) / SIZE[0] - 1.0) * tangent * SIZE[0] / SIZE[1]
    y = (1.0 - 2.0 * (np.arange(SIZE[1]) + 0.5) / SIZE[1]) * tangent
    rays = np.stack(np.broadcast_arrays(x[None], y[:, None], -1.0), -1) @ state.camera.rotation.T
    return rays / np.linalg.norm(rays, axis=-1, keepdims=True)


def near_cloud(stand):
    """Pixels around the cloud: others may be behind the rest."""
    away = np.abs(stand.rays[..., 0]) / stand.rays[..., 1]
    return (away < stand.cloud.radius / AWAY) & (stand.rays[..., 2] > np.sin(np.radians(9.0)))


def field_opacity(stand, time):
    depth = stand.world.clouds.optical_depth(stand.start, stand.start + 6000.0 * stand.rays, time)
    return 1.0 - np.exp(-depth)


@pytest.mark.parametrize("technique", TECHNIQUES)
def test_the_cloud_of_a_user_s_model_is_drawn_where_the_field_has_it(stand, technique):
    around = near_cloud(stand)
    field = field_opacity(stand, stand.cloud.whole + 2)
    there = (field > 1.0 - np.exp(-1.0)) & around
    drawn = (stand.frames[technique]["whole"].clouds > 0.6) & around
    overlap = (there & drawn).sum() / (there | drawn).sum()
    print(f"\n{technique}: {there.sum()} pixels, IoU {overlap:.3f}")
    assert there.sum() > 150
    assert overlap > 0.7


@pytest.mark.parametrize("technique", TECHNIQUES)
def test_clouds_form_in_every_technique(stand, technique):
    around = near_cloud(stand)
    frames = stand.frames[technique]
    drawn = {name: float(frames[name].clouds[around].sum()) for name in ("none", "half", "whole")}
    field = {
        "half": float(field_opacity(stand, stand.cloud.half)[around].sum()),
        "whole": float(field_opacity(stand, stand.cloud.whole + 2)[around].sum()),
    }
    print(f"\n{technique}: drawn {drawn}, field {field}")
    assert drawn["none"] < 0.01 * drawn["whole"]
    assert drawn["half"] / drawn["whole"] == pytest.approx(field["half"] / field["whole"], abs=0.1)


@pytest.mark.parametrize("technique", TECHNIQUES)
def test_things_are_before_and_behind_clouds(stand, technique):
    around = near_cloud(stand)
    frames = stand.frames[technique]
    whole = frames["whole"].clouds
    solid = (whole > 0.9) & around
    for name, least, most in (("behind it", 0.0, 0.02), ("before it", 0.85, 1.0)):
        frame = frames[name]
        thing = solid & (frame.depth < 8000.0)
        assert thing.sum() > 10
        assert least <= np.median(frame.clouds[thing]) <= most
        # all else is as without it
        rest = solid & ~(frame.depth < 8000.0)
        np.testing.assert_allclose(frame.clouds[rest].mean(), whole[rest].mean(), atol=0.02)


def test_the_sea_has_the_same_shadows_in_every_technique(stand):
    frames = [stand.frames[technique]["sea"] for technique in TECHNIQUES]
    lit = [frame.hdr @ LUMINANCE for frame in frames]
    free = np.all([frame.clouds < 0.01 for frame in frames], 0) & (np.arange(SIZE[1])[:, None] > SIZE[1] // 2)
    assert free.sum() > 1000
    row = np.median(lit[0], axis=1, keepdims=True)
    assert (lit[0] / row)[free].min() < 0.75
    for other in lit[1:]:
        np.testing.assert_allclose(other[free], lit[0][free], rtol=0.03)


@pytest.mark.parametrize("technique", TECHNIQUES)
def test_the_moon_lights_the_clouds(stand, technique):
    seen = {}
    for name in ("full moon", "new moon"):
        frame = stand.frames[technique][name]
        cloudy = frame.clouds > 0.9
        assert cloudy.sum() > 30
        seen[name] = float((frame.hdr @ LUMINANCE)[cloudy].mean())
    print(f"\n{technique}: {seen} cd/m2")
    assert seen["full moon"] > 5.0 * seen["new moon"]
    assert 1e-4 < seen["full moon"] < 0.1


def test_another_process_renders_the_same_frames(stand):
    """Bytes of two frames of a sequence, of each technique."""
    # a text cannot name files
    text = stand.world.updated({"models": [], "clouds.layers": [{"coverage": 0.3}]}).to_toml()
    told = subprocess.run(
        [sys.executable, "-c", SCRIPT, text, ",".join(TECHNIQUES)], capture_output=True, text=True, check=True
    ).stdout
    theirs = dict(line.split() for line in told.splitlines())
    world = fs.loads(text)
    for technique in TECHNIQUES:
        with fs.Renderer(world.updated({"clouds.technique": technique}), (32, 18), "low", fps=4.0) as r:
            frames = [r.render(index).ldr.tobytes() for index in range(2)]
        assert theirs[technique] == hashlib.sha256(b"".join(frames)).hexdigest()
