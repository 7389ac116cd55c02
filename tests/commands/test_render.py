"""``fallstreak render`` as a person types it, with a renderer that needs no GPU."""

import importlib
import json
import os
import signal
import subprocess
import sys
import textwrap
import time
from pathlib import Path
from types import SimpleNamespace
from typing import ClassVar

import numpy as np
import pytest
from PIL import Image

from fallstreak.cli import main
from fallstreak.output import read_metadata

SMALL = ["--size", "32x18"]


class FakeRenderer:
    """The interface of `fallstreak.frame.renderer.Renderer`; every frame depends on all before it."""

    made: ClassVar[list[dict]] = []
    slow = 0.0

    def __init__(self, world, size=(1280, 720), quality="high", **options):
        self.world, self.size, self.options = world, size, options
        self.samples = options.get("samples") or 1
        self.history = np.zeros((size[1], size[0], 3), np.uint8)
        self.submitted = []
        FakeRenderer.made.append({"size": size, "quality": quality, **options})

    def __enter__(self):
        return self

    def __exit__(self, *_):
        pass

    def submit(self, index):
        time.sleep(self.slow)
        self.history = (self.history.astype(int) * 3 + index + np.arange(self.size[0])[:, None]).astype(
            np.uint8
        )
        self.submitted.append(index)
        frame = SimpleNamespace(
            ldr=self.history if self.options["bits"] == 8 else None,
            ldr16=self.history.astype(np.uint16) * 257,
            metadata={
                "size": list(self.size),
                "ev100": 12.5,
                "time": self.world.time.isoformat(),
                "seed": self.world.seed,
            },
            stats={},
            **{
                name: self.history[..., :n].squeeze().astype(np.float32)
                for name, n in {
                    "hdr": 3,
                    "depth": 1,
                    "normal": 3,
                    "albedo": 3,
                    "motion": 2,
                    "clouds": 1,
                }.items()
                if name in self.options["layers"]
            },
        )
        return SimpleNamespace(result=lambda: frame)

    def stats(self):
        passes = [
            {"name": "sky.draw", "gpu_ms": 2.0, "cpu_ms": 0.1},
            {"name": "tonemap", "gpu_ms": None, "cpu_ms": 0.2},
        ]
        return {
            "adapter": "fake",
            "gpu_ms": 2.0,
            "cpu_ms": 0.3,
            "passes": passes,
            "texture_bytes": 1 << 20,
            "buffer_bytes": 1 << 10,
            "calls": 12,
        }

    def checkpoint(self):
        return {"history": self.history.copy()}

    def restore(self, state):
        self.history = state["history"]


def install():
    """Put the fake where the command imports the real one."""
    sys.modules["fallstreak.frame.renderer"] = SimpleNamespace(Renderer=FakeRenderer)  # type: ignore[assignment]
    importlib.import_module("fallstreak.gpu.adapters").choose = lambda wanted: (
        SimpleNamespace(name="fake"),
        "because",
    )


@pytest.fixture(autouse=True)
def fake(monkeypatch, tmp_path):
    monkeypatch.setitem(sys.modules, "fallstreak.frame.renderer", SimpleNamespace(Renderer=FakeRenderer))
    adapters = importlib.import_module("fallstreak.gpu.adapters")
    monkeypatch.setattr(adapters, "choose", lambda wanted: (SimpleNamespace(name="fake"), ""))
    monkeypatch.setattr(FakeRenderer, "made", [])
    monkeypatch.chdir(tmp_path)


def refused(capsys, *arguments):
    """The one sentence with which a command line is refused."""
    assert main(["render", *arguments]) == 2
    out, err = capsys.readouterr()
    assert out == "" and err.count("\n") == 1 and "Traceback" not in err
    assert FakeRenderer.made == []
    return err


def test_a_still(capsys, tmp_path):
    assert main(["render", "jacksboro", *SMALL]) == 0
    assert capsys.readouterr().out.startswith("jacksboro.png: 32×18, 20")
    assert Image.open("jacksboro.png").size == (32, 18)
    metadata = read_metadata("jacksboro.png")
    assert metadata["ev100"] == 12.5 and len(metadata["scene_hash"]) == 16
    assert FakeRenderer.made[0]["layers"] == ()


def test_options_reach_the_renderer_and_the_world():
    arguments = ["--time", "2025-10-18T13:00-04:00", "--seed", "7", "--quality", "low", "--samples", "3"]
    arguments += ["--camera", "height=2000, pitch=-5", "--bits", "16", "--adapter", "fak"]
    assert (
        main(["render", "jacksboro", *SMALL, *arguments, "-o", "a.png", "-o", "b.exr", "--layers", "depth"])
        == 0
    )
    made = FakeRenderer.made[0]
    assert (made["quality"], made["samples"], made["bits"], made["adapter"]) == ("low", 3, 16, "fak")
    assert made["layers"] == ("depth",)
    assert read_metadata("a.png")["bits"] == 16 and read_metadata("b.exr")["layers"] == ["depth"]
    assert read_metadata("a.png")["seed"] == 7
    assert read_metadata("a.png")["time"].startswith("2025-10-18T13:00")


def test_an_exr_has_all_layers_by_default():
    assert main(["render", "jacksboro", *SMALL, "-o", "b.exr"]) == 0
    assert read_metadata("b.exr")["layers"] == ["hdr", "depth", "normal", "albedo", "motion", "clouds"]


def test_stats(capsys):
    assert main(["render", "jacksboro", *SMALL, "--stats", "s.json"]) == 0
    assert "sky.draw" in capsys.readouterr().out
    stats = json.loads(Path("s.json").read_text())
    assert stats["adapter"] == "fake" and stats["size"] == [32, 18]
    assert stats["passes"][0] == {"name": "sky.draw", "gpu_ms": 2.0, "cpu_ms": 0.1}
    assert stats["per_frame"] == [{"frame": 0, "gpu_ms": 2.0, "cpu_ms": 0.3}]
    assert stats["texture_bytes"] == 1 << 20
    result = subprocess.run(
        [sys.executable, "-m", "fallstreak.commands.stats", "s.json"], capture_output=True, text=True
    )
    assert "sky.draw" in result.stdout and result.returncode == 0


def test_a_sequence_again_and_again(capsys, tmp_path):
    sequence = [
        "render",
        "jacksboro",
        *SMALL,
        "--frames",
        "3:8",
        "--fps",
        "2",
        "-o",
        "a.png",
        "-o",
        "b-##.npz",
    ]
    assert main(sequence) == 0
    out, err = capsys.readouterr()
    assert out.startswith("a.####.png, b-##.npz: 5 frames, 32×18") and err == ""
    assert read_metadata("a.0003.png")["frame"] == 3
    before = {path.name: path.read_bytes() for path in sorted(tmp_path.iterdir())}
    assert list(before) == [f"a.{i:04d}.png" for i in range(3, 8)] + [f"b-{i:02d}.npz" for i in range(3, 8)]
    assert main(sequence) == 0
    assert capsys.readouterr().out == "a.####.png, b-##.npz: all 5 frames are there already\n"
    os.unlink("a.0005.png")
    assert main(sequence) == 0
    out, err = capsys.readouterr()
    assert err == "4 of 5 frames are there already\n"
    assert before == {path.name: path.read_bytes() for path in sorted(tmp_path.iterdir())}


def test_other_worlds_are_rendered_again(capsys):
    sequence = ["render", "jacksboro", *SMALL, "--frames", "0:2"]
    assert main(sequence) == 0
    for change in (["--seed", "3"], ["--set", "sky.turbidity=3"], ["--fps", "12"], ["--quality", "low"]):
        capsys.readouterr()
        assert main([*sequence, *change]) == 0
        assert "2 frames" in capsys.readouterr().out, change


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_stopped_and_resumed(number, tmp_path, capsys):
    """The same bytes, whether the command ran through or was stopped by a signal."""
    sequence = ["render", "jacksboro", *SMALL, "--frames", "0:60"]
    assert main([*sequence, "-o", "whole.png"]) == 0
    script = f"""
        import sys
        sys.path.insert(0, {os.path.dirname(__file__)!r})
        from test_render import FakeRenderer, install
        install()
        FakeRenderer.slow = 0.02
        from fallstreak.cli import main
        sys.exit(main({[*sequence, "-o", "stopped.png"]!r}))
    """
    process = subprocess.Popen(
        [sys.executable, "-c", textwrap.dedent(script)], stderr=subprocess.PIPE, text=True
    )
    deadline = time.monotonic() + 60
    while not (tmp_path / "stopped.0005.png").exists() and time.monotonic() < deadline:
        time.sleep(0.01)
    process.send_signal(number)
    err = process.communicate(timeout=60)[1]
    assert process.returncode == 130
    assert "frames are there; the same command goes on from here" in err
    there = len(list(tmp_path.glob("stopped.*.png")))
    assert 5 < there < 60
    assert not list(tmp_path.glob(".*.part"))
    capsys.readouterr()
    assert main([*sequence, "-o", "stopped.png"]) == 0
    assert f"{there} of 60 frames are there already" in capsys.readouterr().err
    for index in range(60):
        whole, stopped = (tmp_path / f"{name}.{index:04d}.png" for name in ("whole", "stopped"))
        assert whole.read_bytes() == stopped.read_bytes()
    assert not (tmp_path / ".fallstreak").exists()


@pytest.mark.parametrize(
    "size", ["", "640", "640x", "x480", "0x10", "10x20", "9000x100", "1e3x100", "-64x64", "64.5x64"]
)
def test_nonsense_sizes(size, capsys):
    assert f'--size "{size}" is not' in refused(capsys, "jacksboro", f"--size={size}")


@pytest.mark.parametrize("frames", ["", "5", "a:b", "5:5", "9:3", "-3:4", "0:99999999999", "0:10:2"])
def test_nonsense_frames(frames, capsys):
    assert f'--frames "{frames}" is' in refused(capsys, "jacksboro", f"--frames={frames}")


@pytest.mark.parametrize("moment", ["", "yesterday", "2025-10-18T18:28", "2025-13-18T18:28Z", "12"])
def test_nonsense_times(moment, capsys):
    assert "time" in refused(capsys, "jacksboro", f"--time={moment}")


@pytest.mark.parametrize(
    "camera", ["height", "height=", "hight=3", "height=high", "pitch=200", "=3", "keyframes=[]"]
)
def test_nonsense_cameras(camera, capsys):
    assert "camera" in refused(capsys, "jacksboro", f"--camera={camera}")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["-o", "a.jpg"], "'.jpg' is unknown; there are .png"),
        (["-o", "a"], "no suffix; there are .png"),
        (["-o", "no/a.png"], "mkdir -p no"),
        (["-o", "."], "is a folder: give a file name in it"),
        (["-o", "a.####.png"], "give --frames"),
        (["-o", "a.##.##.png", "--frames", "0:3"], "2 places"),
        (["-o", "a.png", "-o", "./a.png"], "given twice"),
        (["-o", "a.png", "-o", "a.####.png", "--frames", "0:3"], "the same when numbered"),
        (["--layers", "depth"], "a PNG holds only the picture"),
        (["--layers", "dpeth", "-o", "a.exr"], "no layer 'dpeth'; there are hdr, depth"),
        (["--layers", ",", "-o", "a.exr"], "--layers is empty"),
        (["--stats", "no/s.json"], "--stats no/s.json: there is no folder no"),
        (["--fps", "0"], "--fps 0 is not allowed"),
        (["--fps", "nan"], "--fps nan is not allowed"),
        (["--samples", "0"], "--samples 0 is not allowed"),
        (["--samples", "many"], "samples"),
        (["--bits", "10"], "--bits 10 is not allowed"),
        (["--bits", "16", "-o", "a.exr"], "--bits 16 does not go into a.exr"),
        (["--samples", "999999999"], "--samples 999999999 is not allowed"),
        (["--stats", "."], "--stats . is a folder"),
        (["--quality", "best"], "quality"),
        (["--seed", "-1"], "seed"),
        (["--set", "sky.turbidiy=3"], "turbidiy"),
    ],
)
def test_nonsense_of_other_kinds(arguments, words, capsys):
    assert words in refused(capsys, "jacksboro", *arguments)


def test_a_sequence_may_not_leave_the_almanac(capsys):
    arguments = ["--frames", "9999990:9999991", "--set", "time_scale=1e6"]
    assert "1700 to 2200" in refused(capsys, "jacksboro", *arguments)


def test_unknown_scene(capsys):
    assert "jacksboro" in refused(capsys, "jacksburo")


@pytest.mark.skipif(os.name != "posix" or os.geteuid() == 0, reason="root may write everywhere")
def test_no_permission(tmp_path, capsys):
    (tmp_path / "locked").mkdir(mode=0o500)
    assert "no permission" in refused(capsys, "jacksboro", "-o", "locked/a.png")
