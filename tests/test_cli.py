"""The command line: what it prints, its exit status, and that nobody sees a traceback."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

import fallstreak
from fallstreak.cli import main


def run(capsys, *arguments):
    status = main(list(arguments))
    captured = capsys.readouterr()
    return status, captured.out, captured.err


def test_help_teaches(capsys):
    status, out, err = run(capsys, "--help")
    assert status == 0 and not err
    for word in ("render", "scenes", "check", "schema", "doctor", "bench", "Examples:"):
        assert word in out


@pytest.mark.parametrize("command", ["render", "scenes", "check", "schema", "noise", "doctor", "bench"])
def test_every_command_explains_itself(capsys, command):
    status, out, err = run(capsys, command, "--help")
    assert status == 0 and not err
    assert f"Usage: fallstreak {command}" in out and len(out) > 80


def test_version(capsys):
    assert run(capsys, "--version") == (0, f"{fallstreak.__version__}\n", "")


def test_scenes_are_listed_with_place_and_time(capsys):
    status, out, _ = run(capsys, "scenes")
    assert status == 0
    for name in fallstreak.scene_names():
        assert name in out
    assert "° W" in out and "2025-10-18" in out and "Mars" in out


def test_check_says_ok(capsys, tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text('extends = "jacksboro"\nseed = 4\n')
    assert run(capsys, "check", str(path), "orbit") == (0, f"ok {path}\nok orbit\n", "")


def test_check_tells_each_mistake_and_goes_on(capsys, tmp_path):
    path = tmp_path / "broken.toml"
    path.write_text("[sky]\nturbidity = -1\n")
    status, out, err = run(capsys, "check", str(path), "nonesuch", "orbit")
    assert status == 2 and out == "ok orbit\n"
    first, second = err.splitlines()
    assert first == f"{path}, line 2: sky.turbidity = -1 is not allowed: it must be a number from 0 to 100"
    assert "nonesuch" in second


def test_check_reads_elevations(capsys, tmp_path):
    (tmp_path / "dem.npz").write_bytes(b"PK nothing")
    path = tmp_path / "scene.toml"
    path.write_text('[terrain]\nsource = "file"\nfile = "dem.npz"\n')
    status, _, err = run(capsys, "check", str(path))
    assert status == 2 and "dem.npz" in err and err.count("\n") == 1
    status, _, err = run(
        capsys, "check", "orbit", "--set", "terrain.source=file", "--set", "terrain.file=mars"
    )
    assert status == 2 and "jacksboro" in err and err.count("\n") == 1


def test_check_takes_overrides(capsys):
    status, _, err = run(capsys, "check", "orbit", "--set", "sky.turbidity=3", "--set", "sky.mon=true")
    assert status == 2 and "did you mean sky.moon?" in err


def test_schema_to_terminal_and_file(capsys, tmp_path):
    status, out, _ = run(capsys, "schema")
    assert status == 0 and json.loads(out) == json.loads(json.dumps(fallstreak.schema()))
    path = tmp_path / "scene.schema.json"
    assert run(capsys, "schema", "-o", str(path)) == (0, "", "")
    assert path.read_text() == out
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (["chekc"], 'Did you mean "check"?'),
        (["check"], "nothing to check"),
        (["check", "--sett", "a=1"], "--sett"),
        (["schema", "-o", "/nonexistent/folder/x.json"], "cannot be written"),
        (["bench", "nonesuch"], "no benchmark named nonesuch"),
        (["render", "nonesuch"], "there is no scene"),
        (["render", "missing.toml"], "missing.toml does not exist"),
        (["render", "jacksboro", "--set", "sky.turbidity=-1"], "sky.turbidity = -1"),
        (["render", "jacksboro", "--time", "noon"], 'time = "noon"'),
        (["render", "a\x1b[31mb.toml"], "does not exist"),
    ],
)
def test_mistakes_are_one_sentence_on_stderr(capsys, arguments, expected):
    status, out, err = run(capsys, *arguments)
    assert status == 2 and not out
    assert err.startswith("fallstreak: ") and err.count("\n") == 1
    assert expected in err and "\x1b" not in err


def test_a_reader_that_leaves_is_no_mistake():
    command = f"{sys.executable} -m fallstreak schema | head -c 10"
    result = subprocess.run(command, shell=True, capture_output=True, text=True, env=os.environ)
    assert result.returncode == 0 and result.stderr == ""


def test_the_page_of_scenes_lists_every_key_there_is(capsys):
    page = Path(__file__).parents[1] / "docs" / "scenes.md"
    status, out, _ = run(capsys, "schema", "--markdown")
    assert status == 0
    tables = page.read_text(encoding="utf-8").partition("prints these tables.\n\n")[2]
    assert tables == out, (
        'put the output of "fallstreak schema --markdown" under "Every key" in docs/scenes.md'
    )
