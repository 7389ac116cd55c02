"""What slopes a texel holds: float64 twin of ``steepness.wesl``."""

from __future__ import annotations

import numpy as np


def slopes_within(normal: np.ndarray, slope: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Mean of the slopes (rise over run) in a texel, and their variance.

    They are the texel's own slope plus one of any direction that it is too coarse to show. Of the hidden mean
    square 0.785 belongs to the mean where the texel is level (Rayleigh distribution), 0.5 where it is steep;
    0.6 and the rest stand for both.

    Parameters
    ----------
    normal : (…, 3), the texel's
    slope : (…), root mean square of all that it holds
    """
    held = np.hypot(normal[..., 0], normal[..., 1]) / np.maximum(normal[..., 2], 0.05)
    hidden = np.maximum(slope**2 - held**2, 0.0)
    return np.sqrt(held**2 + 0.6 * hidden), 0.35 * hidden
