"""The shipped scenes look as they did when somebody last looked at them.

The golden pictures come from Mesa's software driver, which every machine can run. Where only other hardware
is there, its rounding moves edges and stars by more than the tolerance, so nothing is compared.
"""

from __future__ import annotations

import pytest

import fallstreak as fs

SIZE = (160, 90)


@pytest.mark.parametrize("name", fs.scene_names())
def test_a_shipped_scene_looks_as_it_did(name, device, golden):
    picture = fs.render(fs.load(name), SIZE, "low", samples=4).ldr
    assert picture.std() > 5, "an empty picture"
    if device.adapter.kind != "CPU":
        pytest.skip("the golden pictures are a software adapter's")
    golden(f"scene-{name}", picture, atol=8, fraction=0.02)
