"""Every kind of broken or hostile model is told in one sentence, quickly, and without asking for memory."""

from __future__ import annotations

import json
import os
import resource
import subprocess
import sys
import time

import numpy as np
import pytest

import fallstreak as fs
from fallstreak.models.poses import PlacedModels
from fallstreak.world import UserError

from .files import Maker, cube


def first(maker, kind):
    return maker.tree[kind][0]


def uri(maker, value):
    maker.tree["buffers"] = [{"byteLength": len(maker.data), "uri": value}]


def image(maker, **values):
    maker.tree["images"] = [values]
    maker.tree["textures"] = [{"source": 0}]
    pbr = {"baseColorTexture": {"index": 0}}
    maker.tree["materials"] = [{"pbrMetallicRoughness": pbr}]
    maker.tree["meshes"][0]["primitives"][0]["material"] = 0


def circle(maker):
    maker.tree["nodes"] = [{"mesh": 0, "children": [1]}, {"children": [0]}]


def fan_out(maker):
    """Forty generations that each name the next twice: 2^40 nodes."""
    maker.tree["nodes"] = [{"children": [i + 1, i + 1]} for i in range(40)] + [{"mesh": 0}]


def shape(maker, **values):
    maker.tree["accessors"][0].update(values)


def nan(maker):
    positions = cube()[0].copy()
    positions[3, 1] = np.nan
    maker.data[: positions.nbytes] = positions.tobytes()


def far(maker):
    maker.tree["nodes"][0]["translation"] = [1e30, 0, 0]


BROKEN = {
    "count of a thousand million": (lambda m: shape(m, count=10**9), "more than 4,000,000 vertices"),
    "count beyond the data": (lambda m: shape(m, count=1000), "reaches beyond its data"),
    "negative count": (lambda m: shape(m, count=-3), "count is -3"),
    "count of no number": (lambda m: shape(m, count="many"), "is not glTF 2.0|count is"),
    "offset beyond the data": (lambda m: shape(m, byteOffset=10**12), "reaches beyond its data"),
    "negative offset": (lambda m: shape(m, byteOffset=-4), "byteOffset is -4"),
    "unknown component": (lambda m: shape(m, componentType=9), "has the type"),
    "unknown type": (lambda m: shape(m, type="VEC7"), "has the type"),
    "sparse": (lambda m: shape(m, sparse={"count": 1, "indices": {"bufferView": 0, "componentType": 5121},
                                          "values": {"bufferView": 0}}), "sparse, which is not supported"),
    "no data": (lambda m: m.tree["accessors"][0].pop("bufferView"), "has no data"),
    "view beyond the buffer": (
        lambda m: first(m, "bufferViews").update(byteLength=10**9), "reaches beyond its"),
    "view of no buffer": (lambda m: first(m, "bufferViews").update(buffer=7), "buffers[7], and there are 1"),
    "buffer of a promise": (lambda m: m.tree.update(buffers=[{"byteLength": 10**10}]), "ends early"),
    "accessor out of range": (
        lambda m: m.tree["meshes"][0]["primitives"][0].update(indices=99), "accessors[99]"),
    "index out of range": (
        lambda m: m.data.__setitem__(slice(-4, None), b"\xff\xff\xff\xff"), "an index is 65,535"),
    "node out of range": (lambda m: m.tree["scenes"][0].update(nodes=[5]), "nodes[5], and there are 1"),
    "scene out of range": (lambda m: m.tree.update(scene=5), "scenes[5]"),
    "material out of range": (
        lambda m: m.tree["meshes"][0]["primitives"][0].update(material=5), "materials[5]"),
    "nodes in a circle": (circle, "in a circle"),
    "a million million nodes": (fan_out, "in a circle"),
    "not a number": (nan, "not a number"),
    "infinitely far": (far, "further than a million kilometres"),
    "no rotation": (lambda m: first(m, "nodes").update(rotation=[1, 2]), "rotation is"),
    "matrix of words": (lambda m: first(m, "nodes").update(matrix=["a"] * 16), "matrix is|not glTF"),
    "no triangles": (lambda m: m.tree["meshes"][0].update(primitives=[]), "no triangles"),
    "no meshes": (lambda m: m.tree.update(nodes=[{}]), "no triangles"),
    "two vertices": (lambda m: m.tree["accessors"][2].update(count=2), "no triangles"),
    "buffer from above": (lambda m: uri(m, "../secret.bin"), "leaves the model's folder"),
    "buffer from above, veiled": (lambda m: uri(m, "a/%2e%2e/..%2fsecret.bin"), "leaves the model's folder"),
    "absolute buffer": (lambda m: uri(m, "/etc/passwd"), "leaves the model's folder"),
    "buffer from the net": (
        lambda m: uri(m, "https://example.org/a.bin"), "only files in the model's own folder"),
    "buffer by scheme": (lambda m: uri(m, "file:///etc/passwd"), "only files in the model's own folder"),
    "buffer that is missing": (lambda m: uri(m, "gone.bin"), "does not exist"),
    "buffer that is the folder": (lambda m: uri(m, "."), "leaves the model's folder"),
    "buffer of bad letters": (lambda m: uri(m, "data:;base64,@@@"), "cannot be decoded|ends early"),
    "buffer that is a number": (lambda m: uri(m, 3), "which it names, does not exist"),
    "image that is none": (lambda m: image(m, bufferView=0), "neither PNG nor JPEG"),
    "image from above": (lambda m: image(m, uri="../x.png"), "leaves the model's folder"),
    "texture without image": (
        lambda m: (image(m, bufferView=0), m.tree["textures"][0].pop("source")), "no picture"),
    "factor of words": (lambda m: (image(m, bufferView=0), first(m, "materials").update(
        pbrMetallicRoughness={"baseColorFactor": ["red"]})), "a material holds|not glTF"),
    "an extension that is needed": (
        lambda m: m.tree.update(extensionsRequired=["KHR_draco_mesh_compression"]), "requires the extension"),
    "version 1": (lambda m: m.tree["asset"].update(version="1.0"), "glTF 2.0 is read"),
    "words for a list": (lambda m: m.tree.update(nodes="many"), "not glTF|speaks of"),
    "numbers for tables": (lambda m: m.tree.update(meshes=[3]), "not glTF"),
    "meshes without end": (
        lambda m: (m.tree["meshes"][0].update(primitives=[{"attributes": {}}] * 300),
                   m.tree.update(nodes=[{"mesh": 0}] * 300, scenes=[{"nodes": list(range(300))}])),
        "draws more than"),
    "nothing": (lambda m: m.tree.clear(), "no triangles"),
}  # fmt: skip


def told(path) -> str:
    """What is said of a model, within a second or two and a few megabytes."""
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    start = time.perf_counter()
    with pytest.raises(UserError) as caught:
        PlacedModels(fs.World(models=[{"file": str(path), "above": "sea"}]))
    message = str(caught.value)
    assert message.startswith("models[0].file = ") and path.name[:20] in message
    assert "\n" not in message and len(message) < 400, message
    assert time.perf_counter() - start < 5.0  # a stall, not a benchmark
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 200_000, "kilobytes"
    return message


@pytest.mark.parametrize("kind", BROKEN)
def test_broken_models_are_told_in_one_sentence(kind, tmp_path):
    change, expected = BROKEN[kind]
    maker = Maker().cube()
    change(maker)
    path = tmp_path / ("a.gltf" if "buffers" in maker.tree and "uri" in maker.tree["buffers"][0] else "a.glb")
    message = told(maker.save(path))
    assert any(part in message for part in expected.split("|")), message


def raw(kind, whole):
    deep = b"[" * 200_000 + b"]" * 200_000
    return {
        "empty.glb": b"",
        "short.glb": whole[:10],
        "truncated.glb": whole[: len(whole) // 2],
        "beheaded.glb": whole[4:],
        "noise.glb": np.random.default_rng(0).bytes(20_000),
        "header.glb": b"glTF" + b"\xff" * 60,
        "zeros.glb": whole[:12] + b"\0" * 400,
        "word.gltf": b"hello",
        "open.gltf": b'{"asset": {"version": "2.0"',
        "deep.gltf": b'{"asset": {"version": "2.0"}, "nodes": ' + deep + b"}",
        "deep.extras.gltf": b'{"asset": {"version": "2.0"}, "extras": ' + deep + b"}",
        "many.gltf": b'{"asset": {"version": "2.0"}, "nodes": [' + b"{}," * 300_000 + b"{}]}",
        "utf16.gltf": '{"asset": {"version": "2.0"}}'.encode("utf-16"),
        "latin.gltf": b'{"asset": {"version": "2.0", "generator": "\xe4"}}',
        "picture.glb": b"\x89PNG\r\n\x1a\n" + b"\0" * 100,
    }[kind]


RAW = ["empty.glb", "short.glb", "truncated.glb", "beheaded.glb", "noise.glb", "header.glb", "zeros.glb",
       "word.gltf", "open.gltf", "deep.gltf", "deep.extras.gltf", "many.gltf", "utf16.gltf", "latin.gltf",
       "picture.glb"]  # fmt: skip


@pytest.mark.parametrize("name", RAW)
def test_files_that_are_no_models(name, tmp_path):
    path = tmp_path / name
    path.write_bytes(raw(name, Maker().cube().glb()))
    told(path)


def test_any_byte_may_be_wrong(tmp_path):
    """Whatever a damaged file holds, it loads or is told in a sentence."""
    whole = np.frombuffer(Maker().cube().glb(), np.uint8)
    rng = np.random.default_rng(3)
    path = tmp_path / "a.glb"
    outcomes = set()
    for number in range(150):
        broken = whole.copy()
        broken[rng.integers(12, len(whole), 3)] = rng.integers(0, 256, 3)
        path.write_bytes(broken.tobytes())
        os.utime(path, ns=(number, number))
        try:
            PlacedModels(fs.World(models=[{"file": str(path)}]))
            outcomes.add("loaded")
        except UserError as error:
            assert "\n" not in str(error)
            outcomes.add("told")
    assert outcomes == {"loaded", "told"}


JUNK = (None, True, -1, 0, 3, 10**20, 1.5, float("nan"), 1e308, "x", "", [], {}, [1], [None], {"a": 1}, 2**31)


def places(tree, path=()):
    """The path of everything in a tree."""
    items = tree.items() if isinstance(tree, dict) else enumerate(tree) if isinstance(tree, list) else ()
    for key, value in items:
        yield (*path, key)
        yield from places(value, (*path, key))


def test_any_word_may_be_wrong(tmp_path):
    rng = np.random.default_rng(4)
    path = tmp_path / "a.glb"
    told = 0
    for number in range(200):
        maker = Maker()
        texture = {"index": maker.picture(np.full((4, 4, 3), 9, np.uint8), wrapS=33071)}
        rough = {"baseColorTexture": texture, "metallicFactor": 0.5, "baseColorFactor": [1, 1, 1, 1]}
        maker.cube(maker.material(pbrMetallicRoughness=rough, normalTexture=texture, alphaMode="MASK"))
        maker.tree["nodes"][0] |= {"children": [1], "rotation": [0, 0, 0, 1], "scale": [1, 1, 1]}
        maker.tree["nodes"].append({"mesh": 0, "matrix": np.eye(4).ravel().tolist()})
        maker.tree["buffers"] = [{"byteLength": len(maker.data)}]
        found = list(places(maker.tree))
        *at, last = found[rng.integers(len(found))]
        table = maker.tree
        for key in at:
            table = table[key]
        table[last] = JUNK[rng.integers(len(JUNK))]
        maker.save(path)
        os.utime(path, ns=(number, number))
        try:
            PlacedModels(fs.World(models=[{"file": str(path)}]))
        except UserError as error:
            assert "\n" not in str(error) and len(str(error)) < 400
            told += 1
    assert 50 < told < 200


def test_a_folder_a_pipe_and_two_gigabytes(tmp_path):
    (tmp_path / "folder.glb").mkdir()
    assert "a folder" in told(tmp_path / "folder.glb") or "no regular file" in told(tmp_path / "folder.glb")
    os.mkfifo(tmp_path / "pipe.glb")
    assert "a device or a pipe" in told(tmp_path / "pipe.glb")
    with open(tmp_path / "huge.glb", "wb") as file:
        file.truncate(2 << 30)  # sparse: takes no room
    assert "has 2,048 MiB, and at most 512 MiB are read" in told(tmp_path / "huge.glb")
    assert "does not exist" in told(tmp_path / "none.glb")


def test_a_picture_that_unpacks_to_gigabytes(maker, tmp_path):
    import struct
    import zlib

    header = struct.pack(">IIBBBBB", 100_000, 100_000, 8, 2, 0, 0, 0)
    chunks = [(b"IHDR", header), (b"IDAT", zlib.compress(b"\0" * 1000)), (b"IEND", b"")]
    data = b"\x89PNG\r\n\x1a\n"
    for kind, body in chunks:
        data += struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
    maker.tree["images"] = [{"bufferView": maker.view(data)}]
    maker.tree["textures"] = [{"source": 0}]
    maker.cube(maker.material(pbrMetallicRoughness={"baseColorTexture": {"index": 0}}))
    assert "larger than" in told(maker.save(tmp_path / "bomb.glb"))


def test_a_link_out_of_the_folder(maker, tmp_path):
    (tmp_path / "outside.bin").write_bytes(b"\0" * 4000)
    inside = tmp_path / "inside"
    inside.mkdir()
    (inside / "a.bin").symlink_to(tmp_path / "outside.bin")
    maker.cube()
    uri(maker, "a.bin")
    assert "leaves the model's folder" in told(maker.save(inside / "a.gltf"))


@pytest.mark.parametrize("command", ["check", "render"])
def test_the_command_line_says_it_and_exits_2(command, tmp_path):
    (tmp_path / "bad.glb").write_bytes(b"glTF and nothing else")
    (tmp_path / "scene.toml").write_text('[[models]]\nfile = "bad.glb"\n')
    more = ["-o", "x.png", "--size", "32x32"] if command == "render" else []
    result = subprocess.run(
        [sys.executable, "-m", "fallstreak", command, "scene.toml", *more],
        cwd=tmp_path, capture_output=True, text=True, timeout=60,
    )  # fmt: skip
    assert result.returncode == 2
    assert "bad.glb" in result.stderr and result.stderr.count("\n") == 1, result.stderr
    assert not (tmp_path / "x.png").exists()


SCENES = {
    "no such model": ('[[models]]\nfile = "glidr"\n', "shipped models are glider, ship"),
    "no such file": ('[[models]]\nfile = "a.glb"\n', "there is no such file"),
    "leaves the folder": ('[[models]]\nfile = "../a.glb"\n', "leaves the scene's folder"),
    "no file": ("[[models]]\neast = 3\n", "models[0].file is missing"),
    "two of a name": (
        '[[models]]\nfile = "ship"\n[[models]]\nfile = "ship"\n', 'two models are called "ship"'),
    "odd name": ('[[models]]\nfile = "ship"\nname = "a@b"\n', "letters, digits"),
    "in the second": (
        '[[models]]\nfile = "ship"\n[[models]]\nfile = "glider"\nroll = "x"\n', "line 5: models[1].roll"),
    "in an instance": (
        '[[models]]\nfile = "ship"\n[[models]]\nfile = "glider"\n[[models.instances]]\n[[models.instances]]\n'
        "scale = 0\n", "line 7: models[1].instances[1].scale = 0"),
    "instances that move": (
        '[[models]]\nfile = "ship"\ninstances = [{}]\nkeyframes = [{at = 0}]\n', "instances and keyframes"),
    "keyframes out of order": (
        '[[models]]\nfile = "ship"\nkeyframes = [{at = 1}, {at = 0}]\n', "in order of time"),
    "a table": ('[models]\nfile = "ship"\n', "an array of tables"),
}  # fmt: skip


@pytest.mark.parametrize("kind", SCENES)
def test_scenes_say_where_and_what(kind, tmp_path):
    text, expected = SCENES[kind]
    (tmp_path / "scene.toml").write_text(text)
    with pytest.raises(UserError) as caught:
        fs.load(tmp_path / "scene.toml")
    message = str(caught.value)
    assert expected in message and "scene.toml" in message and "\n" not in message, message


def test_a_scene_with_models_goes_through_toml(tmp_path, maker):
    maker.cube().save(tmp_path / "cube.glb")
    world = fs.World(
        models=[
            {"file": "ship", "height": 400.0, "keyframes": [{"at": 0, "east": 1.0}, {"at": 2, "roll": 5.0}]},
            {
                "file": "glider",
                "name": "gliders",
                "instances": [{"east": 1.0}, {"north": 1e-3, "scale": 2.0}],
            },
            {"file": "glider", "above": "sea"},
        ]
    )
    assert fs.loads(world.to_toml()) == world
    (tmp_path / "a.toml").write_text('[[models]]\nfile = "cube.glb"\n')
    again = fs.load(tmp_path / "a.toml")
    assert again.models[0].path == tmp_path / "cube.glb" and again.models[0].called == "cube"
    assert 'file = "cube.glb"' in again.to_toml()
    assert json.loads(json.dumps(fs.schema()))["properties"]["models"]["type"] == "array"
