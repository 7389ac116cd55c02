"""Shadows of things: where their maps lie, and what they say against rays."""

from __future__ import annotations

from datetime import UTC, datetime
from itertools import pairwise

import numpy as np
import pytest
from models.files import Maker, cube
from shader_probes import find_probes

import fallstreak as fs
from fallstreak.frame.gbuffer import add_gbuffer
from fallstreak.gpu import VIEW, FrameGraph
from fallstreak.models.passes import Models
from fallstreak.models.poses import PlacedModels
from fallstreak.shadows.cascades import Cascades
from fallstreak.shadows.cascades.keep import Keep, around, axes_near
from fallstreak.shadows.cascades.passes import TEXELS
from fallstreak.shadows.cascades.window import MARGIN, about, basis
from fallstreak.world.state import CameraState, FrameState, view_values

from .rays import shaded

PLACES = 16384
SIZE = (64, 36)
FAR_OFF = np.array([2.1e5, -3.7e5, -1.4e4])
REACHES = [40.0, 160.0, 640.0, 2560.0]


def unit(v):
    return np.asarray(v, float) / np.linalg.norm(v)


KEYS = [unit(k) for k in ([0.1, 0.2, 1], [1, 0.3, 0.02], [-1, -2, 0.2], [0, 0, 1], [1, 0, -0.05])]


# ---- where maps lie --------------------------------------------------------------------------------------


@pytest.mark.parametrize("key", KEYS)
def test_the_basis_is_a_rotation_that_ends_in_the_light(key):
    axes = basis(key)
    np.testing.assert_allclose(axes @ axes.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(axes) == pytest.approx(1.0)
    np.testing.assert_allclose(axes[2], key)


def test_the_basis_does_not_jump_as_the_light_passes_overhead():
    way = [basis(unit([t, 1e-5, 1.0])) for t in np.linspace(-0.2, 0.2, 801)]
    assert max(np.abs(a - b).max() for a, b in pairwise(way)) < 1e-3


@pytest.mark.parametrize("key", KEYS)
def test_windows_move_by_whole_texels_and_hold_what_they_should(key):
    axes = basis(key)
    first = around(axes, FAR_OFF, 40.0, TEXELS)
    texel = first.texel(TEXELS)
    assert texel <= 0.1
    rng = np.random.default_rng(1)
    for n in range(200):
        camera = FAR_OFF + 0.1 * n * texel * unit([1, 2, 0.5])
        window = around(axes, camera, 40.0, TEXELS)
        moved = (window.middle - first.middle) / texel
        np.testing.assert_allclose(moved, np.round(moved), atol=1e-5)
        assert np.abs(axes @ camera - window.middle).max() <= MARGIN * 40.0 + 1e-6
        ball = 40.0 * np.stack([unit(v) for v in rng.normal(size=(20, 3))])
        rows = window.rows(camera)
        at = ball @ rows[:, :3].T + rows[:, 3]
        assert ((at >= 0.0) & (at <= 1.0)).all()


def test_a_place_keeps_its_texel_in_single_precision_as_the_camera_moves():
    axes, place = basis(KEYS[1]), FAR_OFF + np.array([13.0, -7.0, 2.0])
    window, found = around(axes, FAR_OFF, 40.0, TEXELS), []
    for n in range(100):
        camera = FAR_OFF + np.array([0.009, 0.003, -0.001]) * n
        rows = window.rows(camera).astype(np.float32)
        found.append((rows[:2, :3] @ (place - camera).astype(np.float32) + rows[:2, 3]) * TEXELS)
    assert np.ptp(found, axis=0).max() < 0.01


def test_clip_space_and_texture_coordinates_agree():
    window, point = around(basis(KEYS[2]), FAR_OFF, 160.0, TEXELS), np.array([20.0, -30.0, 11.0])
    u, v, depth = window.rows(FAR_OFF) @ [*point, 1.0]
    np.testing.assert_allclose(window.clip(FAR_OFF) @ [*point, 1.0], [2 * u - 1, 1 - 2 * v, depth, 1.0])
    assert (window.rows(FAR_OFF) @ [*(point + KEYS[2]), 1.0])[2] > depth, "1 is towards the light"


def test_a_fitted_window_holds_its_spheres():
    axes = basis(KEYS[1])
    centres, radii = np.array([[0, 0, 1e4], [800.0, 30, 9500]]), np.array([2500.0, 40.0])
    window = about(axes, centres, radii)
    at = np.abs(centres @ axes.T - window.middle) + radii[:, None]
    assert (at <= window.half * (1 + 1e-9)).all()


# ---- which are drawn -------------------------------------------------------------------------------------


def test_a_still_camera_draws_each_map_once():
    keep = Keep(REACHES, TEXELS)
    assert keep.due(KEYS[0], FAR_OFF) == [0, 1, 2, 3]
    assert keep.due(KEYS[0], FAR_OFF) == []
    keep.change()
    assert keep.due(KEYS[0], FAR_OFF) == [0, 1, 2, 3]


def test_what_is_drawn_does_not_depend_on_the_way():
    one, other = Keep(REACHES, TEXELS), Keep(REACHES, TEXELS)
    for n in range(100):
        one.due(unit(KEYS[0] + [0.001 * n, 0, 0]), FAR_OFF - [3.0 * (99 - n), 0, 0])
    other.due(unit(KEYS[0] + [0.099, 0, 0]), FAR_OFF)
    assert one.windows == other.windows


def test_a_walk_draws_few_maps():
    keep, drawn = Keep(REACHES, TEXELS), 0
    keep.due(KEYS[0], FAR_OFF)
    for n in range(300):  # ten seconds at 3 m/s
        drawn += len(keep.due(KEYS[0], FAR_OFF + np.array([0.1 * n, 0.0, 0.0])))
    assert drawn <= 12


def test_the_light_they_are_drawn_for_is_near():
    for number in range(4):
        for key in KEYS:
            assert np.linalg.norm(axes_near(key, number)[2] - key) < 4e-4


# ---- what they say ---------------------------------------------------------------------------------------


class Stage:
    """Models alone, with the maps of things and a pass that asks at places."""

    def __init__(self, device, monkeypatch, models, wide=False):
        find_probes(monkeypatch, __file__)
        self.world = fs.World(models=models)
        self.placed = PlacedModels(self.world)
        self.graph = FrameGraph(device)
        self.view = self.graph.uniform("view", VIEW)
        add_gbuffer(self.graph, SIZE)
        self.models = Models(self.graph, self.placed)
        self.cascades = Cascades(self.graph, 40.0, plants=None, models=self.models, wide=wide)
        for name in ("places", "normals"):
            self.graph.buffer_data(name, np.zeros((PLACES, 4), np.float32))
        self.graph.buffer("found", 4 * PLACES)
        self.graph.compute(
            "probe",
            "package::cascade_probe",
            bind={**self.cascades.bind, "places": "places", "normals": "normals", "found": "found"},
            groups=(PLACES // 64, 1, 1),
            structs=self.cascades.structs,
            constants=self.cascades.constants,
            flags=self.cascades.flags,
        )
        self.graph.output("found", "shadows.maps")
        self.graph.compile()

    def look(self, camera, key, places, normals=None, seconds=0.0, fresh=True, heading=0.0):
        """Light at places (n, 3) in world coordinates."""
        c, s = np.cos(heading), np.sin(heading)
        turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1.0]])
        eye = CameraState(np.asarray(camera, float), turn, np.radians(60.0))
        now = datetime(2025, 6, 1, tzinfo=UTC)
        radius = self.world.planet.radius
        frame = round(seconds * 30)
        state = FrameState(
            frame, seconds, now, 0.0, 1, SIZE, radius, eye, eye, seconds=seconds, previous_seconds=seconds
        )
        self.view.set(**view_values(state))
        self.models.update(state)
        self.cascades.update(key, state, fresh)
        count = len(places)
        at, upright = np.zeros((PLACES, 4), np.float32), np.zeros((PLACES, 4), np.float32)
        at[:count, :3] = np.asarray(places) - eye.position
        normals = np.tile([0.0, 0.0, 1.0], (count, 1)) if normals is None else normals
        upright[:count, :3], upright[:count, 3] = normals, normals @ key
        self.graph.upload("places", at)
        self.graph.upload("normals", upright)
        self.graph.execute()
        return np.array(self.graph.read("found")).view(np.float32)[:count]


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    folder = tmp_path_factory.mktemp("things")
    flat = np.array([[-1, 0, -1], [1, 0, -1], [1, 0, 1], [-1, 0, 1]], np.float32) * 65.0
    sheet = Maker().primitive(np.array([0, 2, 1, 0, 3, 2], np.uint16), POSITION=flat)
    return {
        "cube": str(Maker().cube().save(folder / "cube.glb")),
        "sheet": str(sheet.save(folder / "sheet.glb")),
    }


def ground(about, half, n=100):
    """A square of n x n places at height 0."""
    x = np.linspace(-half, half, n)
    at = np.stack(np.meshgrid(x, x), -1).reshape(-1, 2)
    return np.column_stack([at + about, np.zeros(n * n)])


def toward(azimuth, elevation):
    a, e = np.radians([azimuth, elevation])
    return np.array([np.sin(a) * np.cos(e), np.cos(a) * np.cos(e), np.sin(e)])


def triangles_of(stage, name):
    """World corners of a model's triangles (m, 3, 3) at second 0."""
    positions, _, faces = cube()
    world = stage.placed[name].at(0, 0.0)[0]
    corners = positions.astype(float) @ world[:3, :3].T + world[:3, 3]
    return corners[faces]


@pytest.mark.parametrize("wide", [False, True])
@pytest.mark.parametrize("moving", [False, True])
def test_no_acne_on_tilted_planes(device, monkeypatch, files, wide, moving):
    """An endless sheet under light that leans from 0 to 85 degrees: all of it is lit."""
    thing = {"file": files["sheet"], "name": "sheet", "above": "sea", "height": 0.0}
    stage = Stage(device, monkeypatch, [thing], wide)
    if moving:
        stage.placed["sheet"].transform = stage.placed["sheet"].at(0, 0.0)
    rng, dark = np.random.default_rng(7), {}
    for tilt in (0, 15, 30, 45, 60, 70, 75, 80, 85):
        for azimuth in (0.0, 30.0, 45.0):
            places = np.column_stack([rng.uniform(-30, 30, (4000, 2)), np.zeros(4000)])
            light = stage.look([0.0, 0.0, 2.0], toward(azimuth, 90.0 - tilt), places)
            dark[tilt, azimuth] = int((light < 1.0 - 0.5 / 255).sum())
    assert {k: v for k, v in dark.items() if v} == {}


@pytest.mark.parametrize("wide", [False, True])
@pytest.mark.parametrize("elevation", [20.0, 60.0])
def test_a_cubes_shadow_is_the_one_that_rays_say(device, monkeypatch, files, elevation, wide):
    """But for a seam of a few texels, as wide as the filter and what keeps a surface off itself."""
    thing = {"file": files["cube"], "name": "cube", "above": "sea"}
    thing |= {"height": 3.0, "east": 10.0, "heading": 20.0}
    stage = Stage(device, monkeypatch, [thing], wide)
    key = toward(250.0, elevation)
    places = ground(np.array([10.0, 0.0]) - key[:2] / key[2] * 3.0, 6.0)
    light = stage.look([0.0, 0.0, 2.0], key, places)
    triangles = triangles_of(stage, "cube")
    around_it = [shaded(places, key, triangles)]
    seam = (6.0 if wide else 3.0) * stage.cascades._window(0).texel(TEXELS)
    for turn in np.arange(0.0, 2.0 * np.pi, np.pi / 4.0):
        off = np.array([np.cos(turn), np.sin(turn), 0.0]) @ basis(key)
        around_it.append(shaded(places + seam * off, key, triangles))
    dark, lit = np.all(around_it, axis=0), ~np.any(around_it, axis=0)
    assert dark.sum() > 150
    assert light[dark].max() < 0.01
    assert light[lit].min() > 0.99


def test_the_shadow_falls_twenty_kilometres_below(device, monkeypatch, files):
    """A ship 3 km long, as far up: what a map along the light holds, it holds for any distance."""
    thing = {"file": files["cube"], "name": "ship", "above": "sea", "height": 2e4, "scale": 1500.0}
    stage = Stage(device, monkeypatch, [thing])
    key = toward(130.0, 40.0)
    foot = -key[:2] / key[2] * 2e4
    places = ground(foot, 4000.0)
    light = stage.look([*foot, 50.0], key, places)
    dark = shaded(places, key, triangles_of(stage, "ship"))
    assert dark.sum() > 1000
    assert ((light < 0.5) & dark).sum() / ((light < 0.5) | dark).sum() > 0.98


def test_a_mover_is_never_half_in_shadow(device, monkeypatch, files):
    """In every frame of a flight its shadow is that of a map drawn afresh, and there is only one."""
    still = {"file": files["cube"], "name": "rock", "above": "sea", "height": 1.0, "north": 8.0}
    ways = [{"at": 0.0, "east": -20.0}, {"at": 1.0, "east": 20.0}]
    mover = {"file": files["cube"], "name": "bird", "above": "sea", "height": 4.0, "keyframes": ways}
    stage, fresh = (Stage(device, monkeypatch, [still, mover]) for _ in range(2))
    key, places = toward(180.0, 70.0), ground((0.0, 2.0), 22.0)
    for n in range(12):
        at = n / 12.0
        camera = [0.3 * n, -3.0, 2.0]
        kept = stage.look(camera, key, places, seconds=at, fresh=n == 0)
        anew = fresh.look(camera, key, places, seconds=at, fresh=True)
        np.testing.assert_array_equal(kept, anew)
        east = stage.placed["bird"].at(0, at)[0, 0, 3]
        lies = places[(kept < 0.5) & (places[:, 1] < 6.0), 0]
        assert len(lies) and np.abs(lies - east).max() < 1.6
    assert stage.cascades.drawn == {stage.cascades._moving}


def test_the_nearest_mover_has_a_fine_map(device, monkeypatch, files):
    """Two cubes a kilometre apart: each throws its shadow, and the nearer one's has fine texels."""
    ways = [{"at": 0.0, "heading": 0.0}, {"at": 9.0, "heading": 90.0}]
    things = [
        {"file": files["cube"], "name": n, "above": "sea", "height": 5.0, "east": e, "keyframes": ways}
        for n, e in (("near", 0.0), ("far", 1000.0))
    ]
    stage, key = Stage(device, monkeypatch, things), toward(180.0, 60.0)
    for camera, close in ((0.0, 0.0), (900.0, 1000.0)):
        around_it = ground((close, 5.0 / np.tan(np.radians(60.0))), 3.0)
        light = stage.look([camera, -5.0, 2.0], key, around_it, fresh=False)
        dark = shaded(around_it, key, triangles_of(stage, "near" if close == 0.0 else "far"))
        assert stage.cascades._window(stage.cascades._moving).texel(TEXELS) < 0.01
        assert ((light < 0.5) != dark).mean() < 0.02
        other = ground((1000.0 - close, 5.0 / np.tan(np.radians(60.0))), 3.0)
        assert stage.look([camera, -5.0, 2.0], key, other, fresh=False).min() < 0.5


def test_turning_and_a_tenth_of_a_texel_change_nothing(device, monkeypatch, files):
    """Shimmer: the same places, as the camera turns and moves by a tenth of the finest texel."""
    thing = {"file": files["cube"], "name": "cube", "above": "sea", "height": 2.0, "heading": 33.0}
    stage = Stage(device, monkeypatch, [thing])
    key, places = toward(160.0, 35.0), ground((0.0, 2.0), 6.0)
    first = stage.look([0.0, 0.0, 2.0], key, places)
    assert 200 < (first < 0.5).sum() < 8000
    flips = 0
    for n in range(1, 25):
        eye = [0.0086 * n, 0.0043 * n, 2.0]
        light = stage.look(eye, key, places, fresh=False, heading=0.1 * n)
        flips += int(((light < 0.5) != (first < 0.5)).sum())
        assert np.abs(light - first).max() < 0.03
    assert flips == 0
