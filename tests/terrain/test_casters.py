"""Plants, stones and the ground's mesh in a map seen along the light."""

from __future__ import annotations

from datetime import UTC, datetime
from types import SimpleNamespace

import numpy as np
import pytest
from ground import Ground

from fallstreak.frame.gbuffer import COLOR, DEPTH, add_gbuffer
from fallstreak.gpu import VIEW, FrameGraph
from fallstreak.terrain.frame import TERRAIN_FRAME
from fallstreak.terrain.vegetation import Vegetation
from fallstreak.terrain.vegetation.casters import caster_rooms
from fallstreak.world.state import (
    CameraState,
    FrameState,
    camera_rotation,
    local_axes,
    map_coordinates,
    position_on_planet,
    view_values,
)

RADIUS = 6_360_000.0
NOW = datetime(2025, 6, 1, tzinfo=UTC)
PALETTE = ("forest_floor", "scree", "grass", "shrubs", "turf", "soil")
TEXELS, RANGE = 512, 2000.0


def light_axes(elevation, azimuth):
    """Right, up and towards the light, rows."""
    e, a = np.radians([elevation, azimuth])
    toward = np.array([np.cos(e) * np.sin(a), np.cos(e) * np.cos(a), np.sin(e)])
    right = np.array([np.cos(a), -np.sin(a), 0.0])
    return np.array([right, np.cross(toward, right), toward])


def light_matrix(axes, half):
    out = np.eye(4)
    out[:3, :3] = axes / np.array([half, half, 2.0 * RANGE])[:, None]
    out[2, 3] = 0.5
    return out


class Shade:
    """Plants on flat ground that feeds them everywhere, and a map of what throws shadows."""

    def __init__(self, device, radius=120.0, material="alpine"):
        self.size = (64, 36)
        self.graph = graph = FrameGraph(device)
        self.view = graph.uniform("view", VIEW)
        self.frame = graph.uniform("terrain.frame", TERRAIN_FRAME)
        add_gbuffer(graph, self.size)
        terrain = SimpleNamespace(material=material, vegetation=1.0, wind=0.0)
        self.plants = Vegetation(
            graph,
            SimpleNamespace(terrain=terrain, seed=7),
            SimpleNamespace(vegetation_radius=radius, vegetation_pixels=(90.0, 30.0)),
            PALETTE,
            ground="package::terrain::vegetation::selftest_ground",
        )
        self.light = graph.uniform("light", VIEW)
        self.due = True
        graph.texture("map", "depth32float", (TEXELS, TEXELS), persistent=True)
        self.plants.add_casters(graph, "shade", view="light", depth="map", when=lambda: self.due)
        graph.output(*COLOR, DEPTH, "map", "shade.plants.draws", "shade.plants.placed", "plants.draws")
        graph.compile()

    def draw(self, elevation=40.0, azimuth=130.0, half=100.0, heading=0.0, height=20.0):
        eye = CameraState(
            position_on_planet(0.0, 0.0, height, RADIUS),
            camera_rotation(np.radians(heading), np.radians(-15.0), 0.0, local_axes(0.0, 0.0, RADIUS)),
            np.radians(50.0),
        )
        state = FrameState(0, 0.0, NOW, 0.0, 7, self.size, RADIUS, eye, eye, (0.0, 0.0))
        values = view_values(state)
        self.view.set(**values)
        self.axes = light_axes(elevation, azimuth)
        self.half = half
        values["clip_from_world"] = light_matrix(self.axes, half)
        values["size"] = (TEXELS, TEXELS)
        self.light.set(**values)
        self.frame.set(camera_map=map_coordinates(eye.position, RADIUS), camera_height=state.altitude)
        self.plants.update(state, height)
        self.graph.execute()

    def map(self):
        return np.array(self.graph.read("map")).reshape(TEXELS, TEXELS)

    def casters(self, kind):
        """Clip-space places (n, 3) of a kind's casters."""
        index = [s.kind.name for s in self.plants.stands].index(kind)
        raw = np.array(self.graph.read("shade.plants.placed")).view(np.uint32).reshape(-1, 12)
        count = np.array(self.graph.read("shade.plants.draws")).view(np.uint32).reshape(-1, 5)[index, 1]
        first = caster_rooms(self.plants.stands)[index][0]
        return raw[first : first + count, :3].copy().view(np.float32)


def test_a_map_holds_every_plant_where_it_stands(device):
    """Looked down on from the zenith: a tree covers the texel it stands on, at half its height or above."""
    shade = Shade(device)
    shade.draw(elevation=89.9, half=60.0)
    places = shade.casters("conifer")
    assert len(places) > 200
    depth = shade.map()
    inside = places[(np.abs(places[:, :2]) < 0.98).all(1)]
    column = ((inside[:, 0] + 1) / 2 * TEXELS).astype(int)
    row = ((1 - inside[:, 1]) / 2 * TEXELS).astype(int)
    top = np.max([depth[row + i, column + j] for i in (-2, 0, 2) for j in (-2, 0, 2)], axis=0)
    above = (top - inside[:, 2]) * 2.0 * RANGE  # m over the middle of the plant
    assert (above > 0.0).mean() > 0.95
    assert above.max() < 24.0
    assert 0.05 < (depth > 0).mean() < 0.95


def test_plants_behind_the_camera_cast(device):
    """A map does not change as the camera turns."""
    shade = Shade(device)
    found = []
    for heading in (0.0, 180.0):
        shade.draw(heading=heading)
        found.append((shade.map() > 0, len(shade.casters("conifer"))))
    assert found[0][1] == found[1][1] > 300
    assert np.array_equal(found[0][0], found[1][0])


def test_a_plant_leans_from_its_foot_to_behind_its_crown(device):
    """From the foot up what throws the shadow lies ever farther behind the stem: crowns have light."""
    shade = Shade(device, radius=60.0)
    shade.draw(elevation=30.0, half=30.0)
    depth, places = shade.map(), shade.casters("conifer")
    places = places[(np.abs(places[:, :2]) < 0.95).all(1)]
    column = ((places[:, 0] + 1) / 2 * TEXELS).astype(int)
    row = ((1 - places[:, 1]) / 2 * TEXELS).astype(int)
    # `places` is where the picture's middle is put; its stem stands nearer to the light
    away = (depth[row, column] - places[:, 2]) * 2.0 * RANGE
    assert len(places) > 20
    # what lies behind it is seen through the gaps of the crown
    assert 0.02 < (away < -0.3).mean() < 0.3
    assert (np.abs(away) < 0.3).mean() > 0.1
    # flat ground 20 m below the camera: how high over it the point of the stem is that was moved back
    across, along = places[:, :2] * shade.half, (places[:, 2] - 0.5) * 2.0 * RANGE
    put = across @ shade.axes[:2] + along[:, None] * shade.axes[2]
    assert np.all(put[:, 2] + 20.0 < 24.0 / 2)
    lower = (put[:, 2] + 20.0).mean()
    assert 0.5 < lower < 6.0


@pytest.mark.parametrize("elevation", [3.0, 20.0])
def test_what_stands_behind_the_near_side_still_casts(device, elevation):
    """A low sun: trees far towards it throw shadows into the map, and depth stays within 0..1."""
    shade = Shade(device)
    shade.draw(elevation=elevation, half=15.0)
    places = shade.casters("conifer")
    along = (places[:, 2] - 0.5) * 2.0 * RANGE
    assert along.max() > 60.0 and along.min() < -60.0
    assert shade.map().max() <= 1.0


def test_what_is_only_a_few_texels_high_is_thinned_out_and_what_is_smaller_left_out(device):
    shade = Shade(device)
    found = []
    for half in (150.0, 900.0, 9000.0):
        shade.draw(half=half)
        found.append(len(shade.casters("conifer")))
    assert 0 < found[1] < 0.8 * found[0] and found[2] == 0


def test_true_shadows_take_the_place_of_assumed_ones(device):
    """Plants are not darkened by neighbours whose shadows are drawn."""
    shade = Shade(device)
    shade.draw()
    assert shade.graph.uniforms["plants"].record["sun_shade"] == 0.0


def test_nothing_runs_that_is_not_due(device):
    shade = Shade(device)
    shade.draw()
    before = shade.map()
    shade.due = False
    shade.draw(azimuth=200.0)
    ran = {p["name"]: p["ran"] for p in shade.graph.stats()["passes"]}
    assert not any(ran[name] for name in ran if name.startswith("shade."))
    assert np.array_equal(before, shade.map())


# ---- the ground's mesh -----------------------------------------------------------------------------------


class ShadingGround(Ground):
    def declare_more(self):
        self.light = self.graph.uniform("light", VIEW)
        self.graph.texture("map", "depth32float", (TEXELS, TEXELS), persistent=True)
        self.terrain.add_casters(self.graph, "shade", view="light", depth="map", when=lambda: True)
        self.graph.output("map")

    def draw_along(self, axes, half, *view):
        state = self.state(*view)
        self.light.set(
            **view_values(state) | {"clip_from_world": light_matrix(axes, half), "size": (TEXELS, TEXELS)}
        )
        return self.draw(*view)

    def seen(self, state):
        """Camera-relative places of the pixels that show ground (n, 3)."""
        width, height = state.size
        depth = self.read("gbuffer.depth").reshape(height, width).astype(float)
        row, column = np.nonzero(depth > 0)
        clip = np.stack(
            [
                2 * (column + 0.5) / width - 1,
                1 - 2 * (row + 0.5) / height,
                depth[row, column],
                np.ones(len(row)),
            ]
        )
        at = np.linalg.inv(np.asarray(view_values(state)["clip_from_world"], float)) @ clip
        return (at[:3] / at[3]).T


@pytest.mark.parametrize("elevation", [80.0, 35.0])
def test_the_mesh_that_shades_is_the_one_that_is_seen(device, elevation):
    """No point that is seen lies nearer to the light than the map says; most lie on it."""
    ground = ShadingGround(device)
    axes, half = light_axes(elevation, 200.0), 400.0
    state = ground.draw_along(axes, half, -5200.0, 3100.0, 60.0, 10.0, -40.0)
    places = ground.seen(state)
    clip = places @ (axes / half)[:2].T
    inside = (np.abs(clip) < 0.95).all(1)
    along = places[inside] @ axes[2]
    x, y = clip[inside].T
    depth = ground.read("map").reshape(TEXELS, TEXELS)
    held = depth[((1 - y) / 2 * TEXELS).astype(int), ((x + 1) / 2 * TEXELS).astype(int)]
    away = (held - 0.5) * 2.0 * RANGE - along
    texel = 2.0 * half / TEXELS
    assert inside.sum() > 2000
    assert np.all(held > 0)
    assert away.min() > -4.0 * texel and np.median(np.abs(away)) < 0.5 * texel
    assert (np.abs(away) < 2.0 * texel).mean() > 0.9
