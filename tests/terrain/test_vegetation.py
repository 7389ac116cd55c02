"""Plants and rocks: their shapes, where they stand, how levels of detail share pixels, how they sway."""

from __future__ import annotations

from datetime import UTC, datetime
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest

import fallstreak as fs
from fallstreak.frame.gbuffer import COLOR, DEPTH, add_gbuffer
from fallstreak.gpu import VIEW, FrameGraph
from fallstreak.noise.scatter import hash_lattice
from fallstreak.terrain.frame import TERRAIN_FRAME
from fallstreak.terrain.passes import Terrain
from fallstreak.terrain.vegetation import Vegetation, cards
from fallstreak.terrain.vegetation.flora import FLORA, KINDS
from fallstreak.terrain.vegetation.passes import PERIOD
from fallstreak.terrain.vegetation.stands import LEVELS
from fallstreak.world.quality import QUALITY
from fallstreak.world.state import (
    CameraState,
    FrameState,
    camera_rotation,
    local_axes,
    map_coordinates,
    position_on_planet,
    view_values,
)

SIZE = (160, 90)
RADIUS = 6_360_000.0
PALETTE = ("forest_floor", "scree", "grass", "shrubs", "turf", "soil")
NOW = datetime(2025, 6, 1, tzinfo=UTC)


def camera(east, north, height, heading, pitch, radius=RADIUS, fov=50.0):
    return CameraState(
        position_on_planet(east, north, height, radius),
        camera_rotation(np.radians(heading), np.radians(pitch), 0.0, local_axes(east, north, radius)),
        np.radians(fov),
    )


class Meadow:
    """Plants alone on flat ground that feeds them everywhere."""

    def __init__(
        self, device, material="alpine", radius=120.0, pixels=(90.0, 30.0), wind=0.0, density=1.0, size=SIZE
    ):
        terrain = SimpleNamespace(material=material, vegetation=density, wind=wind)
        quality = SimpleNamespace(vegetation_radius=radius, vegetation_pixels=pixels)
        self.size = size
        self.graph = FrameGraph(device)
        self.view = self.graph.uniform("view", VIEW)
        self.frame = self.graph.uniform("terrain.frame", TERRAIN_FRAME)
        add_gbuffer(self.graph, size)
        self.plants = Vegetation(
            self.graph,
            SimpleNamespace(terrain=terrain, seed=7),
            quality,
            PALETTE,
            ground="package::terrain::vegetation::selftest_ground",
        )
        if self.plants.stands:
            self.graph.output(*COLOR, DEPTH, "plants.draws", "plants.placed")
        self.graph.compile()

    def draw(self, *pose, time=0.0, delta=0.0, jitter=(0.0, 0.0), above=0.0):
        eye = camera(*pose)
        state = FrameState(0, time, NOW, delta, 7, self.size, RADIUS, eye, eye, jitter)
        self.view.set(**view_values(state))
        east, north = map_coordinates(eye.position, RADIUS)
        self.frame.set(camera_map=(east, north), camera_height=state.altitude)
        self.plants.update(state, above)
        self.graph.execute()

    def read(self, name):
        return np.array(self.graph.read(name))

    def counts(self):
        """(kinds, levels) instances drawn."""
        return self.read("plants.draws").view(np.uint32).reshape(-1, 5)[:, 1].reshape(-1, LEVELS)

    def placed(self, kind, level):
        """Camera-relative foot (n, 3), height (n,), hash-like words (n, 4) of what a draw draws."""
        names = [s.kind.name for s in self.plants.stands]
        index = names.index(kind)
        raw = self.read("plants.placed").view(np.uint32).reshape(-1, 8)
        first = self.plants.stands[index].first[level]
        rows = raw[first : first + self.counts()[index, level]]
        floats = rows[:, :4].copy().view(np.float32)
        return floats[:, :3], floats[:, 3], rows[:, 4:]

    def surface(self):
        """Whether a pixel shows a plant or rock (H, W)."""
        return self.read("gbuffer.depth").reshape(self.size[1], self.size[0]) > 0.0


def interval(words):
    return np.stack([words[:, 3] & 0xFFFF, words[:, 3] >> 16], 1) / 65535.0


# ---- shapes ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("level", [0, 1])
@pytest.mark.parametrize("kind", KINDS, ids=lambda k: k.name)
def test_meshes_stand_on_the_ground_and_are_one_high(kind, level):
    mesh = kind.mesh(level)
    z = mesh.vertices["place"][:, 2]
    assert -0.4 < z.min() < 0.0  # rocks lie in the ground
    assert 0.8 < z.max() < 1.15
    assert mesh.indices.max() == len(mesh.vertices) - 1
    length = np.linalg.norm(mesh.vertices["normal"][:, :3].astype(float), axis=1)
    assert np.all((length > 120) & (length < 134))


@pytest.mark.parametrize("kind", KINDS, ids=lambda k: k.name)
def test_the_coarse_mesh_has_the_outline_of_the_fine_one_for_far_less(kind):
    fine, coarse = kind.mesh(0), kind.mesh(1)
    assert coarse.triangles < 0.5 * fine.triangles

    def widths(mesh):
        place = mesh.vertices["place"][(mesh.vertices["look"][:, 3] > 0) | (kind.tile is None)]
        rings = np.digitize(place[:, 2], [0.25, 0.5, 0.75])
        return np.array([np.hypot(*place[rings == k, :2].T).mean() for k in (1, 2, 3)])

    assert np.abs(widths(coarse) / widths(fine) - 1.0).max() < 0.35


def test_cards_are_multiplied_by_their_coverage():
    layers = cards.cards().astype(int)
    assert layers.shape == (4, cards.SIZE, cards.SIZE, 4)
    assert np.all(layers[..., :3] <= layers[..., 3:] + 1)
    covered = (layers[..., 3] > 127).mean((1, 2))
    assert np.all((covered[:3] > 0.15) & (covered[:3] < 0.7)) and covered[3] == 1.0
    bark = layers[cards.BARK, ..., 0]
    step = np.abs(np.diff(bark, axis=0)).mean()
    assert np.abs(bark[0] - bark[-1]).mean() < 1.3 * step  # repeats without a seam


def test_every_species_is_of_a_kind_that_is_drawn():
    known = {kind.name for kind in KINDS}
    for country, species in FLORA.items():
        assert set(species) <= known, country


# ---- placement -------------------------------------------------------------------------------------------


def test_what_stands_where_is_a_function_of_the_cell(device):
    """The lattice worked out in numpy: every conifer that is drawn stands where its cell says."""
    meadow = Meadow(device)
    meadow.draw(40_003.0, -25_001.0, 30.0, 20.0, -15.0)
    feet = np.concatenate([meadow.placed("conifer", level)[0] for level in range(3)])
    assert len(feet) > 60
    cell = KINDS[0].cell
    east, north = map_coordinates(camera(40_003.0, -25_001.0, 30.0, 0, 0).position, RADIUS)
    # near the camera the map is flat, but for the turn of its axes so far from the anchor
    across = feet @ local_axes(east, north, RADIUS)[:, :2] + [east, north]
    cells = np.floor(across / cell).astype(int)
    h = hash_lattice(cells[:, 0], cells[:, 1], (7 * 2654435761 + 977) & 0xFFFFFFFF)
    part = np.stack([h & 0xFFFF, h >> 16], 1) / 65536.0
    wanted = (cells + part) * cell
    assert np.abs(across - wanted).max() < 0.02
    assert np.abs(feet @ local_axes(east, north, RADIUS)[:, 2] + 30.0).max() < 0.01


def test_plants_do_not_depend_on_where_they_are_seen_from(device):
    meadow = Meadow(device)
    found = []
    for east in (0.0, 23.0):
        meadow.draw(east, 0.0, 20.0, 0.0, -10.0)
        parts = [meadow.placed("conifer", level) for level in range(3)]
        feet = np.concatenate([p[0] for p in parts]) + np.array([east, 0.0, 20.0])
        look = np.concatenate([np.column_stack([p[1], p[2][:, 1:3]]) for p in parts])
        order = np.unique(np.round(feet[:, :2], 1), axis=0, return_index=True)[1]
        found.append({tuple(np.round(feet[i, :2], 1)): look[i] for i in order})
    shared = set(found[0]) & set(found[1])
    assert len(shared) > 100
    assert all(np.array_equal(found[0][k], found[1][k]) for k in shared)  # height, turn, width, colour


def test_levels_of_detail_share_every_plant_without_gap_or_overlap(device):
    meadow = Meadow(device)
    meadow.draw(0.0, 0.0, 15.0, 0.0, -10.0)
    assert np.all(meadow.counts()[0] > 0)
    parts: dict[tuple, list] = {}
    for level in range(3):
        feet, _, words = meadow.placed("conifer", level)
        for foot, (low, high) in zip(feet, interval(words), strict=True):
            parts.setdefault(tuple(foot), []).append((low, high))
    far = 0.61 * 120.0  # where the first ones start to leave
    shared = 0
    for foot, drawn in parts.items():
        drawn.sort()
        shared += len(drawn) > 1
        assert drawn[0][0] == 0.0
        assert all(a[1] == b[0] for a, b in pairwise(drawn))
        if np.linalg.norm(foot) < far:
            assert drawn[-1][1] == 1.0
    assert shared > 5


def test_nothing_grows_without_density_or_country(device):
    assert Meadow(device, density=0.0).plants.stands == []
    sparse, dense = Meadow(device, density=0.25), Meadow(device)
    for meadow in (sparse, dense):
        meadow.draw(0.0, 0.0, 20.0, 0.0, -10.0)
    share = sparse.counts()[0].sum() / dense.counts()[0].sum()
    assert 0.15 < share < 0.35


def test_a_hundred_thousand_instances(device):
    """All are drawn, by as many calls as a few are."""
    few = Meadow(device, radius=60.0)
    many = Meadow(device, radius=2400.0, pixels=(400.0, 200.0), size=(640, 360))
    few.draw(0.0, 0.0, 20.0, 0.0, -10.0)
    many.draw(0.0, 0.0, 700.0, 0.0, -89.0, RADIUS, 100.0)
    assert many.counts().sum() > 100_000
    assert many.surface().mean() > 0.3
    assert few.graph.stats()["calls"] == many.graph.stats()["calls"]


def test_far_above_the_ground_plants_cost_nothing(device):
    meadow = Meadow(device, radius=60.0)
    for above, expected in ((20.0, True), (5000.0, False), (30.0, True)):
        meadow.draw(0.0, 0.0, above, 0.0, -10.0, above=above)
        ran = {p["name"]: p["ran"] for p in meadow.graph.stats()["passes"]}
        assert ran["plants.placement"] == ran["plants.conifer2"] == expected
        assert meadow.surface().any() or not expected


def test_impostors_get_their_pictures_before_they_are_drawn(device):
    """All in a first frame that may come near soon; on the way down from far one kind a frame; none twice."""
    ways = {"near": (150.0, 150.0, 150.0, 20.0), "down": (5000.0, 200.0, 190.0, 180.0, 170.0, 20.0)}
    baked = {}
    for name, way in ways.items():
        meadow, baked[name] = Meadow(device, radius=60.0), []
        for above in way:
            meadow.draw(0.0, 0.0, above, 0.0, -10.0, above=above)
            ran = meadow.graph.stats()["passes"]
            baked[name].append(sum(p["ran"] for p in ran if p["name"].endswith(".bake")))
    kinds = sum(s.kind.tile is not None for s in meadow.plants.stands)
    assert baked == {"near": [kinds, 0, 0, 0], "down": [0, *[1] * kinds, *[0] * (5 - kinds)]}


def test_the_feet_stand_on_the_ground_that_is_drawn(device):
    """Looked at from above, a foot is as deep as the mesh of the bare ground there."""
    world = fs.load("jacksboro", overrides=["terrain.extent=20000"])
    graphs = []
    for density in (0.0, 1.0):
        graph = FrameGraph(device)
        view = graph.uniform("view", VIEW)
        add_gbuffer(graph, SIZE)
        terrain = Terrain(device, graph, world.updated({"terrain.vegetation": density}), QUALITY["low"], SIZE)
        graph.output(*COLOR, DEPTH)
        if density:
            graph.output("plants.draws", "plants.placed")
        graph.compile()
        graphs.append((graph, view, terrain))
    errors = []
    for east, north, above in ((-600.0, -7400.0, 60.0), (900.0, 2200.0, 120.0)):
        eye = camera(east, north, world.terrain.height(east, north) + above, 0.0, -89.9, world.planet.radius)
        state = FrameState(0, 0.0, NOW, 0.0, world.seed, SIZE, world.planet.radius, eye, eye)
        for graph, view, terrain in graphs:
            view.set(**view_values(state))
            terrain.update(state)
            graph.execute()
        depth = eye.near / np.array(graphs[0][0].read(DEPTH)).reshape(SIZE[1], SIZE[0])
        graph, _, terrain = graphs[1]
        raw = np.array(graph.read("plants.placed")).view(np.uint32).reshape(-1, 8)
        counts = np.array(graph.read("plants.draws")).view(np.uint32).reshape(-1, 5)[:, 1]
        rows = []
        for i, stand in enumerate(terrain.vegetation.stands):
            if stand.kind.leans == 0.0:  # others are sunk into slopes
                first = zip(stand.first, counts[i * LEVELS :], strict=False)
                rows += [raw[a : a + n, :3] for a, n in first]
        feet = np.concatenate(rows).copy().view(np.float32).astype(float)
        clip = np.asarray(view_values(state)["clip_from_world"])
        at = np.column_stack([feet, np.ones(len(feet))]) @ clip.T
        x = (at[:, 0] / at[:, 3] * 0.5 + 0.5) * SIZE[0] - 0.5
        y = (0.5 - at[:, 1] / at[:, 3] * 0.5) * SIZE[1] - 0.5
        inside = (x > 0) & (x < SIZE[0] - 1) & (y > 0) & (y < SIZE[1] - 1)
        x, y, at = x[inside], y[inside], at[inside]
        c, r = x.astype(int), y.astype(int)
        fx, fy = x - c, y - r
        upper = depth[r, c] * (1 - fx) + depth[r, c + 1] * fx
        lower = depth[r + 1, c] * (1 - fx) + depth[r + 1, c + 1] * fx
        errors.append(np.abs(at[:, 3] - (upper * (1 - fy) + lower * fy)))
    found = np.concatenate(errors)
    assert len(found) > 200
    # what is left is the depth's own interpolation between pixels of half a metre
    assert np.median(found) < 0.02 and np.percentile(found, 95) < 0.15, found


# ---- wind ------------------------------------------------------------------------------------------------


def motion(meadow):
    raw = meadow.read("gbuffer.motion")
    raw = raw if raw.dtype == np.float16 else raw.view(np.float16)
    return raw.reshape(SIZE[1], SIZE[0], 2).astype(float) * SIZE


def test_in_still_air_nothing_moves(device):
    meadow = Meadow(device)
    meadow.draw(0.0, 0.0, 2.0, 0.0, 5.0, time=10.0, delta=0.5)
    assert meadow.surface().mean() > 0.2
    assert np.abs(motion(meadow)).max() < 0.01


def test_the_wind_moves_crowns_and_says_so(device):
    """Motion vectors lead back to what the picture showed before."""
    meadow = Meadow(device, wind=14.0)
    pose = (0.0, 0.0, 2.0, 0.0, 5.0)
    meadow.draw(*pose, time=10.0, delta=0.2)
    moved = motion(meadow)
    surface = meadow.surface()
    speed = np.hypot(*np.moveaxis(moved[surface], -1, 0))
    assert 0.05 < np.percentile(speed, 90) < 8.0  # pixels in a fifth of a second
    now = meadow.read("gbuffer.albedo").reshape(SIZE[1], SIZE[0], 4)[..., :3].astype(float)
    meadow.draw(*pose, time=9.8)
    before = meadow.read("gbuffer.albedo").reshape(SIZE[1], SIZE[0], 4)[..., :3].astype(float)
    rows, columns = np.mgrid[: SIZE[1], : SIZE[0]]
    back = np.stack([rows - moved[..., 1], columns - moved[..., 0]], -1).round().astype(int)
    inside = surface & (back >= 0).all(-1) & (back < [SIZE[1], SIZE[0]]).all(-1)
    led = np.abs(now[inside] - before[back[inside][:, 0], back[inside][:, 1]]).mean()
    stayed = np.abs(now - before)[inside].mean()
    assert led < 0.75 * stayed


def test_sways_repeat_without_a_seam(device):
    meadow = Meadow(device, wind=14.0)
    pictures = []
    for time in (5.0, 5.0 + PERIOD, 5.5):
        meadow.draw(0.0, 0.0, 2.0, 0.0, 5.0, time=time)
        pictures.append(meadow.read("gbuffer.albedo").astype(int))
    assert np.array_equal(pictures[0], pictures[1])
    assert np.abs(pictures[0] - pictures[2]).max() > 20


# ---- levels of detail in the picture ---------------------------------------------------------------------


def test_impostors_look_like_their_meshes(device):
    """A stand drawn as pictures covers as much, and is as bright, as the same stand drawn as meshes."""
    pose = (0.0, 0.0, 6.0, 0.0, 0.0)
    stands = {}
    for name, pixels in {"mesh": (1.0, 0.5), "impostor": (1e5, 1e4)}.items():
        meadow = Meadow(device, radius=110.0, pixels=pixels, density=0.12)
        meadow.draw(*pose)
        counts = meadow.counts()[0]
        assert counts[0] > 5 * counts[2] if name == "mesh" else counts[0] == counts[1] == 0
        shown = meadow.surface()
        albedo = (meadow.read("gbuffer.albedo").reshape(SIZE[1], SIZE[0], 4)[..., :3] / 255.0) ** 2
        stands[name] = shown.mean(), albedo[shown].mean(0)
    assert stands["impostor"][0] == pytest.approx(stands["mesh"][0], rel=0.08)
    assert stands["impostor"][1] == pytest.approx(stands["mesh"][1], rel=0.1)


def test_pictures_are_the_same_every_time(device):
    """The order in which the GPU lists plants is chance and must not be seen."""
    meadow = Meadow(device)
    pictures = []
    for _ in range(3):
        meadow.draw(0.0, 0.0, 10.0, 0.0, -8.0)
        pictures.append([meadow.read(name) for name in (*COLOR, DEPTH)])
    for other in pictures[1:]:
        assert all(np.array_equal(a, b) for a, b in zip(pictures[0], other, strict=True))


def test_levels_of_detail_do_not_pop(device):
    """Along a flight, no 8 × 8 tile changes much more between frames than if all were pictures or meshes."""
    worst = {}
    for name, pixels in {"levels": (90.0, 30.0), "meshes": (1e5, 0.5), "pictures": (1e5, 1e4)}.items():
        meadow = Meadow(device, radius=130.0, pixels=pixels)
        before, changes = None, []
        for i in range(12):
            meadow.draw(0.0, -0.25 * i, 25.0, 0.0, -8.0)
            albedo = meadow.read("gbuffer.albedo").reshape(SIZE[1], SIZE[0], 4)[:88, :, :3].astype(float)
            tiles = albedo.reshape(11, 8, SIZE[0] // 8, 8, 3).mean((1, 3))
            if before is not None:
                changes.append(np.abs(tiles - before).max())
            before = tiles
        worst[name] = max(changes)
    assert worst["levels"] < 1.25 * max(worst["meshes"], worst["pictures"]), worst
    assert worst["levels"] < 40.0, worst  # of 255
