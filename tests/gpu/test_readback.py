"""Pictures come back whole, also when no single buffer may hold them."""

import numpy as np
import pytest

from fallstreak.gpu.readback import Readback, Stacked


@pytest.mark.parametrize(("format", "shape"), [("r32float", (37, 70)), ("rgba16float", (37, 70, 4))])
def test_a_large_texture_comes_back_in_bands(format, shape, device, monkeypatch):
    pixels = np.random.default_rng(2).uniform(size=shape).astype("f4" if format == "r32float" else "f2")
    texture = device.texture("test", format, (70, 37, 1), 0x01 | 0x02 | 0x04)
    device.queue.write_texture(
        {"texture": texture},
        pixels.tobytes(),
        {"bytes_per_row": pixels.nbytes // 37, "rows_per_image": 37},
        (70, 37, 1),
    )
    readback = Readback(device)
    whole = readback.now(readback.texture(texture, format, (70, 37, 1))).result()
    np.testing.assert_array_equal(whole, pixels)
    monkeypatch.setitem(device.limits, "max-buffer-size", 10_000)
    pending = readback.texture(texture, format, (70, 37, 1))
    assert isinstance(pending, Stacked)
    np.testing.assert_array_equal(readback.now(pending).result(), pixels)
