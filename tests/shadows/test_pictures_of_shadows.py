"""Whole pictures: what shadows leave of the sun, against rays and against a fresh renderer."""

from __future__ import annotations

import numpy as np
import pytest
from models.files import Maker, cube

import fallstreak as fs

from .rays import shaded

SIZE = (160, 90)
GROUND = 500.0
"""m above the sea, where a sheet lies that everything throws its shadow on."""
FRAMES = 20
SQUARE = np.array([[-1, 0, -1], [1, 0, -1], [1, 0, 1], [-1, 0, 1]], np.float32)
FACES = np.array([0, 2, 1, 0, 3, 2], np.uint16)


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """A cube of 2 m, a sheet of 130 m, and a frame: 8 m wide, its middle half cut out."""
    folder = tmp_path_factory.mktemp("pictures_of_shadows")
    texels = np.full((64, 64, 4), 255, np.uint8)
    texels[16:48, 16:48, 3] = 0
    framed = Maker()
    color = {"baseColorTexture": {"index": framed.picture(texels)}}
    cut = framed.material(pbrMetallicRoughness=color, alphaMode="MASK", doubleSided=True)
    uv = 0.5 + 0.5 * SQUARE[:, [0, 2]]
    framed.primitive(FACES, cut, POSITION=4.0 * SQUARE, TEXCOORD_0=uv)
    made = {
        "cube": Maker().cube(),
        "sheet": Maker().primitive(FACES, POSITION=65.0 * SQUARE),
        "frame": framed,
    }
    return {name: str(maker.save(folder / f"{name}.glb")) for name, maker in made.items()}


def world_of(files, *things, technique="stable", camera=None, **settings):
    """Things over the sheet, seen from its south; each is (file, height above it, more)."""
    models = [{"file": files["sheet"], "name": "sheet", "above": "sea", "height": GROUND}]
    for number, (file, height, more) in enumerate(things):
        thing = {"file": files[file], "name": f"thing{number}", "above": "sea", "height": GROUND + height}
        models.append(thing | more)
    eye = {"above": "sea", "height": GROUND + 14.0, "east": 8.0, "north": -22.0, "pitch": -30.0, "fov": 55.0}
    return fs.World(
        time="2025-06-21T15:30:00Z",
        place={"latitude": 35.0, "longitude": 0.0},
        camera=eye | (camera or {}),
        models=models,
        film={"exposure": "fixed", "ev100": 14},
        shadows={"technique": technique, "contact": 0.0} | settings,
    )


def pictured(world):
    """Luminance, places (n, 3) where the sheet is seen, which pixels these are, the sun and the models."""
    with fs.Renderer(
        world, SIZE, "low", samples=1, still=True, layers=("hdr", "depth", "normal")
    ) as renderer:
        frame = renderer.render(0)
        camera = renderer.state(0).camera
        sun = np.asarray(renderer.graph.uniforms["sky.light"].record["sun_direction"], float)
        poses = [renderer.models[f"thing{n}"].at(0, 0.0)[0] for n in range(2)]
    t = np.tan(camera.fov / 2.0)
    y, x = np.indices(frame.depth.shape) + 0.5
    ray = np.stack(
        [(2 * x / SIZE[0] - 1) * t * SIZE[0] / SIZE[1], (1 - 2 * y / SIZE[1]) * t, -np.ones_like(x)], -1
    )
    ray /= np.linalg.norm(ray, axis=-1, keepdims=True)
    seen = np.isfinite(frame.depth) & (frame.depth < 120.0)
    places = camera.position + (np.where(seen, frame.depth, 0.0)[..., None] * ray) @ camera.rotation.T
    seen &= np.abs(places[..., 2] - GROUND) < 0.05
    return frame.hdr.mean(-1), places, seen, sun / np.linalg.norm(sun), poses


@pytest.fixture(scope="module")
def things():
    return [("cube", 3.0, {"heading": 30.0}), ("frame", 6.0, {"east": 9.0, "heading": 10.0})]


@pytest.fixture(scope="module")
def bare(files, things):
    return pictured(world_of(files, *things, technique="none"))


def cast(places, sun, poses):
    """Whether rays to the sun meet the cube, or the frame beside its hole."""
    positions, _, faces = cube()
    hit = np.zeros(places.shape[:-1], bool)
    flat = SQUARE.astype(float)[FACES.reshape(2, 3)]
    around = []
    for corners, pose in (
        (positions.astype(float)[faces], poses[0]),
        (4.0 * flat, poses[1]),
        (2.0 * flat, poses[1]),
    ):
        triangles = corners @ pose[:3, :3].T + pose[:3, 3]
        around.append(shaded(places.reshape(-1, 3), sun, triangles).reshape(hit.shape))
    solid, whole, hole = around
    return solid | (whole & ~hole)


@pytest.mark.parametrize(("technique", "seam"), [("stable", 0.25), ("infinity2007", 0.6)])
def test_the_sun_is_missing_where_rays_say(files, things, bare, technique, seam):
    """In the shadow of a cube and of a sheet with a hole, but for a seam; the sky's light stays."""
    lit, *_ = bare
    picture, places, seen, sun, poses = pictured(world_of(files, *things, technique=technique))
    share = picture / lit
    found = [cast(places, sun, poses)]
    for turn in np.arange(0.0, 2.0 * np.pi, np.pi / 4.0):
        found.append(cast(places + seam * np.array([np.cos(turn), np.sin(turn), 0.0]), sun, poses))
    dark, clear = seen & np.all(found, axis=0), seen & ~np.any(found, axis=0)
    assert dark.sum() > 60
    assert clear.sum() > 9000
    assert share[dark].max() < 0.3
    assert share[dark].min() > 0.1, "the sky still lights it"
    assert np.abs(share[clear] - 1.0).max() < 0.01


@pytest.mark.parametrize("technique", ["stable", "infinity2007"])
def test_after_a_flight_a_picture_is_that_of_a_fresh_renderer(files, technique):
    """Kept maps leave no trace: the camera moves and turns, a cube flies, another stands."""
    flight = {"keyframes": [{"at": 0.0, "east": -20.0}, {"at": 2.0, "east": 20.0, "heading": 90.0}]}
    way = [{"at": 0.0, "east": -12.0, "heading": -30.0}, {"at": 1.0, "east": 8.0, "heading": 10.0}]
    things = [("cube", 4.0, flight), ("cube", 1.0, {"east": 5.0, "north": -3.0})]
    world, unshaded = (
        world_of(files, *things, technique=t, camera={"keyframes": way}) for t in (technique, "none")
    )
    options = {"quality": "low", "samples": 1, "fps": 30.0}
    with fs.Renderer(world, SIZE, **options) as flown:
        for index in range(FRAMES):
            kept = flown.render(index).ldr
    with fs.Renderer(world, SIZE, **options) as fresh:
        anew = fresh.render(FRAMES - 1).ldr
    with fs.Renderer(unshaded, SIZE, **options) as without:
        bare = without.render(FRAMES - 1).ldr
    np.testing.assert_array_equal(kept, anew)
    assert (bare.astype(int) - kept > 30).all(-1).sum() > 40, "shadows are in sight"


def test_plants_throw_shadows():
    """Among trees the sun goes missing; without shadows the ground is darkened evenly instead."""
    with_sun = [
        "time=2025-06-21T16:00:00-05:00",
        "film.exposure=fixed",
        "film.ev100=14",
        "clouds.layers=[]",
        "camera.pitch=-25",
        "camera.height=40",
    ]
    hdr = {}
    for technique in ("none", "stable"):
        world = fs.load("jacksboro", overrides=[*with_sun, f"shadows.technique={technique}"])
        hdr[technique] = fs.render(world, SIZE, "low", samples=1, layers=("hdr", "depth"))
    near = hdr["none"].depth < 250.0
    share = hdr["stable"].hdr.mean(-1)[near] / hdr["none"].hdr.mean(-1)[near]
    assert (share < 0.5).sum() > 200
