"""The colour of glowing bodies and of stars in linear Rec. 709, at luminance 1."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

_XYZ_TO_REC709 = np.array(
    [
        [3.2404542, -1.5371385, -0.4985314],
        [-0.9692660, 1.8760108, 0.0415560],
        [0.0556434, -0.2040259, 1.0572252],
    ]
)


def temperature_colour(kelvin: ArrayLike) -> NDArray[np.float64]:
    """Colour of a black body, shape (..., 3), scaled to luminance 1.

    Chromaticity by the cubics of Kim et al. 2002 (US patent 7024034), good to 1e-3 in x and y between 1667
    and 25000 K; temperatures beyond are held at those ends. Colours outside Rec. 709 (the reddest stars)
    are brought in by mixing in white.
    """
    t = 1e3 / np.clip(np.asarray(kelvin, float), 1667.0, 25000.0)
    warm = -0.2661239 * t**3 - 0.2343589 * t**2 + 0.8776956 * t + 0.179910
    cool = -3.0258469 * t**3 + 2.1070379 * t**2 + 0.2226347 * t + 0.240390
    x = np.where(t > 0.25, warm, cool)
    reddish = -1.1063814 * x**3 - 1.34811020 * x**2 + 2.18555832 * x - 0.20219683
    yellow = -0.9549476 * x**3 - 1.37418593 * x**2 + 2.09137015 * x - 0.16748867
    bluish = 3.0817580 * x**3 - 5.87338670 * x**2 + 3.75112997 * x - 0.37001483
    y = np.select([t > 1e3 / 2222.0, t > 0.25], [reddish, yellow], bluish)
    xyz = np.stack([x / y, np.ones_like(x), (1 - x - y) / y], axis=-1)
    rgb = xyz @ _XYZ_TO_REC709.T
    least = np.minimum(rgb.min(axis=-1, keepdims=True), 0.0)
    return (rgb - least) / (1.0 - least)


def star_temperature(colour_index: ArrayLike) -> NDArray[np.float64]:
    """Temperature in kelvin of a star of colour index B-V (Ballesteros, EPL 97 (2012) 34008)."""
    bv = np.clip(np.asarray(colour_index, float), -0.4, 2.5)
    return 4600.0 * (1.0 / (0.92 * bv + 1.7) + 1.0 / (0.92 * bv + 0.62))
