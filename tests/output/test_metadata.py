"""What identifies a world and a frame."""

import numpy as np

import fallstreak as fs
from fallstreak.output.metadata import canonical, describes, world_digest


def test_one_spelling():
    one = canonical({"b": (1, 2.5), "a": np.float32(0.5), "c": {"x": np.arange(2)}, "d": None, "e": True})
    assert one == '{"a": 0.5, "b": [1, 2.5], "c": {"x": [0, 1]}, "d": null, "e": true}'
    assert canonical({"a": float("nan"), "b": np.float32("inf")}) == '{"a": null, "b": null}'


def test_describes():
    assert describes({"a": [1, 2], "b": 3.0}, {"a": (1, 2)})
    assert not describes({"a": [1, 2]}, {"a": (1, 2), "b": None})


def test_a_digest_differs_when_anything_differs():
    world = fs.load("jacksboro")
    changes = (
        {"sky.turbidity": 2.5},
        {"camera.keyframes": [{"at": 0, "east": 5}]},
        {"seed": 1},
        {"film.ev100": 3},
    )
    digests = {world_digest(world), *(world_digest(world.updated(change)) for change in changes)}
    assert len(digests) == 1 + len(changes)
    assert world_digest(fs.load("jacksboro")) in digests


def test_of_an_elevation_file_the_contents_count(tmp_path):
    digests = []
    for name, value in (("a.npz", 1.0), ("b.npz", 1.0), ("c.npz", 2.0)):
        np.savez(tmp_path / name, elevation=np.full((4, 4), value))
        world = fs.load("jacksboro", {"terrain.source": "file", "terrain.file": str(tmp_path / name)})
        digests.append(world_digest(world))
    assert digests[0] == digests[1] != digests[2]


def test_the_frame_and_the_files_know_the_same_layers():
    from fallstreak.frame.frame import LAYERS as rendered
    from fallstreak.output import LAYERS as written

    assert tuple(rendered) == tuple(written)
