"""EXR and .npz: named layers in absolute units, read back by the libraries people use."""

import numpy as np
import OpenEXR
import pytest

from fallstreak.output import OutputError, is_whole, read_metadata, save

from .frames import make_frame


def channels(path):
    with OpenEXR.File(str(path), separate_channels=True) as file:
        return dict(file.header()), {name: c.pixels.copy() for name, c in file.channels().items()}


def test_exr_holds_every_layer_unchanged(frame, tmp_path):
    header, found = channels(save(frame, tmp_path / "a.exr"))
    expected = {
        **{n: frame.hdr[..., i] for i, n in enumerate("RGB")},
        "Z": frame.depth,
        **{f"N.{n}": frame.normal[..., i] for i, n in enumerate("XYZ")},
        **{f"albedo.{n}": frame.albedo[..., i] for i, n in enumerate("RGB")},
        **{f"motion.{n}": frame.motion[..., i] for i, n in enumerate("XY")},
    }
    assert set(found) == set(expected)
    for name, pixels in expected.items():
        assert found[name].dtype == np.float32
        np.testing.assert_array_equal(found[name], pixels)
    assert header["whiteLuminance"] == 1.0
    assert header["chromaticities"][0] == pytest.approx(0.64)
    assert header["capDate"] == "2026:05:01 18:30:00" and header["utcOffset"] == 5 * 3600
    assert header["compression"] == OpenEXR.ZIP_COMPRESSION
    assert "cd/m2" in header["comments"]


def test_exr_chosen_layers_only(frame, tmp_path):
    _, found = channels(save(frame, tmp_path / "a.exr", layers=["depth", "hdr"]))
    assert set(found) == {"R", "G", "B", "Z"}
    assert read_metadata(tmp_path / "a.exr")["layers"] == ["hdr", "depth"]


@pytest.mark.parametrize("size", [(1, 1), (3, 16), (5, 17), (64, 33)])
def test_exr_of_any_size_is_seen_as_whole(size, tmp_path):
    frame = make_frame(*size)
    assert is_whole(save(frame, tmp_path / "a.exr"), frame.metadata)


def test_npz_holds_every_layer_unchanged(frame, tmp_path):
    with np.load(save(frame, tmp_path / "a.npz"), allow_pickle=False) as arrays:
        for name in ("hdr", "depth", "normal", "albedo", "motion", "ldr"):
            np.testing.assert_array_equal(arrays[name], getattr(frame, name))
    with np.load(save(frame, tmp_path / "b.npz", layers=["depth"])) as arrays:
        assert set(arrays) == {"depth", "metadata"}


@pytest.mark.parametrize("suffix", [".png", ".exr", ".npz"])
def test_metadata_survives(suffix, frame, tmp_path):
    path = save(frame, tmp_path / f"a{suffix}")
    metadata = read_metadata(path)
    assert metadata["scene"] == "Jacksboro, évening"
    assert metadata["size"] == [70, 50] and metadata["ev100"] == 13.25
    assert is_whole(path, {"seed": 1, "size": (70, 50), "time": "2026-05-01T18:30:00-05:00"})
    assert not is_whole(path, {"seed": 2})
    assert not is_whole(path, {"no such key": 2})
    assert not is_whole(tmp_path / f"missing{suffix}")


@pytest.mark.parametrize("suffix", [".exr", ".npz"])
def test_same_frame_same_bytes(suffix, frame, tmp_path):
    one = save(frame, tmp_path / f"one{suffix}").read_bytes()
    assert one == save(frame, tmp_path / f"two{suffix}").read_bytes()


@pytest.mark.parametrize("suffix", [".exr", ".npz"])
def test_a_damaged_file_is_not_whole(suffix, frame, tmp_path, capfd):
    path = save(frame, tmp_path / f"a{suffix}")
    whole = path.read_bytes()
    for cut in (0, 3, 40, len(whole) // 3, len(whole) // 2, len(whole) - 30, len(whole) - 1):
        path.write_bytes(whole[:cut])
        assert not is_whole(path), cut
    for place in np.random.default_rng(0).integers(len(whole) // 4, len(whole) * 3 // 4, 30):
        broken = bytearray(whole)
        broken[place] ^= 0x10
        path.write_bytes(broken)
        assert not is_whole(path, frame.metadata), place
    assert capfd.readouterr() == ("", "")


def test_a_layer_that_is_missing_or_unknown(frame, tmp_path):
    frame.normal = None
    save(frame, tmp_path / "a.exr")
    assert "N.X" not in channels(tmp_path / "a.exr")[1]
    with pytest.raises(OutputError, match="'normal' was not rendered"):
        save(frame, tmp_path / "b.exr", layers=["normal"])
    with pytest.raises(OutputError, match="no layer 'dpeth'; there are hdr, depth"):
        save(frame, tmp_path / "b.npz", layers=["dpeth"])
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a.exr"]
