"""The golden comparison itself: it must fail when a picture changes, and say where to look."""

from pathlib import Path

import numpy as np
import pytest
from golden import compare
from PIL import Image


@pytest.fixture
def folders(tmp_path: Path) -> dict[str, Path]:
    return {"golden": tmp_path / "golden", "output": tmp_path / "output"}


@pytest.fixture
def picture() -> np.ndarray:
    ramp = np.linspace(0, 1, 40 * 20 * 3).reshape(20, 40, 3)
    return ramp


def test_the_same_picture_passes_and_float_equals_uint8(folders, picture):
    compare("ramp", picture, update=True, **folders)
    compare("ramp", picture, atol=0, fraction=0, **folders)
    compare("ramp", np.array(Image.open(folders["golden"] / "ramp.png")), atol=0, fraction=0, **folders)
    assert not folders["output"].exists()


def test_a_changed_picture_fails_and_leaves_the_difference(folders, picture):
    compare("ramp", picture, update=True, **folders)
    changed = picture.copy()
    changed[:5] += 10 / 255
    with pytest.raises(pytest.fail.Exception, match=r"24\.\d\d%|25\.00%"):
        compare("ramp", changed, atol=3, fraction=0.2, **folders)
    difference = np.asarray(Image.open(folders["output"] / "ramp.difference.png"))
    assert difference[:4].min() >= 60 and difference[6:].max() == 0
    compare("ramp", changed, atol=3, fraction=0.3, **folders)  # few enough pixels
    compare("ramp", changed, atol=11, fraction=0, **folders)  # small enough differences


def test_a_missing_golden_and_nan_fail(folders, picture):
    with pytest.raises(pytest.fail.Exception, match="--update-golden"):
        compare("new", picture, **folders)
    picture[3, 3] = np.nan
    with pytest.raises(pytest.fail.Exception, match="not finite"):
        compare("new", picture, **folders)
