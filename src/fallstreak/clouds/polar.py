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
MOST = 1.35
"""So much more saturated than the plain sum at most: where shadow and light just cancel grey remains."""


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
    """What a share of the light adds to a shadow, as saturated as the two.

    Luminance and hue are those of the plain sum; chroma goes from the shadow's to the
    light's as lightness does.
    """
    shadow, full = np.asarray(shadow, float), np.asarray(full, float)
    plain = shadow + np.asarray(share, float)[..., None] * (full - shadow)
    dark, bright, own = oklch(shadow), oklch(full), oklch(plain)
    part = np.clip((own[..., 0] - dark[..., 0]) / np.maximum(bright[..., 0] - dark[..., 0], 1e-6), 0.0, 1.0)
    chroma = dark[..., 1] + part * (bright[..., 1] - dark[..., 1])
    own[..., 1] *= np.clip(chroma / np.maximum(own[..., 1], 1e-6), 1.0, MOST)
    mixed = np.maximum(from_oklch(own), 0.0)
    return mixed * ((plain @ _REC709) / np.maximum(mixed @ _REC709, 1e-12))[..., None]
