"""Models as drawn, against what float64 says of them: where, which way, what colour, how they move."""

from __future__ import annotations

import numpy as np
import pytest

import fallstreak as fs
from fallstreak.world.state import position_on_planet, view_values

from .files import Maker

SIZE = (96, 54)
LAYERS = ("depth", "normal", "albedo", "motion")
FOV = 40.0


@pytest.fixture(scope="module")
def cube_file(tmp_path_factory):
    return Maker().cube().save(tmp_path_factory.mktemp("models") / "cube.glb")


def world_of(file, *, camera=None, **model):
    """Something 20 m north of a camera 500 m over the sea."""
    base = {"file": str(file), "name": "thing", "above": "sea", "height": 500.0, "north": 20.0}
    looking = {"height": 500.0, "above": "sea", "fov": FOV} | (camera or {})
    return fs.World(camera=looking, models=[base | model], film={"exposure": "fixed", "ev100": 14})


def still(world, size=SIZE):
    return fs.render(world, size, "low", samples=1, layers=LAYERS)


def middle(array):
    return array[array.shape[0] // 2, array.shape[1] // 2]


def test_a_cube_stands_where_it_should(cube_file):
    frame = still(world_of(cube_file))
    assert abs(middle(frame.depth) - 19.0) < 0.02  # the camera's nearest side, 1 m before the origin
    np.testing.assert_allclose(middle(frame.normal), (0, -1, 0), atol=2e-3)
    np.testing.assert_allclose(middle(frame.albedo), (1, 1, 1), atol=4e-3)
    near = frame.depth < 25
    half = 0.5 * SIZE[1] / np.tan(np.radians(FOV / 2)) / 19.0  # pixels of a metre
    assert abs(near.sum() - (2 * half) ** 2) < 4 * half + 4


def test_it_covers_the_ground_and_is_covered_by_it(cube_file):
    over = {"height": 10.0, "pitch": -20.0}
    above = still(world_of(cube_file, camera=over, height=2.0))
    below = still(world_of(cube_file, camera=over, height=-3.0))
    assert (above.depth < 25).sum() > 20
    assert (below.depth < 25).sum() == 0 or abs(np.median(below.depth) - np.median(above.depth)) < 5
    assert not (below.albedo > 0.95).all(-1).any(), "the sea hides what is under it"


def test_turned_and_scaled(cube_file):
    frame = still(world_of(cube_file, heading=45.0, scale=2.0))
    assert abs(middle(frame.depth) - (20 - 2 * np.sqrt(2))) < 0.15  # an edge comes first, within half a pixel
    left, right = frame.normal[27, 40], frame.normal[27, 56]
    np.testing.assert_allclose(left, (-np.sqrt(0.5), -np.sqrt(0.5), 0), atol=4e-3)
    np.testing.assert_allclose(right, (np.sqrt(0.5), -np.sqrt(0.5), 0), atol=4e-3)


@pytest.mark.parametrize("east", [0.0, 3e4, 9e5])
def test_far_from_the_anchor_it_is_as_exact(cube_file, east):
    frame = still(world_of(cube_file, camera={"east": east}, east=east))
    reference = still(world_of(cube_file))
    # the map's distances shrink across the way from its anchor
    places = [position_on_planet(east, north, 500.0, 6371e3) for north in (0.0, 20.0)]
    nearer = 20.0 - np.linalg.norm(places[1] - places[0])
    assert abs(middle(frame.depth) - middle(reference.depth) + nearer) < 2e-3
    assert abs((frame.depth < 25).sum() - (reference.depth < 25).sum()) <= 2


def test_five_kilometres_are_as_stable_as_two_metres(cube_file):
    """A cube of 5 km, whose near side is 20 m before a camera that moves by millimetres."""
    keyframes = [{"at": 0, "north": 7.0}, {"at": 1, "north": 7.02}]
    camera = {"keyframes": keyframes, "east": 1234.5, "height": 4321.0}
    world = world_of(cube_file, camera=camera, scale=2500.0, height=5000.0, north=2527.0)
    with fs.Renderer(world, SIZE, "low", fps=12, samples=1, layers=LAYERS) as renderer:
        depths = [float(middle(renderer.render(i).depth)) for i in range(12)]
        north = [renderer.state(i).camera.position[1] for i in range(12)]
    # its side is a plane of the anchor's axes, the camera stands on a sphere: what counts is the change
    assert abs(depths[0] - 20.0) < 2.0
    np.testing.assert_allclose(np.diff(depths), -np.diff(north), atol=4e-4)


def test_a_textures_colour_is_decoded_and_its_corner_is_the_upper_left(tmp_path):
    maker = Maker()
    texels = np.zeros((2, 2, 3), np.uint8)
    texels[0, 0], texels[0, 1], texels[1, 0] = (255, 0, 0), (0, 188, 0), (0, 0, 99)
    texture = maker.picture(texels.repeat(16, 0).repeat(16, 1))
    maker.cube(
        maker.material(pbrMetallicRoughness={"baseColorTexture": {"index": texture}, "metallicFactor": 0.0})
    )
    file = maker.save(tmp_path / "a.glb")
    albedo = still(world_of(file, heading=180.0, scale=3.0)).albedo  # its front, +z, to the camera
    # the cube's x is on the right of who looks at its front
    upper, lower = albedo[21], albedo[33]
    np.testing.assert_allclose(upper[42], (1, 0, 0), atol=0.01)
    np.testing.assert_allclose(upper[54], (0, ((188 / 255 + 0.055) / 1.055) ** 2.4, 0), atol=0.01)
    np.testing.assert_allclose(lower[42], (0, 0, ((99 / 255 + 0.055) / 1.055) ** 2.4), atol=0.01)


@pytest.mark.parametrize(("texel", "lean"), [((218, 128, 218), (1, 0)), ((128, 218, 218), (0, 1))])
def test_a_normal_map_leans_the_way_its_picture_says(tmp_path, texel, lean):
    """Red leans to the picture's right, green to its top: glTF 2.0, section 3.9.3."""
    maker = Maker()
    bump = maker.picture(np.full((4, 4, 3), texel, np.uint8))
    maker.cube(maker.material(normalTexture={"index": bump}))
    normal = middle(still(world_of(maker.save(tmp_path / "a.glb"), heading=180.0)).normal)
    # seen from the south, right is east and the front faces south
    slope = 90.0 / 127.5
    np.testing.assert_allclose(normal, (slope * lean[0], -np.sqrt(1 - slope**2), slope * lean[1]), atol=0.01)


def test_masks_have_holes_and_thin_sheets_two_sides(tmp_path):
    texels = np.full((8, 8, 4), 255, np.uint8)
    texels[:, :4, 3] = 0
    square = np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], np.float32)
    uv = np.array([(0, 1), (1, 1), (1, 0), (0, 0)], np.float32)
    counts = {}
    for both in (False, True):
        for heading in (0.0, 180.0):
            maker = Maker()
            color = {"baseColorTexture": {"index": maker.picture(texels)}}
            material = maker.material(pbrMetallicRoughness=color, alphaMode="MASK", doubleSided=both)
            maker.primitive(np.array([0, 1, 2, 0, 2, 3], np.uint16), material, POSITION=square, TEXCOORD_0=uv)
            frame = still(world_of(maker.save(tmp_path / f"{both}.glb"), heading=heading))
            seen = frame.depth < 25
            counts[both, heading] = int(seen.sum())
            if seen.any():
                assert (frame.normal[seen][:, 1] < -0.99).all(), "both sides face the eye"
    half = counts[True, 180.0]
    pixel = 0.5 * SIZE[1] / np.tan(np.radians(FOV / 2)) / 20.0
    assert abs(half - 2 * pixel**2) < 3 * pixel
    assert counts[True, 0.0] > 0.8 * half and counts[False, 180.0] == half and counts[False, 0.0] == 0


def test_one_and_two_sided_materials_in_one_model(tmp_path):
    square = np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], np.float32)
    maker = Maker()
    for x, both in ((-1.5, False), (1.5, True)):
        maker.primitive(np.array([0, 1, 2, 0, 2, 3], np.uint16), maker.material(doubleSided=both),
                        POSITION=square + np.float32((x, 0, 0)))  # fmt: skip
    file = maker.save(tmp_path / "a.glb")
    front, back = ((still(world_of(file, heading=h)).depth < 25).sum() for h in (180.0, 0.0))
    assert abs(front - 2 * back) <= 0.1 * front > 0


def test_many_copies_in_one_draw(cube_file):
    instances = [{"east": x, "heading": 0.0} for x in (-8.0, -4.0, 0.0, 4.0, 8.0)]
    world = world_of(cube_file, instances=instances, north=30.0)
    with fs.Renderer(world, SIZE, "low", still=True, layers=LAYERS) as renderer:
        frame = renderer.render(0)
        calls = renderer.stats()["calls"]
        renderer.models["thing"].place(east=np.linspace(-8, 8, 900), north=30.0, height=500.0, above="sea")
        renderer.render(0)
        assert renderer.stats()["calls"] == calls
    row = (frame.depth[27] < 33).astype(int)
    assert (np.diff(row) == 1).sum() == 5


def test_a_world_without_models_has_no_pass_of_theirs(cube_file):
    with fs.Renderer(fs.World(), (32, 32), "low") as renderer:
        renderer.render(0)
        assert not [p for p in renderer.stats()["passes"] if p["name"].startswith("models")]
        assert len(renderer.models) == 0


def pan(file, **model):
    """A camera that pans and climbs past a model, as a sequence."""
    keyframes = [{"at": 0, "heading": -3.0, "height": 500.0}, {"at": 2, "heading": 3.0, "height": 502.0}]
    return world_of(file, camera={"keyframes": keyframes}, **model)


def expected_motion(world, renderer, index, point, before):
    """uv now less uv before of a world point, by float64."""
    values = view_values(renderer.state(index))
    camera = renderer.state(index).camera.position

    def uv(matrix, where):
        clip = matrix @ np.append(where - camera, 1.0)
        return np.array([clip[0] / clip[3] * 0.5 + 0.5, 0.5 - clip[1] / clip[3] * 0.5])

    return uv(values["clip_from_world_still"], point) - uv(values["previous_clip_from_world"], before)


def center_of_face(transform):
    return transform[:3] @ (0.0, 0.0, 1.0, 1.0)


@pytest.mark.parametrize("how", ["rests", "keyframes", "python"])
def test_motion_is_the_models_and_the_cameras(cube_file, how):
    along = [{"at": 0, "east": -1.0, "height": 500.5}, {"at": 2, "east": 1.0, "height": 501.5}]
    more = {"keyframes": along} if how == "keyframes" else {"height": 501.0}
    world = pan(cube_file, heading=180.0, scale=4.0, **more)
    with fs.Renderer(world, SIZE, "low", fps=12, layers=LAYERS) as renderer:
        thing = renderer.models["thing"]
        for index in range(8, 12):
            if how == "python":
                thing.place(
                    east=0.2 * (index - 10), north=20, height=501, heading=180 + index, scale=4, above="sea"
                )
            frame = renderer.render(index)
        now, before = thing.transforms(renderer.state(11))
        want = expected_motion(world, renderer, 11, center_of_face(now[0]), center_of_face(before[0]))
        view = renderer.state(11).camera
        direction = view.rotation.T @ (center_of_face(now[0]) - view.position)
    f = 0.5 * SIZE[1] / np.tan(np.radians(FOV / 2))
    x, y = SIZE[0] / 2 - f * direction[0] / direction[2], SIZE[1] / 2 + f * direction[1] / direction[2]
    got = frame.motion[int(y), int(x)]
    pixels = (got / 1.0 if np.abs(got).max() > 0.2 else got * SIZE) - want * SIZE
    assert np.abs(pixels).max() < 0.06, (got, want * SIZE)
    assert np.abs(want * SIZE).max() > 0.2


def test_a_first_frame_has_no_motion_of_its_own(cube_file):
    with fs.Renderer(world_of(cube_file), SIZE, "low", layers=LAYERS) as renderer:
        renderer.models["thing"].place(east=1.0, north=20.0, height=500.0, above="sea")
        frame = renderer.render(0)
    assert np.abs(frame.motion[frame.depth < 25]).max() < 1e-4


def frames(world, count=7, *, lose=None, **options):
    got = []
    with fs.Renderer(world, SIZE, "low", fps=10, **options) as renderer:
        for index in range(count):
            renderer.models["thing"].place(
                east=0.3 * index, north=20, height=500, roll=9 * index, above="sea"
            )
            if index == lose:
                renderer.device.destroy()
            got.append(renderer.render(index).ldr)
    return got


def test_transforms_from_python_survive_a_lost_device(cube_file):
    world = pan(cube_file)
    np.testing.assert_array_equal(frames(world), frames(world, lose=5))


def test_keyframed_models_go_on_from_a_checkpoint(cube_file):
    world = pan(cube_file, keyframes=[{"at": 0, "east": -2.0}, {"at": 1, "east": 2.0, "pitch": 40.0}])
    with fs.Renderer(world, SIZE, "low", fps=10) as renderer:
        want = [renderer.render(i).ldr for i in range(6)]
    with fs.Renderer(world, SIZE, "low", fps=10) as renderer:
        for i in range(3):
            renderer.render(i)
        kept = renderer.checkpoint()
    with fs.Renderer(world, SIZE, "low", fps=10) as renderer:
        renderer.restore(kept)
        for i in range(3, 6):
            np.testing.assert_array_equal(renderer.render(i).ldr, want[i])


def test_what_rests_is_not_uploaded_again(cube_file, monkeypatch):
    from fallstreak.gpu import FrameGraph

    uploads = []
    original = FrameGraph.upload
    monkeypatch.setattr(
        FrameGraph, "upload", lambda g, name, data: (uploads.append(name), original(g, name, data))
    )
    with fs.Renderer(pan(cube_file), SIZE, "low", fps=10) as renderer:
        renderer.render(0)
        assert sorted(uploads) == ["models.0.before", "models.0.now"]
        renderer.render(1)
        assert len(uploads) == 2, "the camera moves, the model does not"
        renderer.models["thing"].place(north=21.0, height=500.0, above="sea")
        renderer.render(2)
        assert uploads[2:] == ["models.0.now"]
        renderer.render(3)
        assert uploads[3:] == ["models.0.before"]
        renderer.render(4)
        assert len(uploads) == 4


def test_the_shipped_models_are_drawn():
    for name, distance, few in (("glider", 16.0, 80), ("ship", 6000.0, 300)):
        world = fs.World(
            camera={"height": 2000.0, "above": "sea", "fov": FOV, "heading": 0.0},
            models=[{"file": name, "above": "sea", "height": 2000.0, "north": distance, "heading": 70.0}],
        )
        frame = still(world)
        seen = frame.depth < 1.6 * distance
        assert seen.sum() > few and frame.albedo[seen].std() > 0.05
        assert abs(np.linalg.norm(frame.normal[seen], axis=1) - 1).max() < 0.01
