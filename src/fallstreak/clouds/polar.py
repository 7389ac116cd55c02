"""Colours between shadow and light in polar coordinates: float64 twin of ``polar.wesl``.

The space is OKLCh (B. Ottosson 2020, "A perceptual color space for image processing"). All colours are linear
Rec. 709 of any scale, (..., 3); chroma is over lightness, so that it does not change with the scale.
"""

from __future__ import annotations

import numpy as np

_CONES = np.array(
    [
        [0.4122214708, 0.5363325363, 0.0514459929],
        [0.2119034982, 0.6806995451, 0.1073969566],
        [0.0883024619, 0.2817188376, 0.6299787005],
    ]
)
_LAB = np.array(
    [
        [0.2104542553, 0.7936177850, -0.0040720468],
        [1.9779984951, -2.4285922050, 0.4505937099],
        [0.0259040371, 0.7827717662, -0.8086757660],
    ]
)
_REC709 = np.array([0.2126, 0.7152, 0.0722])
KEPT = 0.2
"""How far colours go from plain addition to that: all the way, evening clouds are violet."""
_GREEN = 2.48  # radians: no cloud is


def oklch(colour: np.ndarray) -> np.ndarray:
    """Lightness, chroma over lightness, hue in radians."""
    lab = np.cbrt(np.maximum(np.asarray(colour, float) @ _CONES.T, 1e-12)) @ _LAB.T
    chroma = np.hypot(lab[..., 1], lab[..., 2]) / lab[..., 0]
    return np.stack([lab[..., 0], chroma, np.arctan2(lab[..., 2], lab[..., 1])], -1)


def from_oklch(polar: np.ndarray) -> np.ndarray:
    """The colour of `oklch`'s coordinates."""
    lightness, chroma, hue = np.moveaxis(np.asarray(polar, float), -1, 0)
    lab = lightness[..., None] * np.stack(
        [np.ones_like(hue), chroma * np.cos(hue), chroma * np.sin(hue)], axis=-1
    )
    return (lab @ np.linalg.inv(_LAB).T) ** 3 @ np.linalg.inv(_CONES).T


def blended(shadow: np.ndarray, full: np.ndarray, share: np.ndarray) -> np.ndarray:
    """What a share of the light adds to a shadow, in the colours between those of shadow and full light.

    Luminance is that of the plain sum; chroma and hue go from the shadow's to the light's as lightness does,
    hues that are far apart never by way of green.
    """
    shadow, full = np.asarray(shadow, float), np.asarray(full, float)
    plain = shadow + np.asarray(share, float)[..., None] * (full - shadow)
    dark, bright = oklch(shadow), oklch(full)
    own = oklch(plain)[..., 0]
    part = np.clip((own - dark[..., 0]) / np.maximum(bright[..., 0] - dark[..., 0], 1e-6), 0.0, 1.0)
    turn = _wrapped(bright[..., 2] - dark[..., 2])
    green = _wrapped(_GREEN - dark[..., 2])
    through = (np.abs(turn) > np.pi / 2) & (green * turn > 0.0) & (np.abs(green) < np.abs(turn))
    turn = np.where(through, turn - 2.0 * np.pi * np.sign(turn), turn)
    chroma = dark[..., 1] + part * (bright[..., 1] - dark[..., 1])
    # what has little colour has little to say of the hue
    around = turn * part * bright[..., 1] / np.maximum(chroma, 1e-6)
    mixed = np.maximum(from_oklch(np.stack([own, chroma, dark[..., 2] + around], -1)), 0.0)
    mixed *= ((plain @ _REC709) / np.maximum(mixed @ _REC709, 1e-12))[..., None]
    return plain + KEPT * (mixed - plain)


def _wrapped(angle: np.ndarray) -> np.ndarray:
    return angle - 2.0 * np.pi * np.round(angle / (2.0 * np.pi))
