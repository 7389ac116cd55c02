"""Scenes: shipped ones, bases, overrides, presets, and through TOML and back."""

from __future__ import annotations

import copy
import json
import pickle
import subprocess
import sys
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import pytest

import fallstreak as fs
from fallstreak.world import Keyframe, Sky
from fallstreak.world.explain import leaves


@pytest.mark.parametrize("name", fs.scene_names())
def test_shipped_scene_goes_through_toml_unchanged(name):
    world = fs.load(name)
    assert world.name and world.description
    assert fs.loads(world.to_toml()) == world
    assert fs.World(**world.model_dump()) == world


def test_every_field_survives_toml():
    world = fs.World(
        name='a "quoted"\nname\t\\',
        seed=2**32 - 1,
        time="2025-03-30T02:30:00.250+05:45",
        planet={"preset": "mars", "radius": 3.4e6, "ground_albedo": (0.1, 0.2, 0.3)},
        sky={"sun": {"angular_diameter": 0.35}, "mie_g": 0.5, "moon": True, "turbidity": 1e-300},
        terrain={"source": "file", "file": "jacksboro"},
        camera={"keyframes": [{"at": 0.1, "heading": 1 / 3}, {"at": 7, "fov": 20, "north": -5e-9}]},
        film={"exposure": "fixed", "ev100": -3},
    )
    assert fs.loads(world.to_toml()) == world


def test_defaults_are_valid_and_write_nothing():
    assert fs.World().to_toml() == ""
    assert fs.World() == fs.loads("")


def test_worlds_are_values():
    world = fs.load("jacksboro")
    assert hash(world) == hash(fs.load("jacksboro"))
    assert pickle.loads(pickle.dumps(world)) == world
    assert copy.deepcopy(world) == world
    with pytest.raises(Exception, match="frozen"):
        world.sky.turbidity = 3  # type: ignore[misc]


def test_a_scene_builds_on_another(tmp_path):
    (tmp_path / "deep").mkdir()
    (tmp_path / "deep" / "base.toml").write_text(
        'extends = "orbit"\nseed = 5\n[camera]\nfov = 20\npitch = -3\n'
    )
    (tmp_path / "top.toml").write_text('extends = "deep/base.toml"\n[camera]\nfov = 30\n')
    world = fs.load(tmp_path / "top.toml")
    orbit = fs.load("orbit")
    assert (world.seed, world.camera.fov, world.camera.pitch) == (5, 30.0, -3.0)
    assert world.camera.heading == orbit.camera.heading and world.name == orbit.name


def test_paths_count_from_their_own_file(tmp_path, monkeypatch):
    (tmp_path / "deep").mkdir()
    dem = tmp_path / "deep" / "dem.npz"
    dem.write_bytes(b"")
    (tmp_path / "deep" / "base.toml").write_text('[terrain]\nsource = "file"\nfile = "dem.npz"\n')
    (tmp_path / "top.toml").write_text('extends = "deep/base.toml"\n')
    world = fs.load(tmp_path / "top.toml")
    assert world.terrain.path == dem
    assert world.folder == tmp_path
    assert 'file = "deep/dem.npz"' in world.to_toml()
    assert fs.loads(world.to_toml(), folder=tmp_path) == world
    # An override's path counts from where the user is, and may be anywhere.
    monkeypatch.chdir(tmp_path / "deep")
    assert fs.load("orbit", ["terrain.source=file", "terrain.file=./dem.npz"]).terrain.path == dem
    assert fs.load("orbit", ["terrain.source=file", f"terrain.file={dem}"]).terrain.path == dem
    assert fs.World(terrain={"source": "file", "file": "dem.npz"}).terrain.path == dem
    assert fs.load("jacksboro").terrain.path is None


def test_overrides_are_toml_values():
    world = fs.load(
        "jacksboro",
        [
            "sky.turbidity=4",
            "sky.moon = false",
            "film.tone_map=neutral",
            'name="a = b"',
            "description=two words",
            "time=2025-01-01T08:00:00Z",
            "planet.ground_albedo=[0.1, 0.2, 0.3]",
            "camera={fov = 20, roll = 3}",
            "camera.keyframes=[{at = 0, pitch = 1}, {at = 1, pitch = 2}]",
            "sky.sun.angular_diameter=auto",
            "seed=1_000",
        ],
    )
    assert (world.sky.turbidity, world.sky.moon, world.film.tone_map) == (4.0, False, "neutral")
    assert (world.name, world.description) == ("a = b", "two words")
    assert world.time == datetime(2025, 1, 1, 8, tzinfo=UTC)
    assert world.planet.ground_albedo == (0.1, 0.2, 0.3)
    assert (world.camera.fov, world.camera.roll) == (20.0, 3.0)
    assert world.camera.heading == fs.load("jacksboro").camera.heading
    assert world.camera.keyframes[1].pitch == 2.0
    assert world.seed == 1000


def test_the_last_override_counts_and_worlds_can_be_overridden():
    world = fs.load("jacksboro", ["seed=1", "seed=2"])
    assert world.seed == 2
    assert fs.load(world, {"seed": 3, "sky.turbidity": np.float32(2.0)}).sky.turbidity == 2.0


def test_preset_fills_what_is_not_given():
    mars = fs.World(planet={"preset": "mars"}, sky={"mie_scale_height": 5000})
    assert mars.planet.radius == 3.3895e6 and mars.sky.phase == "mars"
    assert mars.sky.mie_scale_height == 5000.0
    earth = mars.updated({"planet.preset": "earth"})
    assert earth.sky.phase == fs.World().sky.phase and earth.sky.mie_scale_height == 5000.0
    assert "radius" not in mars.to_toml()


def test_sections_may_be_given_as_models():
    world = fs.World(sky=Sky(turbidity=3), camera={"keyframes": (Keyframe(at=1, fov=20),)})
    assert world.sky.turbidity == 3.0 and world.camera.keyframes[0].fov == 20.0
    # A model's untouched fields are left to the preset.
    assert fs.World(planet={"preset": "mars"}, sky=Sky(turbidity=3)).sky.phase == "mars"


def test_byte_order_mark_and_windows_lines(tmp_path):
    path = tmp_path / "scene.toml"
    path.write_bytes(b"\xef\xbb\xbfseed = 3\r\n[sky]\r\nturbidity = 2\r\n")
    assert fs.load(path).seed == 3
    fs.edit_toml(path, {"sky.turbidity": 5})
    assert path.read_bytes() == b"\xef\xbb\xbfseed = 3\r\n[sky]\r\nturbidity = 5\r\n"


EDITED = """\
# The scene of a Tuesday.
name = "x"   # what it is called

[sky]     # air
turbidity   =   3 # hazy

  [sky.sun]
  disc = true

# The camera stands here.
[camera]
fov = 40
"""


def test_an_edit_changes_one_value_and_no_other_byte(tmp_path):
    path = tmp_path / "scene.toml"
    path.write_text(EDITED)
    expected = EDITED.replace("=   3 # hazy", "=   4 # hazy")
    assert fs.edit_toml(path, {"sky.turbidity": 4}) == expected
    assert path.read_text() == expected
    assert list(tmp_path.iterdir()) == [path]
    assert fs.edit_toml(str(path), {"sky.turbidity": 3}) == EDITED


@pytest.mark.parametrize(
    "changes",
    [
        {"seed": 7},
        {"film.bloom": 0.1, "camera.roll": 3},
        {"sky.sun.limb_darkening": False},
        {"camera.keyframes": [{"at": 0, "fov": 3.0}, {"at": 1, "fov": 4.0}]},
        {"planet.ground_albedo": (0.1, 0.2, 0.3)},
        {"sky": {"moon": False, "sun": {"disc": False}}},
        {"time": datetime(2025, 1, 1, tzinfo=UTC)},
    ],
)
def test_an_edit_keeps_all_lines_it_does_not_change(changes):
    edited = fs.edit_toml(EDITED, changes)
    kept = [line for line in EDITED.splitlines() if not line.strip().startswith("disc")]
    lines = iter(edited.splitlines())
    assert all(line in lines for line in kept)
    assert fs.loads(edited) == fs.load(fs.loads(EDITED), changes)


def test_an_edit_removes_a_key():
    assert fs.edit_toml(EDITED, {"name": None}) == EDITED.replace('name = "x"   # what it is called\n', "")


def test_a_wrong_edit_leaves_the_file_alone(tmp_path):
    path = tmp_path / "scene.toml"
    path.write_text(EDITED)
    for changes in ({"sky.turbidity": -1}, {"sky.nonesuch": 1}, {"name.x": 1}, {"camera.fov": "wide"}):
        with pytest.raises(fs.WorldError):
            fs.edit_toml(path, changes)
    assert path.read_text() == EDITED
    assert list(tmp_path.iterdir()) == [path]


def every_property(node, definitions, path=""):
    for name, inner in node.get("properties", {}).items():
        yield f"{path}{name}", inner
        for target in [inner, *inner.get("anyOf", []), inner.get("items", {})]:
            reference = target.get("$ref")
            if reference:
                yield from every_property(
                    definitions[reference.rpartition("/")[2]], definitions, f"{path}{name}."
                )


def test_the_schema_says_unit_range_default_and_meaning_of_every_field():
    schema = fs.schema()
    json.dumps(schema)
    assert schema["additionalProperties"] is False
    fields = dict(every_property(schema, schema["$defs"]))
    assert {"sky.turbidity", "sky.sun.disc", "camera.keyframes.at", "extends"} <= set(fields)
    for key, node in fields.items():
        assert len(node["description"]) > 10, key
        if "type" in node and node["type"] in ("number", "integer"):
            assert "unit" in node and "minimum" in node and "maximum" in node, key
    turbidity = fields["sky.turbidity"]
    assert (turbidity["minimum"], turbidity["maximum"], turbidity["default"]) == (0.0, 100.0, 1.0)
    assert fields["place.latitude"]["unit"] == "deg" and fields["place.latitude"]["description"].endswith(
        "[deg]"
    )


def test_loading_a_scene_needs_no_numpy():
    code = (
        "import sys, fallstreak as fs; fs.load('jacksboro', ['sky.turbidity=2']);"
        "print([m for m in ('numpy', 'tomlkit', 'rich', 'wgpu') if m in sys.modules])"
    )
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True).stdout.strip() == "[]"


def test_all_scenes_are_in_the_package():
    folder = Path(fs.__file__).parent / "world" / "scenes"
    assert {"jacksboro", "night", "orbit", "mars"} <= {path.stem for path in folder.glob("*.toml")}


READ_IN_WORLD = ("camera", "clouds.layers.oktas")  # by the camera's own `at`, by a layer's `cover`


@pytest.mark.parametrize("key", [key for key in leaves(fs.World) if not key.startswith(READ_IN_WORLD)])
def test_every_key_does_something(key):
    """What a scene may say, some system asks for."""
    package = Path(fs.__file__).parent
    readers = [p for p in package.rglob("*.py") if p.parent.name != "world"]
    name = key.rpartition(".")[2]
    assert any(f".{name}" in path.read_text(encoding="utf-8") for path in readers)
