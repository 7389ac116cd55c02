"""The real renderer behind the real command: layers that agree, a sequence killed and resumed."""

import os
import signal
import subprocess
import sys
import time

import numpy as np
import OpenEXR
from PIL import Image

from fallstreak.cli import main
from fallstreak.output import read_metadata

SMALL = ["--size", "64x36", "--quality", "low"]


def test_layers_agree(device, tmp_path, capsys):
    """The sky is where the depth is infinite and the normal zero; the picture is that of the light."""
    arguments = [
        *SMALL,
        "-o",
        str(tmp_path / "a.exr"),
        "-o",
        str(tmp_path / "a.png"),
        "-o",
        str(tmp_path / "a.npz"),
    ]
    assert main(["render", "jacksboro", *arguments]) == 0
    with OpenEXR.File(str(tmp_path / "a.exr"), separate_channels=True) as file:
        channels = {name: channel.pixels.copy() for name, channel in file.channels().items()}
    normal = np.linalg.norm([channels[f"N.{axis}"] for axis in "XYZ"], axis=0)
    sky = np.isinf(channels["Z"])
    assert 0.2 < sky.mean() < 0.8 and sky[0].all() and not sky[-1].any()
    np.testing.assert_allclose(normal, np.where(sky, 0.0, 1.0), atol=1e-3)
    assert channels["Z"].min() > 1.0
    light = 0.2126 * channels["R"] + 0.7152 * channels["G"] + 0.0722 * channels["B"]
    assert np.isfinite(light).all() and 10 < np.median(light) < 1e5  # cd/m², an hour before sunset
    picture = np.asarray(Image.open(tmp_path / "a.png"), float).mean(axis=2)
    assert np.corrcoef(np.log(light + 1).ravel(), picture.ravel())[0, 1] > 0.9
    with np.load(tmp_path / "a.npz") as arrays:
        np.testing.assert_array_equal(arrays["depth"], channels["Z"])
        np.testing.assert_array_equal(arrays["ldr"], np.asarray(Image.open(tmp_path / "a.png")))
    assert read_metadata(tmp_path / "a.png")["scene_hash"] == read_metadata(tmp_path / "a.exr")["scene_hash"]


def test_killed_and_resumed(device, tmp_path, capsys):
    """Not stopped politely but killed, in the middle of a film with a moving sun and adapting exposure."""
    film = ["render", "jacksboro", *SMALL, "--frames", "0:24", "--set", "time_scale=300"]
    assert main([*film, "-o", str(tmp_path / "whole.png")]) == 0
    command = [sys.executable, "-m", "fallstreak.cli", *film, "-o", str(tmp_path / "killed.png")]
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    deadline = time.monotonic() + 120
    while (
        not (tmp_path / "killed.0018.png").exists() and time.monotonic() < deadline and process.poll() is None
    ):
        time.sleep(0.002)
    process.send_signal(signal.SIGKILL if os.name == "posix" else signal.SIGTERM)
    process.wait()
    assert main([*film, "-o", str(tmp_path / "killed.png")]) == 0
    assert "of 24 frames are there already" in capsys.readouterr().err
    for index in range(24):
        whole, killed = (tmp_path / f"{name}.{index:04d}.png" for name in ("whole", "killed"))
        assert whole.read_bytes() == killed.read_bytes(), index
    assert sorted(path.suffix for path in tmp_path.iterdir()) == [".png"] * 48
