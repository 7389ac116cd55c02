"""The cloud-shadow map against the field's own extinction, summed up towards the light."""

from datetime import UTC, datetime
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from shader_probes import find_probes

from fallstreak.clouds import light
from fallstreak.clouds.field import field_of
from fallstreak.clouds.field.passes import FieldPasses
from fallstreak.clouds.shadow import CLOUD_SHADOW, ShadowMap
from fallstreak.clouds.shadow.model import LOWEST, REACHES, local_key, shadow_values
from fallstreak.clouds.shadow.schedule import MAPS, Schedule
from fallstreak.gpu import FrameGraph
from fallstreak.world import World
from fallstreak.world.state import CameraState, FrameState, position_on_planet

RADIUS = 6_360_000.0
PLACES = 512
TAKEN = 0.65


def direction(elevation, azimuth=210.0):
    e, a = np.radians([elevation, azimuth])
    return np.array([np.sin(a) * np.cos(e), np.cos(a) * np.cos(e), np.sin(e)])


class Stage:
    """A world's clouds and their shadows, seen from a place under a light."""

    def __init__(self, device, genus="cumulus_mediocris", coverage=0.4, texels=96):
        world = World(name="stage", clouds={"layers": [{"genus": genus, "coverage": coverage}]})
        self.field = field_of(world)
        self.graph = graph = FrameGraph(device)
        passes = FieldPasses(graph, self.field, cast(Any, SimpleNamespace(cloud_cells=96)))
        quality = SimpleNamespace(cloud_shadow=texels)
        self.clouds: Any = SimpleNamespace(
            graph=graph, quality=quality, field=passes, key=None, moonlit=False, fresh=True
        )
        self.shadow = ShadowMap(self.clouds)
        graph.buffer_data("places", np.zeros((PLACES, 4), np.float32))
        graph.buffer("found", PLACES * 16)
        graph.compute(
            "probe",
            "package::shadow_probe",
            bind={
                "shadow": "clouds.shadow_frame",
                "shadow_map": "clouds.shadow",
                "linear": "sampler:linear-clamp",
                "places": "places",
                "found": "found",
            },
            groups=(PLACES // 64, 1, 1),
            structs=[CLOUD_SHADOW],
        )
        graph.output("clouds.shadow", "clouds.overhead", "found")
        graph.compile()

    def look(self, places, elevation, camera: tuple[float, float] = (0.0, 0.0)):
        """(depth to the light, light past clouds, depth overhead) at map places (n, 3)."""
        self.clouds.key = direction(elevation)
        at = CameraState(position_on_planet(*camera, 100.0, RADIUS), np.eye(3), 1.0)
        when = datetime(2025, 6, 1, tzinfo=UTC)
        state = FrameState(0, 0.0, when, 0.0, 7, (16, 9), RADIUS, at, at)
        padded = np.zeros((PLACES, 4), np.float32)
        padded[: len(places), :3] = places - np.array([*camera, 0.0])
        self.graph.upload("places", padded)
        self.clouds.field.update(state)
        self.shadow.update(state)
        self.graph.execute()
        found = np.array(self.graph.read("found")).view(np.float32).reshape(-1, 4)
        return found[: len(places), :3].astype(float)

    def truth(self, places, key, steps=160):
        """The field's optical depth from places along a direction."""
        low, high = self.field.layers[0].bounds
        start = np.maximum(places[:, 2], low)
        heights = start[:, None] + (high - start)[:, None] * (np.arange(steps) + 0.5) / steps
        across = (heights - places[:, 2:]) / key[2]
        points = places[:, None] + across[..., None] * key
        found = self.field.extinction(points.reshape(-1, 3), 0.0).reshape(heights.shape)
        return found.sum(1) * (high - start) / steps / key[2]


@pytest.fixture(autouse=True)
def probes(monkeypatch):
    find_probes(monkeypatch, __file__)


@pytest.fixture(scope="module")
def fair(device):
    with pytest.MonkeyPatch.context() as patch:
        find_probes(patch, __file__)
        return Stage(device)


@pytest.mark.parametrize("elevation", [70.0, 30.0, 8.0])
def test_light_on_the_ground_is_the_field_s(fair, elevation):
    rng = np.random.default_rng(1)
    places = np.column_stack([rng.uniform(-8e3, 8e3, (400, 2)), rng.uniform(0, 300, 400)])
    got = fair.look(places, elevation)
    depth = fair.truth(places, direction(elevation))
    past = np.exp(-TAKEN * depth)
    # noise and where clouds touch are not in the map, and its texels are 60 and 250 m wide here
    assert got[:, 1].mean() == pytest.approx(past.mean(), abs=0.08)
    assert np.abs(got[:, 1] - past).mean() < 0.14
    assert np.corrcoef(got[:, 1], past)[0, 1] > 0.75
    assert got[:, 0].mean() == pytest.approx(depth.mean(), rel=0.25)


def test_only_what_lies_above_counts(fair):
    """A place in the middle of its clouds, above them all, below them all."""
    rng = np.random.default_rng(2)
    places = np.column_stack([rng.uniform(-2.5e3, 2.5e3, (400, 2)), rng.uniform(900, 2200, 400)])
    key = direction(50.0)
    got, depth = fair.look(places, 50.0)[:, 0], fair.truth(places, key)
    ground = fair.truth(places * [1, 1, 0], key)
    assert got.mean() == pytest.approx(depth.mean(), rel=0.25)
    assert np.corrcoef(got, depth)[0, 1] > 0.8
    assert depth.mean() < 0.8 * ground.mean()
    top = fair.field.layers[0].bounds[1]
    above = np.column_stack([places[:, :2], np.full(400, top + 50.0)])
    assert np.allclose(fair.look(above, 50.0), [0.0, 1.0, 0.0], atol=1e-3)


@pytest.mark.parametrize("elevation", [20.0, 10.0, 5.0])
def test_shade_within_clouds_under_a_low_sun(device, elevation):
    """A level ray meets several clouds: each has its own shade, and that of those before it."""
    stage = Stage(device, "cumulus_congestus", 0.25, texels=128)
    low, high = stage.field.layers[0].bounds
    rng = np.random.default_rng(3)
    places = np.column_stack([rng.uniform(-2.5e3, 2.5e3, (60_000, 2)), rng.uniform(low, high, 60_000)])
    within = stage.field.extinction(places, 0.0) > 0.3 * stage.field.layers[0].extinction
    places = places[within][:400]
    got = stage.look(places, elevation)[:, 0]
    depth = stage.truth(places, direction(elevation), steps=400)
    # about how diffuse light wanes
    seen, true = 1 / (1 + 0.15 * got), 1 / (1 + 0.15 * depth)
    assert seen.mean() == pytest.approx(true.mean(), abs=0.03)
    assert np.sqrt(np.mean((seen - true) ** 2)) < 0.13


def test_depth_straight_up(fair):
    rng = np.random.default_rng(4)
    places = np.column_stack([rng.uniform(-9e3, 9e3, (500, 2)), np.zeros(500)])
    got = fair.look(places, 30.0)[:, 2]
    depth = fair.truth(places, np.array([0.0, 0.0, 1.0]))
    # one ray a kilometre
    assert got.mean() == pytest.approx(depth.mean(), rel=0.3)


def test_shadows_stand_still_as_the_camera_moves(fair):
    rng = np.random.default_rng(5)
    places = np.column_stack([rng.uniform(-1e3, 1e3, (400, 2)), np.zeros(400)])
    here = fair.look(places, 40.0)
    there = fair.look(places, 40.0, camera=(317.0, -211.0))
    assert np.abs(here - there)[:, 1].max() < 0.02
    far = fair.look(places, 40.0, camera=(6000.0, 2500.0))  # now of the next map
    assert np.abs(here - far)[:, 1].mean() < 0.15


def test_light_under_an_overcast_sky_is_what_passes_it(device):
    """Straight and from all sides together: what a layer of that depth lets through."""
    stage = Stage(device, "stratus", 1.0)
    places = np.column_stack([np.random.default_rng(6).uniform(-9e3, 9e3, (400, 2)), np.zeros(400)])
    stage.look(places, 50.0)
    overhead = np.array(stage.graph.read("clouds.overhead")).astype(float)
    depth = stage.truth(places, np.array([0.0, 0.0, 1.0]))
    sine = np.sin(np.radians(50.0))
    all_light = light.layer_passes(depth, sine).mean()
    middle = overhead[8:24, 8:24].mean((0, 1))
    assert middle[2] == pytest.approx(all_light, rel=0.25)
    assert middle[2] - middle[0] == pytest.approx(np.exp(-TAKEN * depth).mean(), abs=0.06)  # straight on
    assert middle[1] == pytest.approx(light.layer_passes_sky(depth).mean(), rel=0.25)
    low, high = stage.field.layers[0].bounds
    assert 0.2 < middle[3] < 0.8 and high > low


def test_where_the_maps_lie():
    for up in (np.array([0.0, 0.0, 1.0]), np.array([0.3, -0.2, np.sqrt(1 - 0.13)])):
        assert local_key(up, up) == pytest.approx([0, 0, 1], abs=1e-12)
        low = local_key(direction(-5.0), up)
        assert np.linalg.norm(low) == pytest.approx(1.0) and low[2] >= LOWEST - 1e-12
    key = direction(25.0)
    values = shadow_values(key, np.array([12345.0, -999.0]), (800.0, 2500.0), 96)
    axes = np.stack([values["across"], values["along"], key])
    assert axes @ axes.T == pytest.approx(np.eye(3), abs=1e-12)
    # every place within reach, from the ground to the highest top, lies in its map
    for reach, (u, v, wide, high) in zip(REACHES, values["maps"][:3], strict=True):
        turn = np.linspace(0, 2 * np.pi, 50)
        for height in (0.0, 2500.0):
            place = np.stack(
                [reach * np.cos(turn), reach * np.sin(turn), 0 * turn + height - values["middle"]], 1
            )
            texel = 2 * np.array([wide, high]) / 96
            assert np.all(np.abs(place @ values["across"] - u) <= wide + texel[0])
            assert np.all(np.abs(place @ values["along"] - v) <= high + texel[1])


class Flight:
    """What a `Schedule` chooses along a flight."""

    def __init__(self, wind=(8.0, 0.0)):
        self.schedule = Schedule(np.array(wind))

    def at(self, east, time, *, fresh=False, elevation=40.0):
        values = shadow_values(direction(elevation), np.array([east, 0.0]), (800.0, 2500.0), 96)
        return self.schedule.lay(values, np.array([east, 0.0]), time, 96, fresh=fresh), self.schedule.due


def test_one_map_a_frame():
    flight = Flight()
    assert flight.at(0.0, 0.0)[1] == set(range(MAPS))
    drawn = [flight.at(5.0 * i, i / 30)[1] for i in range(1, 120)]
    assert max(map(len, drawn)) <= 2 and np.mean([len(due) for due in drawn]) < 1.2
    assert all(any(number in due for due in drawn) for number in range(MAPS))
    # the finest is behind the soonest
    assert sum(0 in due for due in drawn) > 60
    last = 119 / 30
    assert flight.at(595.0, last, fresh=True)[1] == set(range(MAPS))
    assert flight.at(595.0, last)[1] == set()  # another sample of the same still
    assert 0 in flight.at(900.0, last)[1]  # the camera jumps
    assert flight.at(900.0, last, elevation=30.0)[1] >= {0, 1, 2}  # the light does
    assert flight.at(900.0, last + 60.0, elevation=30.0)[1] == set(range(MAPS))


def test_a_camera_that_stands_still_has_few_maps_drawn():
    flight = Flight()
    flight.at(0.0, 0.0)
    drawn = [flight.at(0.0, i / 30)[1] for i in range(1, 300)]
    assert np.mean([len(due) for due in drawn]) < 0.25
    assert max(map(len, drawn)) == 1  # never all at once
    assert all(sum(number in due for due in drawn) >= 4 for number in range(MAPS))


def test_maps_that_wait_drift_with_the_clouds():
    flight = Flight(wind=(8.0, 0.0))
    before, _ = flight.at(0.0, 0.0)
    after, due = flight.at(5.0, 0.1)
    waiting = set(range(MAPS)) - due
    assert len(waiting) == 3
    moved = 8.0 * 0.1 - 5.0  # m to the east, as the camera sees it
    across = shadow_values(direction(40.0), np.zeros(2), (800.0, 2500.0), 96)["across"]
    for number in waiting - {MAPS - 1}:
        assert after[number][0] - before[number][0] == pytest.approx(moved * across[0], abs=1e-9)
        assert after[number][2:] == before[number][2:]


def test_shadows_from_far_are_soft(device):
    """The sun's disc blurs over a hundredth of the way: 160 m when it stands 5 degrees high."""
    stage = Stage(device, "cumulus_mediocris", 0.4, texels=384)  # of 16 m
    aside = np.array([np.cos(np.radians(210.0)), -np.sin(np.radians(210.0)), 0.0])
    line = np.arange(-250, 250)[:, None] * 8.0 * aside
    steps = {high: np.abs(np.diff(stage.look(line, high)[:, 1])).max() for high in (60.0, 5.0)}
    assert steps[5.0] < 0.12 < steps[60.0]
