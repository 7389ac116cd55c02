"""Every kind of broken scene is told in one sentence with file, key, value and what is allowed."""

from __future__ import annotations

import os
import time

import pytest

import fallstreak as fs
from fallstreak.world import WorldError

BROKEN = {
    "empty key": ("= 3\n", "is not TOML"),
    "not toml": ("{ 'a': 1 }\n", "is not TOML"),
    "json": ('{"sky": {"turbidity": 3}}', "is not TOML"),
    "duplicate key": ("seed = 1\nseed = 2\n", "line 2"),
    "duplicate table": ("[sky]\n[place]\n[sky]\n", "line 3"),
    "unclosed string": ('name = "x\n', "line 1"),
    "nul byte": ('name = "a\0b"\n', "is not TOML"),
    "only nul": ("\0" * 100, "is not TOML"),
    "impossible date": ("time = 2025-02-30T00:00:00Z\n", "is not TOML"),
    "huge integer": ("seed = " + "9" * 3900 + "\n", "seed = an integer of"),
    "integer beyond python": ("seed = " + "9" * 10_000 + "\n", "characters are too many"),
    "huge hex": ("seed = 0x" + "f" * 3900 + "\n", "integer of 15,600 bits"),
    "many digits over lines": ("camera.keyframes = [\n" + "1,\n" * 20_000 + "]\n", "keyframes"),
    "deep array": ("name = " + "[" * 1900 + "]" * 1900 + "\n", "nested"),
    "deep inline table": ("sky = " + "{a=" * 900 + "1" + "}" * 900 + "\n", "nested"),
    "deep dotted key": ("sky" + ".a" * 90 + " = 1\n", "nested"),
    "deep header": ("[sky" + ".a" * 90 + "]\n", "nested"),
    "deeper dotted key": ("sky" + ".a" * 1900 + " = 1\n", "more than 100 dots"),
    "deeper header": ("[sky" + ".a" * 1900 + "]\n", "more than 100 dots"),
    "long line": ('name = "' + "x" * 100_000 + '"\n', "100,009 characters are too many"),
    "long string": ('description = """\n' + "lorem ipsum\n" * 5_000 + '"""\n', "at most 4000 characters"),
    "nan": ("[sky]\nturbidity = nan\n", "line 2: sky.turbidity = nan is not allowed: it must be a number"),
    "infinity": ("[camera]\nheight = inf\n", "camera.height = inf"),
    "naive time": ("time = 2025-01-01T12:00:00\n", "has no zone: add one, such as 2025-01-01T12:00:00Z"),
    "naive time in a string": ('time = "2025-01-01T12:00"\n', "has no zone"),
    "date without time": ("time = 2025-01-01\n", "date and time with its zone"),
    "time as a number": ("time = 1750000000\n", "date and time with its zone"),
    "time of nonsense": ('time = "tomorrow"\n', "date and time with its zone"),
    "time beyond the almanac": ("time = 2600-01-01T00:00:00Z\n", "1700 to 2200"),
    "string for a number": ('[sky]\nturbidity = "4"\n', 'sky.turbidity = "4" is not allowed'),
    "flag for a number": ("[sky]\nturbidity = true\n", "sky.turbidity = true"),
    "number for a flag": ("[sky]\nmoon = 1\n", "sky.moon = 1 is not allowed: it must be true or false"),
    "number for a string": ("name = 3\n", "name = 3 is not allowed: it must be a string"),
    "float for a whole number": ("seed = 1.5\n", "a whole number from 0 to 4294967295"),
    "table for a number": ("[sky.turbidity]\nx = 1\n", "sky.turbidity = a table is not allowed"),
    "number for a table": ("sky = 3\n", "line 1: sky = 3 is not allowed: it must be a table"),
    "array for a table": ("[[sky]]\nturbidity = 1\n", "sky = [a table] is not allowed"),
    "table for an array": ("[camera.keyframes]\nat = 1\n", "camera.keyframes = a table"),
    "colours of puffs": ('[clouds]\ntechnique = "puffs"\ncolours = "artist"\n', "only technique sprites"),
    "unknown table": ("[fog]\nx = 1\n", "fog is not known"),
    "unknown key": ("[sky]\nturbidty = 4\n", "line 2: sky.turbidty is not known; did you mean sky.turb"),
    "key in the wrong table": ("turbidity = 4\n", "did you mean sky.turbidity?"),
    "key with control codes": ('"\\u001b[31mred" = 4\n', "is not known"),
    "below the range": ("[place]\nlatitude = -91\n", "latitude = -91 is not allowed: it must be a number"),
    "above the range": ("[camera]\nfov = 180.0\n", "must be a number from 0.1 to 150 (deg)"),
    "negative seed": ("seed = -1\n", "seed = -1"),
    "unknown choice": ('[film]\ntone_map = "aces"\n', 'must be one of "agx", "neutral", "none"'),
    "unknown preset": ('[planet]\npreset = "venus"\n', '"earth", "mars", "custom"'),
    "preset is a table": ("[planet.preset]\nx = 1\n", "planet.preset = a table"),
    "two of three numbers": ("[planet]\nground_albedo = [0.1, 0.2]\n", "= [0.1, 0.2] is not allowed"),
    "one of three too great": ("[planet]\nground_albedo = [0.1, 0.2, 3]\n", "planet.ground_albedo[2] = 3"),
    "one for three too great": ("[planet]\nground_albedo = 3\n", "planet.ground_albedo = 3 is not allowed"),
    "more scattered than lost": ("[sky]\nmie_scattering = 1e-5\n", "greater than mie_extinction"),
    "keyframe without a time": ("[[camera.keyframes]]\nfov = 30\n", "camera.keyframes[0].at is missing"),
    "keyframes out of order": (
        "[[camera.keyframes]]\nat = 1\n[[camera.keyframes]]\nat = 1\n", "in order of time"),
    "second keyframe": (
        "[[camera.keyframes]]\nat = 1\n[[camera.keyframes]]\nat = 2\nfov = -1\n",
        "line 5: camera.keyframes[1].fov"),
    "file is not named": ('[terrain]\nsource = "file"\n', "file is empty"),
    "missing elevations": ('[terrain]\nsource = "file"\nfile = "x.npz"\n', "no such file"),
    "path up": ('[terrain]\nfile = "../x.npz"\n', "leaves the scene's folder"),
    "path up behind": ('[terrain]\nfile = "a/../../x.npz"\n', "leaves the scene's folder"),
    "absolute path": ('[terrain]\nfile = "/etc/passwd.npz"\n', "leaves the scene's folder"),
    "path with nul": ('[terrain]\nfile = "a\\u0000.npz"\n', "NUL"),
    "path of dots": ('[terrain]\nsource = "file"\nfile = ".."\n', "leaves the scene's folder"),
    "too long a path": ('[terrain]\nsource = "file"\nfile = "' + "a" * 3000 + '.npz"\n', "no such file"),
    "very long path": ('[terrain]\nsource = "file"\nfile = "' + "a/" * 1500 + 'x.npz"\n', "no such file"),
    "extends nothing": ('extends = "jacksbro"\n', "did you mean jacksboro?"),
    "extends a missing file": ('extends = "base.toml"\n', "no such file"),
    "extends a number": ("extends = 3\n", "extends = 3"),
    "extends itself": ('extends = "scene.toml"\n', "circle"),
    "extends upwards": ('extends = "../scene.toml"\n', "leaves the scene's folder"),
    "extends a folder": ('extends = "./"\n', "no such file"),
    "extends in a table": ('[sky]\nextends = "jacksboro"\n', "sky.extends is not known"),
    "private name": ("_given = 3\n", "_given is not known"),
    "self": ("self = 3\n", "self is not known"),
}  # fmt: skip


@pytest.mark.parametrize("kind", BROKEN)
def test_broken_scene_is_told_in_one_sentence(kind, tmp_path):
    text, expected = BROKEN[kind]
    path = tmp_path / "scene.toml"
    path.write_bytes(text.encode())
    start = time.perf_counter()
    with pytest.raises(WorldError) as caught:
        fs.load(path)
    message = str(caught.value)
    assert expected in message
    assert "scene.toml" in message or "base.toml" in message, message
    assert "\n" not in message and "\x1b" not in message and "\0" not in message
    assert len(message) < 600, len(message)
    assert time.perf_counter() - start < 5.0  # a stall, not a benchmark
    assert caught.value.__cause__ is None


STALLING = {
    "many keys": "[sky]\n" + "".join(f"k{i} = 1\n" for i in range(90_000)),
    "many tables": "".join(f"[t{i}]\n" for i in range(110_000)),
    "many dotted parts": "\n".join(f"a{i}{'.a' * 99} = 1" for i in range(4500)),
    "many dotted parts inside": "x = {" + "\n".join(f"a{i}{'.a' * 1990} = 1" for i in range(250)),
    "many spaces": "[sky]\nx = 1\n" + ("[" + " " * 3990 + "\n") * 250,
    "headers of spaces": "[sky]\nturbidity = -1\n" + ("# [" + " " * 3980 + "\n") * 250,
    "many strings": "[sky]\nturbidity = [\n" + '"' + '",\n"'.join("x" * 20 for _ in range(40_000)) + '"]\n',
    "many quotes": 'name = """\n' + '\\"""\n' * 200_000,
    "many keyframes": "".join(f"[[camera.keyframes]]\nat = {i}\n" for i in range(20_000)),
}


@pytest.mark.parametrize("kind", STALLING)
def test_a_full_mebibyte_does_not_stall(kind, tmp_path):
    path = tmp_path / "scene.toml"
    path.write_text(STALLING[kind])
    start = time.perf_counter()
    with pytest.raises(WorldError) as caught:
        fs.load(path)
    assert time.perf_counter() - start < 20.0  # quadratic would be minutes
    assert len(str(caught.value)) < 600 and "\n" not in str(caught.value)


def broken(path, expected):
    with pytest.raises(WorldError) as caught:
        fs.load(path)
    assert expected in str(caught.value)
    assert "\n" not in str(caught.value)


def test_bytes_that_are_no_text(tmp_path):
    path = tmp_path / "scene.toml"
    path.write_bytes(b'name = "\xff\xfe"')
    broken(path, "is not UTF-8 text: byte 8 is 0xff")


def test_files_that_are_none(tmp_path):
    broken(tmp_path, "is a folder")
    broken(tmp_path / "missing.toml", "does not exist")
    broken("a\0b.toml", "NUL")
    broken("x" * 5000 + ".toml", "cannot be read")
    (tmp_path / "file.toml").write_text("")
    broken(tmp_path / "file.toml" / "scene.toml", "cannot be read")
    loop = tmp_path / "loop.toml"
    loop.symlink_to(loop)
    broken(loop, "cannot be read")


def test_pipes_and_devices_are_not_opened(tmp_path):
    pipe = tmp_path / "pipe.toml"
    os.mkfifo(pipe)
    broken(pipe, "a device or a pipe")
    zero = tmp_path / "zero.toml"
    zero.symlink_to("/dev/zero")
    broken(zero, "a device or a pipe")


def test_huge_files_are_not_read(tmp_path):
    path = tmp_path / "scene.toml"
    with open(path, "wb") as file:
        file.write(b"seed = 1")
        file.truncate(100 << 20)
    broken(path, "is larger than 1 MiB")


@pytest.mark.skipif(os.geteuid() == 0, reason="root reads everything")
def test_unreadable_file(tmp_path):
    path = tmp_path / "scene.toml"
    path.write_text("")
    path.chmod(0)
    broken(path, "Permission denied")


def test_a_link_out_of_the_folder_is_seen_through(tmp_path):
    (tmp_path / "secret.npz").write_bytes(b"")
    (tmp_path / "secret.toml").write_text("seed = 1")
    folder = tmp_path / "scene"
    folder.mkdir()
    (folder / "link.npz").symlink_to(tmp_path / "secret.npz")
    (folder / "link").symlink_to(tmp_path)
    for text in (
        '[terrain]\nfile = "link.npz"',
        '[terrain]\nfile = "link/secret.npz"',
        'extends = "link/secret.toml"',
    ):
        (folder / "scene.toml").write_text(text)
        broken(folder / "scene.toml", "leaves the scene's folder")


def test_circles_and_towers_of_bases(tmp_path):
    (tmp_path / "a.toml").write_text('extends = "b.toml"')
    (tmp_path / "b.toml").write_text('extends = "a.toml"')
    broken(tmp_path / "a.toml", "a.toml → b.toml → a.toml")
    for i in range(20):
        (tmp_path / f"{i}.toml").write_text(f'extends = "{i + 1}.toml"')
    broken(tmp_path / "0.toml", "deeper than 8 scenes")


def test_a_broken_base_is_named_with_its_line(tmp_path):
    (tmp_path / "base.toml").write_text("[sky]\n\nturbidity = -1\n")
    (tmp_path / "top.toml").write_text('extends = "base.toml"\n[sky]\nmoon = false\n')
    broken(tmp_path / "top.toml", "base.toml, line 3: sky.turbidity = -1")
    (tmp_path / "top.toml").write_text('extends = "base.toml"\n[sky]\nturbidity = -2\n')
    broken(tmp_path / "top.toml", "top.toml, line 3: sky.turbidity = -2")


def test_unknown_names_suggest(tmp_path):
    broken("jacksbro", 'there is no scene "jacksbro" (did you mean jacksboro?): shipped are')
    broken("", "jacksboro, long_shadows, mars, night, orbit")


@pytest.mark.parametrize(
    ("override", "expected"),
    [
        ("sky.turbidty=4", "did you mean sky.turbidity?"),
        ("skyy.turbidity=4", "skyy is not known; did you mean sky?"),
        ("sky.turbidity", "KEY=VALUE"),
        ("=4", "KEY=VALUE"),
        ("sky..turbidity=4", "names joined by dots"),
        ("a" + ".a" * 10_000 + "=4", "names joined by dots"),
        ("sky.turbidity.x=4", "sky.turbidity = a table"),
        ("sky.turbidity=", 'sky.turbidity = ""'),
        ("sky.turbidity=1\nseed=4", "sky.turbidity = "),
        ("sky.turbidity=" + "[" * 3000, "sky.turbidity = "),
        ("sky.turbidity=" + "9" * 3999, "sky.turbidity = "),
        ("name=" + "x" * 5000, "too long"),
        ("camera.keyframes.0.at=1", "camera.keyframes"),
        ("extends=night", "extends is not known"),
        ("terrain.file=nowhere.npz", "no such file"),
    ],
)
def test_broken_overrides(override, expected):
    with pytest.raises(WorldError) as caught:
        fs.load("jacksboro", [override])
    assert expected in str(caught.value)
    assert "\n" not in str(caught.value) and len(str(caught.value)) < 600


def test_python_callers_get_the_same_sentence():
    with pytest.raises(
        WorldError, match=r"sky\.turbidity = -1 is not allowed: it must be a number from 0 to 100"
    ):
        fs.World(sky={"turbidity": -1})
    with pytest.raises(WorldError, match=r"change: camera\.fov = 1000"):
        fs.World().updated({"camera.fov": 1000})
    with pytest.raises(WorldError, match="nested deeper"):
        nested = {}
        nested["sky"] = nested
        fs.World(**nested)
