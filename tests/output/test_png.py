"""PNG: what Pillow and the eye of the specification read is what went in."""

import io
import zlib

import numpy as np
import pytest
from PIL import Image

from fallstreak.output import is_whole, read_metadata, save
from fallstreak.output.png import encode_png, read_png_text, write_png


def encoded(pixels, text=None):
    file = io.BytesIO()
    encode_png(file, pixels, text or {})
    return file.getvalue()


@pytest.mark.parametrize(
    "shape", [(1, 1, 3), (7, 5, 3), (65, 3, 3), (130, 33, 3), (9, 4), (9, 4, 1), (9, 4, 2), (9, 4, 4)]
)
def test_8_bit_reads_back_in_pillow(shape):
    rng = np.random.default_rng(3)
    pixels = np.cumsum(rng.integers(-3, 4, shape), axis=0).astype(np.uint8)
    back = np.asarray(Image.open(io.BytesIO(encoded(pixels))))
    np.testing.assert_array_equal(back, pixels.squeeze(-1) if pixels.shape[2:] == (1,) else pixels)


def unfilter(data, height, stride, step):
    """The five filters undone, byte by byte, from the text of the specification."""
    out = np.zeros((height, stride), np.int64)
    raw = np.frombuffer(data, np.uint8).reshape(height, stride + 1)
    for y in range(height):
        for x in range(stride):
            a = out[y, x - step] if x >= step else 0
            b = out[y - 1, x] if y else 0
            c = out[y - 1, x - step] if y and x >= step else 0
            p = a + b - c
            nearest = min((abs(p - a), 0, a), (abs(p - b), 1, b), (abs(p - c), 2, c))[2]
            out[y, x] = (int(raw[y, x + 1]) + (0, a, b, (a + b) // 2, nearest)[raw[y, 0]]) % 256
    return out.astype(np.uint8), set(raw[:, 0].tolist())


def test_16_bit_reads_back_by_the_specification():
    y, x = np.mgrid[0:70, 0:11]
    rng = np.random.default_rng(5)
    pixels = np.stack([y * 700 + x * 13, y * x * 31, rng.integers(0, 65536, y.shape)], axis=2).astype(
        np.uint16
    )
    pixels[30:36] = rng.integers(0, 65536, (6, 11, 3))
    file = encoded(pixels)
    assert file[24:26] == b"\x10\x02"  # 16 bits, colour
    start, data = 8, b""
    while start < len(file):
        length = int.from_bytes(file[start : start + 4], "big")
        if file[start + 4 : start + 8] == b"IDAT":
            data += file[start + 8 : start + 8 + length]
        start += 12 + length
    rows, filters = unfilter(zlib.decompress(data), 70, 66, 6)
    np.testing.assert_array_equal(rows.view(">u2").reshape(70, 11, 3), pixels)
    assert len(filters) > 1


def test_filters_earn_their_keep():
    y, x = np.mgrid[0:256, 0:256]
    smooth = np.stack([y, x, (x + y) // 2], axis=2).astype(np.uint8)
    assert len(encoded(smooth)) < 0.05 * smooth.size


def test_colour_space_is_said():
    file = encoded(np.zeros((2, 2, 3), np.uint8))
    for kind in (b"cICP", b"sRGB", b"gAMA", b"cHRM"):
        assert 0 < file.index(kind) < file.index(b"IDAT")
    assert Image.open(io.BytesIO(file)).info["srgb"] == 0


def test_text_survives(tmp_path):
    text = {"Title": "Föhn über dem Tal ☁", "fallstreak": '{"a": 1}'}
    write_png(tmp_path / "a.png", np.zeros((2, 2, 3), np.uint8), text)
    assert read_png_text(tmp_path / "a.png") == text
    assert Image.open(tmp_path / "a.png").text == text


def test_same_frame_same_bytes(frame, tmp_path):
    one = save(frame, tmp_path / "one.png").read_bytes()
    assert one == save(frame, tmp_path / "two.png").read_bytes()


def test_wrong_pixels_are_refused():
    for pixels in (
        np.zeros((4, 4, 3), np.float32),
        np.zeros((4, 4, 5), np.uint8),
        np.zeros((0, 4, 3), np.uint8),
    ):
        with pytest.raises(ValueError):
            encoded(pixels)


def test_a_damaged_file_is_not_whole(frame, tmp_path):
    path = save(frame, tmp_path / "a.png", bits=16)
    assert read_metadata(path)["bits"] == 16
    assert is_whole(path)
    whole = path.read_bytes()
    rng = np.random.default_rng(0)
    cuts = [0, 5, 30, len(whole) // 2, len(whole) - 12, len(whole) - 1]
    for cut in cuts:
        path.write_bytes(whole[:cut])
        assert not is_whole(path), cut
    for place in rng.integers(0, len(whole), 50):
        broken = bytearray(whole)
        broken[place] ^= 0x10
        path.write_bytes(broken)
        assert not is_whole(path), place
