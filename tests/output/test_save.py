"""Writing fails in one sentence and leaves nothing behind."""

import os
import subprocess
import sys
import textwrap

import pytest

from fallstreak.output import OutputError, save
from fallstreak.output.atomic import remove_leftovers, replacing
from fallstreak.world.errors import UserError

SUFFIXES = [".png", ".exr", ".npz"]


@pytest.mark.parametrize("name", ["a.jpg", "a", "a.tar.gz", ".png"])
def test_unknown_suffix_lists_the_known(name, frame, tmp_path):
    with pytest.raises(UserError, match=r"there are \.png .*\.exr .*\.npz"):
        save(frame, tmp_path / name)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_upper_case_suffix(suffix, frame, tmp_path):
    assert save(frame, tmp_path / f"a{suffix.upper()}").is_file()


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_missing_folder(suffix, frame, tmp_path):
    with pytest.raises(OutputError, match="the folder does not exist"):
        save(frame, tmp_path / "no" / f"a{suffix}")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_a_folder_of_that_name(suffix, frame, tmp_path):
    (tmp_path / f"a{suffix}").mkdir()
    with pytest.raises(OutputError, match="there is a folder of that name"):
        save(frame, tmp_path / f"a{suffix}")
    assert [p.name for p in tmp_path.iterdir()] == [f"a{suffix}"]


@pytest.mark.parametrize("suffix", SUFFIXES)
@pytest.mark.skipif(os.name != "posix", reason="file size limits are POSIX")
def test_a_full_disk_leaves_the_old_file(suffix, frame, tmp_path):
    """A limit on the file size stands for the full disk: the write stops in the middle."""
    path = save(frame, tmp_path / f"a{suffix}")
    before = path.read_bytes()
    script = f"""
        import resource, signal
        from tests.output.frames import make_frame
        from fallstreak.output import OutputError, save
        frame = make_frame(300, 200, seed=2)
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))
        try:
            save(frame, {str(path)!r})
        except OutputError as error:
            print("refused:", error)
    """
    result = subprocess.run(
        [sys.executable, "-B", "-c", textwrap.dedent(script)],
        capture_output=True,
        text=True,
        cwd=os.getcwd(),
        check=False,
    )
    assert result.stdout.startswith("refused: cannot write"), result.stderr
    assert result.stdout.count("\n") == 1
    assert path.read_bytes() == before
    assert [p.name for p in tmp_path.iterdir()] == [path.name]


def test_an_interrupted_write_leaves_nothing(tmp_path):
    with pytest.raises(KeyboardInterrupt), replacing(tmp_path / "a.png") as beside:
        beside.write_bytes(b"half")
        raise KeyboardInterrupt
    assert list(tmp_path.iterdir()) == []


def test_16_bits_need_a_16_bit_frame(frame, tmp_path):
    frame.ldr16 = None
    with pytest.raises(OutputError, match="16 bits"):
        save(frame, tmp_path / "a.png", bits=16)
    with pytest.raises(OutputError, match="8 or 16 bits per channel, not 12"):
        save(frame, tmp_path / "a.png", bits=12)


def test_parts_of_the_dead_are_removed(tmp_path):
    dead = subprocess.run(
        [sys.executable, "-c", "import os; print(os.getpid())"], capture_output=True, text=True
    )
    for pid in (int(dead.stdout), os.getpid()):
        (tmp_path / f".a[1].png.{pid}-77.part").write_bytes(b"half")
    (tmp_path / f".b.png.{int(dead.stdout)}-77.part").write_bytes(b"somebody else's")
    remove_leftovers(tmp_path, {"a[1].png"})
    left = [f".a[1].png.{os.getpid()}-77.part", f".b.png.{int(dead.stdout)}-77.part"]
    assert sorted(p.name for p in tmp_path.iterdir()) == left
