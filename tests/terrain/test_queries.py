"""What `world.terrain` answers: against closed forms, against itself, and against the picture."""

from __future__ import annotations

import numpy as np
import pytest
from ground import Ground

import fallstreak as fs
from fallstreak.terrain.land.shape import NO_WATER, LandShape
from fallstreak.terrain.model import TerrainModel, terrain_model
from fallstreak.terrain.projection import world_from_map
from fallstreak.terrain.queries import height, sites
from fallstreak.terrain.ray import Surface, cast
from fallstreak.world.errors import WorldError
from fallstreak.world.state import view_values

LANDS = {
    "jacksboro": [],
    "canyons": ["source=canyons", "material=canyon", "base_height=1600", "relief=350", "feature_size=3e3"],
    "alpine": ["source=alpine", "material=alpine", "base_height=1500", "relief=2600", "feature_size=16e3"],
}


def overrides(land):
    return [f"terrain.{value}" for value in LANDS[land]]


@pytest.fixture(scope="module")
def jacksboro():
    return fs.load("jacksboro")


class Cliff:
    """A wall that runs north and leans east over its foot: what a ray meets can be told without a mesh."""

    outside, shift_bound, extent = 0.0, 30.0, 1e5

    @staticmethod
    def profile(x):
        return x + 24.0 * np.exp(-(((x - 2.0) / 6.0) ** 2)), 50.0 - 50.0 * np.tanh(x / 5.0)

    def bounds(self):
        return -1.0, 101.0

    def shape(self, east, north, step):
        e, _, _ = np.broadcast_arrays(east, north, step)
        drawn, h = self.profile(np.asarray(e, float))
        zero = np.zeros(e.shape)
        return LandShape(h, zero + NO_WATER, drawn - e, zero, zero, zero + 1.0)


@pytest.fixture(scope="module")
def cliff():
    return Surface(TerrainModel(Cliff(), 1e12, 1e5))  # type: ignore[arg-type]


def crossings(origin, direction):
    """Distances at which a ray in the plane north = 0 meets the profile of the cliff."""
    x, h = Cliff.profile(np.linspace(-200.0, 200.0, 20_001))
    side = (x - origin[0]) * direction[2] - (h - origin[2]) * direction[0]
    i = np.flatnonzero(side[:-1] * side[1:] <= 0.0)
    f = side[i] / (side[i] - side[i + 1])
    point = np.stack([x[i] + f * (x[i + 1] - x[i]), np.zeros(len(i)), h[i] + f * (h[i + 1] - h[i])], 1)
    t = (point - origin) @ direction / np.dot(direction, direction)
    return np.sort(t[t > 0.0])


def test_rays_meet_an_overhang_on_all_its_sides(cliff):
    rng = np.random.default_rng(1)
    under = 0
    for _ in range(150):
        origin = np.array([rng.uniform(25.0, 90.0), 0.0, rng.uniform(5.0, 180.0)])
        aim = np.array([rng.uniform(-30.0, 24.0), 0.0, rng.uniform(0.0, 100.0)])
        direction = (aim - origin) / np.linalg.norm(aim - origin)
        expected = crossings(origin, direction)
        hit = cast(cliff, origin[None], direction[None])
        if len(expected) == 0:
            assert hit.distance[0] == np.inf and np.isnan(hit.position).all()
            continue
        assert hit.distance[0] == pytest.approx(expected[0], abs=0.02)
        assert np.allclose(hit.position[0], origin + hit.distance[0] * direction)
        assert hit.normal[0] @ direction < 0.0 and np.linalg.norm(hit.normal[0]) == pytest.approx(1.0)
        under += hit.normal[0, 2] < -0.1
    assert under > 5  # some looked up at it from below


def test_the_highest_of_several_sheets_is_the_height(cliff):
    x = np.linspace(-40.0, 60.0, 251)
    down = np.tile([0.0, 0.0, -1.0], (len(x), 1))
    start = np.stack([x, 0.0 * x, 0.0 * x + 150.0], 1)
    found = 150.0 - cast(cliff, start, down, level=3).distance
    expected = [150.0 - crossings(o, d)[0] for o, d in zip(start, down, strict=True)]
    # but for the lip's outermost edge, where samples 4 m apart end
    assert (np.abs(found - expected) < 0.05).mean() > 0.97
    # where the wall leans over there are three sheets
    assert max(len(crossings(o, d)) for o, d in zip(start, down, strict=True)) >= 3


@pytest.mark.parametrize("scene", ["orbit", "jacksboro"])
def test_rays_beyond_the_land_meet_the_globe(scene):
    world = fs.load(scene)
    radius = world.planet.radius
    beyond = terrain_model(world).land.outside if scene == "jacksboro" else 0.0
    up = np.array([np.sin(0.1), 0.0, np.cos(0.1)])  # 640 km east
    origin = up * (radius + 5000.0) - [0.0, 0.0, radius]
    side = np.array([0.0, 1.0, 0.0])
    dip = np.arccos((radius + beyond) / (radius + 5000.0))
    rays = np.stack(
        [
            -up,
            np.cos(dip + 1e-4) * side - np.sin(dip + 1e-4) * up,
            np.cos(dip - 1e-4) * side - np.sin(dip - 1e-4) * up,
            up,
        ]
    )
    hit = world.terrain.ray(origin, rays)
    assert hit.distance[0] == pytest.approx(5000.0 - beyond, abs=1e-3)
    assert np.allclose(hit.normal[0], up)
    assert hit.distance[1] == pytest.approx(np.sqrt((radius + 5000.0) ** 2 - (radius + beyond) ** 2), rel=0.1)
    assert np.isinf(hit.distance[2:]).all() and np.isnan(hit.position[2:]).all()
    assert np.isinf(world.terrain.ray(origin, rays, 4000.0).distance).all()


def test_heights_normals_and_slopes_agree(jacksboro):
    rng = np.random.default_rng(3)
    e, n = rng.uniform(-9e3, 9e3, (2, 40, 5))
    h, normal, slope = (getattr(jacksboro.terrain, q)(e, n) for q in ("height", "normal", "slope"))
    assert h.shape == slope.shape == (40, 5) and normal.shape == (40, 5, 3)
    a, b = (
        jacksboro.terrain.height(e + x, n + y) - jacksboro.terrain.height(e - x, n - y)
        for x, y in ((0.5, 0.0), (0.0, 0.5))
    )
    assert np.abs(np.hypot(a, b) - slope).max() < 0.01
    assert np.abs(-normal[..., 0] / normal[..., 2] - a).max() < 0.01 + 9e3 / jacksboro.planet.radius
    assert isinstance(jacksboro.terrain.slope(0.0, 0.0), float)
    # straight down the ray finds the same height
    start = world_from_map(e, n, 3000.0, jacksboro.planet.radius).reshape(-1, 3)
    down = -(start + np.array([0.0, 0.0, jacksboro.planet.radius]))
    hit = jacksboro.terrain.ray(start, down)
    assert np.abs(3000.0 - hit.distance - h.ravel()).max() < 0.6  # as a mesh at 3 km carries it
    assert (hit.normal * normal.reshape(-1, 3)).sum(1).min() > 0.9


def test_water_is_a_surface():
    world = fs.load("jacksboro", ["terrain.water_level=380"])
    assert world.terrain.height(16_500.0, -12_250.0) == 380.0
    assert world.terrain.slope(16_500.0, -12_250.0) < 1e-3
    start = world_from_map(16_500.0, -12_250.0, 500.0, world.planet.radius)
    assert world.terrain.ray(start, [0.0, 0.0, -1.0]).distance[0] == pytest.approx(120.0, abs=0.01)


def test_materials_have_names_and_shares(jacksboro):
    e, n = np.random.default_rng(4).uniform(-9e3, 9e3, (2, 2000))
    shares = jacksboro.terrain.materials(e, n)
    total = sum(shares.values())
    assert np.abs(total - 1.0).max() < 1e-6 and all((s > -1e-9).all() for s in shares.values())
    assert 0.3 < shares["canopy"].mean() < 0.98  # October woods
    steep = jacksboro.terrain.slope(e, n) > 0.6
    assert steep.any() and shares["sandstone"][steep].mean() > 5 * shares["sandstone"][~steep].mean()


@pytest.mark.parametrize("land", LANDS)
def test_materials_are_those_of_the_clipmap(device, land):
    """Tiles of several levels as the GPU holds them, against the query's own way to them."""
    ground = Ground(device, overrides=overrides(land))
    ground.draw(300.0, -500.0, 40.0, 60.0, -12.0)
    clip, model = ground.terrain.clip, ground.terrain.model
    a, b = (ground.read(f"terrain.{name}") / 255.0 for name in ("cover_a", "cover_b"))
    tiles = ground.tiles_in_use("surface")
    tiles = tiles[tiles[:, 0] <= 6]
    off = []
    for level, column, row in tiles[np.random.default_rng(5).choice(len(tiles), 5, replace=False)]:
        step = clip.spacing * 2.0**level
        x, y = np.meshgrid(
            (column * 32 + np.arange(0, 32, 4)) * step, (row * 32 + np.arange(0, 32, 4)) * step
        )
        held = np.concatenate(
            [ground.tile(a, level, column, row), ground.tile(b, level, column, row)[..., :2]], -1
        )[::4, ::4]
        kind = __import__(f"fallstreak.terrain.cover.{ground.world.terrain.material}", fromlist=["cover"])
        expected = kind.cover(sites(model, ground.world.seed, x, y, step)).weights
        off.append(np.abs(held - expected).max(-1))
    off = np.array(off)
    assert np.median(off) < 0.01 and np.mean(off > 0.1) < 0.05


@pytest.mark.parametrize("land", LANDS)
def test_rays_hit_where_the_picture_has_its_ground(device, land):
    """Stated error: half a percent of the distance or two pixels' footprint, for 95 of 100 pixels."""
    ground = Ground(device, quality="high", overrides=overrides(land))
    state = ground.draw(300.0, -500.0, 40.0, 60.0, -12.0)
    east, north, up, distance, _, _ = ground.points(state)
    chosen = np.random.default_rng(6).choice(len(east), 200, replace=False)
    distance = distance[chosen]
    seen = world_from_map(east[chosen], north[chosen], up[chosen], state.planet_radius)
    ray = (seen - state.camera.position) / distance[:, None]
    hit = ground.world.terrain.ray(state.camera.position, ray)
    assert np.isfinite(hit.distance).mean() > 0.98
    facing = np.maximum(np.abs((hit.normal * ray).sum(1)), 0.02)
    footprint = distance * view_values(state)["pixel_angle"] / facing
    error = np.abs(hit.distance - distance)
    assert (error < np.maximum(0.005 * distance, 2.0 * footprint)).mean() >= 0.95
    assert np.median(error / distance) < 0.005


def test_wrong_questions_are_refused(jacksboro):
    with pytest.raises(ValueError, match="finite"):
        jacksboro.terrain.ray([0.0, 0.0, 1e4], [0.0, 0.0, 0.0])
    with pytest.raises(ValueError, match="must be"):
        jacksboro.terrain.ray([0.0, 0.0], [0.0, 0.0])
    with pytest.raises(WorldError, match="no ground"):
        fs.load("orbit").terrain.materials(0.0, 0.0)
    with pytest.raises(WorldError, match="no world"):
        fs.World.model_fields["terrain"].default_factory().slope(0.0, 0.0)
    assert height(fs.load("orbit"), 5.0, 6.0) == 0.0
