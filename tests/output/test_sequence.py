"""Sequences: numbered, resumable, byte-identical, without a GPU.

The fake renderer looks back like the real one: every frame depends on all frames before it.
"""

from pathlib import Path

import numpy as np
import pytest

from fallstreak.output import OutputError
from fallstreak.output.checkpoints import Checkpoints
from fallstreak.output.naming import FrameNames, is_pattern
from fallstreak.output.sequence import Target, missing_frames, render_sequence

from .frames import Frame

FACTS = {"scene": "test", "seed": 7, "size": (9, 6), "version": "0.1.0"}


class FakeRenderer:
    """History in every pixel; counts what it is asked to do."""

    def __init__(self):
        self.history = np.zeros((6, 9, 3), np.uint8)
        self.index = None
        self.submitted = []
        self.restored = []
        self.waiting = 0

    def submit(self, index):
        assert self.index is None or index == self.index + 1
        self.waiting += 1
        assert self.waiting <= 2
        self.history = (self.history.astype(np.int64) * 5 + index + np.arange(9)[:, None]).astype(np.uint8)
        self.index = index
        self.submitted.append(index)
        return Pending(self, index, self.history)

    def checkpoint(self):
        return {"history": self.history.copy(), "index": self.index.to_bytes(4, "little")}

    def restore(self, checkpoint):
        assert self.waiting == 0
        self.history = checkpoint["history"]
        self.index = int.from_bytes(checkpoint["index"], "little")
        self.restored.append(self.index)


class Pending:
    def __init__(self, renderer, index, pixels):
        self.renderer, self.index, self.pixels = renderer, index, pixels

    def result(self):
        self.renderer.waiting -= 1
        return Frame(hdr=self.pixels.astype(np.float32), ldr=self.pixels, metadata={"ev100": 12.5})


def expected(index):
    return {**FACTS, "frame": index, "time": f"2026-05-01T18:30:{index:02d}+00:00"}


def targets(folder: Path):
    return [Target(FrameNames(folder / "a.png")), Target(FrameNames(folder / "a-##.exr"), layers=("hdr",))]


def run(folder, frames=range(0, 40), *, until=None, **options):
    folder.mkdir(exist_ok=True)
    renderer = FakeRenderer()
    stop = (lambda: len(renderer.submitted) >= until) if until is not None else (lambda: False)
    progress = render_sequence(renderer, targets(folder), frames, expected, stop=stop, **options)
    return progress, renderer


def contents(folder):
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}


@pytest.fixture(scope="module")
def reference(tmp_path_factory):
    folder = tmp_path_factory.mktemp("reference")
    progress, renderer = run(folder)
    assert renderer.submitted == list(range(40))
    assert (progress.done, progress.rendered, progress.found, progress.interrupted) == (40, 40, 0, False)
    return contents(folder)


def test_an_uninterrupted_sequence(reference):
    assert len(reference) == 80
    assert "a.0000.png" in reference and "a-39.exr" in reference


@pytest.mark.parametrize("until", [0, 1, 15, 16, 17, 37])
def test_interrupted_and_resumed(until, reference, tmp_path):
    progress, _ = run(tmp_path, until=until)
    assert progress.interrupted and progress.rendered == until
    assert len(contents(tmp_path)) == 2 * until
    progress, renderer = run(tmp_path)
    assert progress.rendered == 40 - until and progress.found == until
    assert renderer.submitted == list(range(until, 40))  # the state at the interruption was kept
    assert contents(tmp_path) == reference
    assert not (tmp_path / ".fallstreak").exists()


def test_killed_and_resumed(reference, tmp_path):
    """A killed process keeps no state of the last moment, and the newest pictures may be missing."""

    def crash(progress, frame):
        if progress.last == 36:
            raise MemoryError

    with pytest.raises(MemoryError):
        run(tmp_path, on_frame=crash)
    for index in (30, 34, 35, 36):
        (tmp_path / f"a.{index:04d}.png").unlink(missing_ok=True)
    (tmp_path / "a.0033.png").write_bytes(reference["a.0033.png"][:-9])
    _, renderer = run(tmp_path)
    assert renderer.restored == [15, 31]
    assert renderer.submitted == [*range(16, 31), *range(32, 40)]
    assert contents(tmp_path) == reference


def test_a_damaged_checkpoint_is_passed_over(reference, tmp_path):
    run(tmp_path, until=33)
    states = sorted((tmp_path / ".fallstreak").iterdir())
    assert [path.name for path in states] == ["a.0031.npz", "a.0032.npz"]
    for path in states:
        data = bytearray(path.read_bytes())
        middle = len(data) // 2
        data[middle - 150 : middle + 150] = bytes(300)
        path.write_bytes(data)
    _, renderer = run(tmp_path)
    assert renderer.restored == [] and renderer.submitted == list(range(40))
    assert contents(tmp_path) == reference


@pytest.mark.parametrize("order", [(15, 31, 32), (15, 32, 31), (32, 31, 15)])
def test_states_are_forgotten_whichever_thread_writes_first(order, tmp_path):
    """Also those of a run that had come further stay: a frame may have been missing before them."""
    Checkpoints(tmp_path, "a", FACTS).save(50, {"history": np.zeros(3)})
    checkpoints = Checkpoints(tmp_path, "a", FACTS)
    for index in order:
        checkpoints.save(index, {"history": np.zeros(3)})
    assert checkpoints.indices() == [31, 32, 50]


def test_a_missing_frame_in_the_middle(reference, tmp_path):
    run(tmp_path)
    (tmp_path / "a-05.exr").unlink()
    progress, renderer = run(tmp_path)
    assert renderer.submitted == list(range(6))
    assert (progress.rendered, progress.replayed, progress.found) == (1, 5, 39)
    assert contents(tmp_path) == reference


def test_a_complete_sequence_renders_nothing(reference, tmp_path):
    run(tmp_path)
    _, renderer = run(tmp_path)
    assert renderer.submitted == []
    assert contents(tmp_path) == reference


def test_a_state_of_another_sequence_is_not_used(reference, tmp_path, monkeypatch):
    monkeypatch.setitem(FACTS, "seed", 8)
    run(tmp_path, until=37)
    monkeypatch.setitem(FACTS, "seed", 7)
    progress, renderer = run(tmp_path, until=20)
    assert progress.found == 0 and renderer.restored == []
    _, renderer = run(tmp_path)
    assert renderer.restored == [19]
    assert contents(tmp_path) == reference


def test_a_sequence_may_start_anywhere_and_be_extended(tmp_path):
    run(tmp_path, range(10, 14))
    progress, renderer = run(tmp_path, range(10, 20))
    assert progress.found == 4 and renderer.submitted == list(range(10, 20))


def test_a_failed_write_stops_in_one_sentence(tmp_path):
    (tmp_path / "a.0012.png").mkdir()
    with pytest.raises(OutputError, match="there is a folder of that name"):
        run(tmp_path)
    assert not [path for path in tmp_path.iterdir() if path.name.endswith(".part")]


def test_what_is_missing_is_told_without_a_renderer(tmp_path):
    run(tmp_path, until=3)
    assert missing_frames(targets(tmp_path), range(0, 6), expected) == [3, 4, 5]
    twelve = [Target(FrameNames(tmp_path / "a.png"), bits=16)]
    assert missing_frames(twelve, range(0, 2), expected) == [0, 1]


@pytest.mark.parametrize(
    ("pattern", "name"),
    [
        ("evening.png", "evening.0007.png"),
        ("evening.####.png", "evening.0007.png"),
        ("evening_##.exr", "evening_07.exr"),
        ("evening{frame}.npz", "evening0007.npz"),
        ("{frame:06d}.png", "000007.png"),
        ("take#1.png", "take#1.0007.png"),
        ("a.b.png", "a.b.0007.png"),
        ("{other}.png", "{other}.0007.png"),
    ],
)
def test_names(pattern, name):
    assert FrameNames(f"out/{pattern}").path(7) == Path("out") / name
    assert is_pattern(pattern) == (".0007" not in name or "####" in pattern)


def test_titles():
    titles = {
        p: FrameNames(p).title for p in ("evening.png", "evening.####.png", "{frame}.png", "a-##-b.exr")
    }
    assert titles == {
        "evening.png": "evening",
        "evening.####.png": "evening",
        "{frame}.png": "sequence",
        "a-##-b.exr": "a--b",
    }


def test_two_places_for_the_number():
    with pytest.raises(OutputError, match="2 places"):
        FrameNames("a.##.##.png")


def test_unknown_suffix():
    with pytest.raises(OutputError, match=r"'\.mp4' is unknown"):
        Target(FrameNames("a.####.mp4"))
