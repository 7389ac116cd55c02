"""Golden pictures: small PNGs that a test's picture must resemble, and a difference image when it does not.

Software Vulkan drivers of different versions round differently, so a comparison states two tolerances: by how
many 8-bit levels a channel may differ (``atol``), and what fraction of the pixels may differ by more.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

GOLDEN = Path(__file__).parent / "golden"
AMPLIFICATION = 8  # of the difference image: one level of 255 is invisible


def compare(
    name: str,
    picture: np.ndarray,
    *,
    atol: float = 3,
    fraction: float = 0.002,
    update: bool = False,
    golden: Path = GOLDEN,
    output: Path,
) -> None:
    """Fail the test unless `picture` resembles ``golden/NAME.png``.

    Parameters
    ----------
    picture
        ``(height, width, 3 or 4)``, uint8, or float in 0..1. A fourth channel is ignored.
    atol
        How many 8-bit levels a channel may differ.
    fraction
        The fraction of pixels that may differ by more than `atol`.
    update
        Write the golden picture instead of comparing.
    output
        Where ``NAME.actual.png`` and ``NAME.difference.png`` (amplified) go on failure.
    """
    actual = _levels(picture)
    path = golden / f"{name}.png"
    if update:
        path.parent.mkdir(parents=True, exist_ok=True)
        Image.fromarray(actual).save(path, optimize=True)
        return
    if not path.exists():
        _save(output, name, actual, None)
        pytest.fail(
            f"{path.name} does not exist yet; look at {output / name}.actual.png, then --update-golden",
            pytrace=False,
        )
    expected = np.asarray(Image.open(path).convert("RGB"))
    if expected.shape != actual.shape:
        _save(output, name, actual, None)
        pytest.fail(f"{path.name} has shape {expected.shape}, the picture {actual.shape}", pytrace=False)
    difference = np.abs(expected.astype(np.int16) - actual.astype(np.int16))
    outside = float((difference.max(axis=-1) > atol).mean())
    if outside > fraction:
        _save(output, name, actual, difference)
        pytest.fail(
            f"{path.name}: {outside:.2%} of the pixels differ by more than {atol:g} levels "
            f"(allowed {fraction:.2%}; largest {difference.max()}, mean {difference.mean():.2f}); "
            f"see {output / name}.difference.png",
            pytrace=False,
        )


def _levels(picture: np.ndarray) -> np.ndarray:
    picture = np.asarray(picture)[..., :3]
    if picture.dtype == np.uint8:
        return np.ascontiguousarray(picture)
    if not np.isfinite(picture).all():
        pytest.fail("the picture holds values that are not finite", pytrace=False)
    return (np.clip(picture, 0, 1) * 255 + 0.5).astype(np.uint8)


def _save(output: Path, name: str, actual: np.ndarray, difference: np.ndarray | None) -> None:
    stem = output / name
    stem.parent.mkdir(parents=True, exist_ok=True)
    Image.fromarray(actual).save(stem.with_name(stem.name + ".actual.png"))
    if difference is not None:
        amplified = np.clip(difference * AMPLIFICATION, 0, 255).astype(np.uint8)
        Image.fromarray(amplified).save(stem.with_name(stem.name + ".difference.png"))
