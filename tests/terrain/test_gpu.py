"""The GPU's ground against its CPU twin: nodes, vertices, no cracks, no popping."""

from __future__ import annotations

import numpy as np
import pytest
from ground import SIZE, VIEWS, Ground

from fallstreak.frame.gbuffer import DEPTH
from fallstreak.terrain.projection import map_from_world, world_from_map
from fallstreak.terrain.selection import morphed, select_nodes, vertex_shape
from fallstreak.world.state import view_values


@pytest.fixture(scope="module")
def ground(device):
    return Ground(device)


@pytest.mark.parametrize("view", VIEWS)
def test_nodes_are_those_of_the_twin(ground, view):
    state = ground.draw(*VIEWS[view])
    expected = select_nodes(
        ground.bounds_between(),
        ground.terrain.frame_values(state),
        ground.quality.terrain_grid,
        view_values(state)["clip_from_world"],
        state.camera.position,
        state.planet_radius,
    )
    drawn, twin = ({tuple(n) for n in nodes} for nodes in (ground.nodes(), expected))
    # float32 decides otherwise only for nodes that a plane or the horizon just touches
    assert len(drawn) >= 1 and len(drawn ^ twin) <= 0.05 * len(twin) + 1


@pytest.mark.parametrize("view", VIEWS)
def test_every_visible_place_belongs_to_exactly_one_node(ground, view):
    state = ground.draw(*VIEWS[view])
    nodes = ground.nodes()
    extent, half = ground.terrain.model.extent, ground.terrain.clip.half
    size = 2 * half / 2.0 ** nodes[:, 2]
    low = nodes[:, :2] * size[:, None] - half
    rng = np.random.default_rng(1)
    camera = np.array(map_from_world(state.camera.position, state.planet_radius)[:2])
    # near and far places alike
    distance = 10 ** rng.uniform(0, np.log10(2 * extent), 20_000)
    angle = rng.uniform(0, 2 * np.pi, 20_000)
    places = camera + distance[:, None] * np.stack([np.cos(angle), np.sin(angle)], 1)
    places = places[np.hypot(*places.T) < 0.95 * extent]
    inside = ((places[:, None] >= low) & (places[:, None] < low + size[:, None])).all(2).sum(1)
    assert inside.max() <= 1  # no overlaps
    seen = visible(ground, state, places)
    assert seen.sum() > 5 and (inside[seen] == 1).all()  # no holes


def visible(ground, state, places):
    """Places on the ground inside the picture and, for a sphere, above the horizon."""
    height = ground.terrain.model.height(places[:, 0], places[:, 1])
    world = world_from_map(places[:, 0], places[:, 1], height, state.planet_radius)
    clip = np.concatenate([world - state.camera.position, np.ones((len(world), 1))], 1)
    clip = clip @ view_values(state)["clip_from_world"].T
    shown = (clip[:, 3] > 0.2) & (np.abs(clip[:, :2]) < clip[:, 3:] * 0.99).all(1)
    lowest = state.planet_radius + ground.terrain.model.land.bounds()[0]
    eye, place = state.planet_radius + state.altitude, state.planet_radius + height
    sight = np.sqrt(eye**2 - lowest**2) + np.sqrt(np.maximum(place**2 - lowest**2, 0.0))
    return shown & (np.linalg.norm(world - state.camera.position, axis=1) < sight)


@pytest.mark.parametrize("view", VIEWS)
def test_vertex_heights_against_float64(ground, view):
    """Stated error: 2 cm within 2 km of the camera, 0.3 m or 1e-4 of the distance beyond."""
    state = ground.draw(*VIEWS[view])
    frame = ground.terrain.frame_values(state)
    nodes = ground.nodes()
    grid = ground.quality.terrain_grid
    heights = ground.read("terrain.heights").view(np.float32).reshape(-1, (grid + 1) ** 2, 2)[..., 0]
    for slot in np.linspace(0, len(nodes) - 1, 12).astype(int):
        vertices = morphed(frame, nodes[slot], grid)
        expected, _ = vertex_shape(ground.terrain.model, ground.terrain.clip.spacing, vertices)
        reach = np.hypot(*(vertices.offset + frame["camera_map"]).T)
        expected -= 0.1 * np.maximum(reach - 0.985 * frame["extent"], 0.0)  # under the globe
        distance = np.hypot(*vertices.offset.T)
        allowed = np.where(distance < 2e3, 0.02, np.maximum(0.3, 1e-4 * distance))
        assert (np.abs(heights[slot] - expected) < allowed).all()


@pytest.mark.parametrize("view", VIEWS)
def test_depth_is_where_the_ground_is(ground, view):
    """From depth back to a place on the map and its height: the mesh lies on the CPU's ground."""
    state = ground.draw(*VIEWS[view])
    east, north, height, distance, _, _ = ground.points(state)
    inside = np.hypot(east, north) < 0.8 * ground.terrain.model.extent
    expected = ground.terrain.model.height(east, north)
    error = np.abs(height - expected) / np.maximum(distance, 1.0)
    # in pixels: how far off the picture is
    pixels = error / view_values(state)["pixel_angle"]
    if inside.sum() > 100:
        assert np.percentile(pixels[inside], 95) < 4.0
        assert np.median(pixels[inside]) < 1.0


CANYONS = ["source=canyons", "material=canyon", "base_height=1600", "relief=350", "feature_size=3e3"]


@pytest.fixture(scope="module")
def canyons(device):
    return Ground(device, overrides=[f"terrain.{value}" for value in CANYONS])


@pytest.mark.parametrize("view", [(2995.0, 522.0, 130.0, 60.0, 0.0), VIEWS["hill"], VIEWS["high"]])
def test_vertices_of_walls_against_float64(canyons, view):
    """Where samples are shifted sideways too; noise in single precision may turn a ledge's edge."""
    state = canyons.draw(*view)
    frame = canyons.terrain.frame_values(state)
    nodes, grid = canyons.nodes(), canyons.quality.terrain_grid
    raw = canyons.read("terrain.heights").view(np.uint32).reshape(-1, (grid + 1) ** 2, 2)
    held = raw[..., 0].copy().view(np.float32)
    shifts = raw[..., 1].copy().view(np.int16).reshape(*held.shape, 2) / 32767.0 * 128.0
    off, moved, most = [], [], 0.0
    for slot in np.linspace(0, len(nodes) - 1, 12).astype(int):
        vertices = morphed(frame, nodes[slot], grid)
        near = np.hypot(*(vertices.offset + frame["camera_map"]).T) < 0.8 * frame["extent"]
        height, shift = vertex_shape(canyons.terrain.model, canyons.terrain.clip.spacing, vertices)
        off.append(np.abs(held[slot] - height)[near])
        moved.append(np.abs(shifts[slot] - shift).max(-1)[near])
        most = max(most, np.abs(shift).max())
    assert np.quantile(np.concatenate(off), 0.98) < 0.1
    assert np.quantile(np.concatenate(moved), 0.98) < 0.1
    assert most > 5.0 or view[2] > 200.0


def test_bounds_hold_what_is_shifted(canyons):
    """A tile's box reaches as far as its walls lean, and no farther."""
    canyons.draw(2995.0, 522.0, 130.0, 60.0, 0.0)
    shifts, bounds = canyons.read("terrain.shift"), canyons.bounds()
    leaning = 0
    for level, column, row in canyons.tiles_in_use("shape"):
        held = np.ascontiguousarray(canyons.tile(shifts, level, column, row)).view(np.int16)
        most = np.abs(held.reshape(-1, 2) / 32767.0 * 128.0).max(0)
        bound = bounds[level, row % bounds.shape[1], column % bounds.shape[2], 2:]
        assert np.abs(most - bound).max() < 0.003
        leaning += most.max() > 5.0
    assert leaning > 50


def test_a_gorge_that_wide_samples_miss_is_drawn(canyons):
    """From its floor all coarse nodes around lie above the camera: none of them may hide what is in it."""
    canyons.draw(0.0, 0.0, 1.7, 0.0, -35.0)
    assert (canyons.read(DEPTH) > 0).all() and len(canyons.nodes()) > 10


@pytest.mark.parametrize(("quality", "land"), [("low", []), ("high", []), ("low", CANYONS)])
def test_no_cracks(device, quality, land):
    """Below the horizon there is ground in every pixel, from the grass to orbit, also where levels meet."""
    ground = Ground(device, quality=quality, overrides=[f"terrain.{value}" for value in land])
    for name, (east, north, above, _, pitch) in VIEWS.items():
        for heading in (0.0, 73.0, 198.0):
            ground.draw(east, north, above, heading, min(pitch, -35.0) - (20.0 if name == "orbit" else 0.0))
            depth = ground.read(DEPTH)
            # every picture looks steeply down: no pixel may see the sky
            assert (depth > 0).all(), (name, heading, int((depth == 0).sum()))


def test_a_narrow_lens_never_looks_past_its_windows(ground):
    """Through a telephoto lens the mesh gets coarser before it leaves the tiles the GPU holds."""
    for fov in (4.0, 0.5):
        state = ground.draw(0.0, 0.0, 500.0, 60.0, -20.0, fov)
        east, north, height, distance, _, _ = ground.points(state)
        assert len(east) == SIZE[0] * SIZE[1]
        # too coarse for the lens, but the ground
        error = np.abs(height - ground.terrain.model.height(east, north))
        assert np.median(error) < 1.5 and error.max() < 0.01 * distance.min()


def test_morph_does_not_pop(ground):
    """Where the camera's next centimetre changes the set of nodes, the picture does not change."""

    def nodes_and_depth(travelled):
        ground.draw(travelled, -1500.0, 150.0, 40.0, -25.0)
        return {tuple(n) for n in ground.nodes()}, ground.read(DEPTH).astype(np.float64)

    switches = 0
    before, _ = nodes_and_depth(0.0)
    for travelled in np.arange(8.0, 320.0, 8.0):
        after, _ = nodes_and_depth(travelled)
        if after != before and switches < 5:
            low, high, at_low = travelled - 8.0, travelled, before
            while high - low > 0.01:
                middle = 0.5 * (low + high)
                found, _ = nodes_and_depth(middle)
                low, high = (middle, high) if found == at_low else (low, middle)
            (a, depth_a), (b, depth_b) = nodes_and_depth(low), nodes_and_depth(high)
            assert a != b
            same = (depth_a > 0) & (depth_b > 0)
            # a centimetre at 150 m is 7e-5; silhouettes move by themselves
            change = np.abs(depth_a[same] / depth_b[same] - 1.0)
            assert np.percentile(change, 99.5) < 4e-4
            switches += 1
        before = after
    assert switches >= 3


@pytest.mark.parametrize("altitude", [2.0, 100.0, 10e3, 400e3])
def test_globe_ends_at_the_horizon(device, altitude):
    globe = Ground(device, scene="orbit")
    radius = globe.world.planet.radius
    dip = np.degrees(np.arccos(radius / (radius + altitude)))
    state = globe.draw(3e4, -2e4, altitude, 40.0, -dip, 20.0)
    covered = globe.read(DEPTH)[:, SIZE[0] // 2] > 0
    # the horizon crosses the picture's middle, within a pixel and a half
    assert abs(np.argmax(covered) - SIZE[1] / 2) <= 1.5
    assert covered[SIZE[1] // 2 + 2 :].all() and not covered[: SIZE[1] // 2 - 2].any()
    bottom = globe.read(DEPTH)[-1, SIZE[0] // 2]
    angle = np.radians(dip + 10.0 * (1 - 1 / SIZE[1]))
    b = (radius + altitude) * np.sin(angle)
    distance = b - np.sqrt(b * b - altitude * (2 * radius + altitude))
    along = distance * np.cos(angle - np.radians(dip))
    assert state.camera.near / bottom == pytest.approx(along, rel=2e-3)


def test_static_ground_has_no_motion_for_a_still_camera(ground):
    ground.draw(*VIEWS["hill"])
    assert np.abs(ground.read("gbuffer.motion").astype(float)).max() < 1e-3


@pytest.mark.parametrize("scene", ["jacksboro", "mars"])
def test_albedo_is_natural_and_keeps_its_mean_with_distance(device, scene):
    ground = Ground(device, scene=scene)
    means = []
    # the same 6 km of ground through a narrow and a wide lens: the footprint changes, the mean must not
    for above, fov in ((4000.0, 60.0), (16_000.0, 16.4), (64_000.0, 4.1)):
        ground.draw(0.0, 0.0, above, 0.0, -89.9, fov)
        albedo = (ground.read("gbuffer.albedo")[..., :3].astype(float) / 255) ** 2
        means.append(albedo.mean((0, 1)))
    means = np.array(means)
    assert (means > 0.01).all() and (means < 0.35).all()
    assert (np.abs(means / means[0] - 1.0) < 0.12).all()


def test_materials_are_mixed_only_where_the_mesh_is(ground):
    ground.draw(*VIEWS["hill"])
    seen = ground.read(DEPTH).reshape(-1) > 0.0
    assert 0.1 < seen.mean() < 0.95
    albedo = ground.read("gbuffer.albedo").reshape(-1, 4)
    assert albedo[seen].max(1).min() > 0
    assert albedo[~seen].max() == 0
