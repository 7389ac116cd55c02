"""Numbers with their slopes: float64 twin of ``canyons_graded.wesl``.

Automatic differentiation in forward mode (Wengert 1964): what is worked out from graded numbers has its slope
along the map for the price of a few products, where differences would ask for the whole land three times.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Graded:
    """A value at places and its slopes per metre, eastward and northward; arrays of one shape."""

    value: np.ndarray
    east: np.ndarray
    north: np.ndarray

    __array_ufunc__ = None  # an array on the left leaves the sum to this class

    def __add__(self, other):
        if isinstance(other, Graded):
            return Graded(self.value + other.value, self.east + other.east, self.north + other.north)
        return Graded(self.value + other, self.east, self.north)

    __radd__ = __add__

    def __neg__(self):
        return self * -1.0

    def __sub__(self, other):
        return self + -1.0 * other

    def __rsub__(self, other):
        return other + -1.0 * self

    def __mul__(self, other):
        if isinstance(other, Graded):
            return self * other.value + Graded(0.0, self.value * other.east, self.value * other.north)  # type: ignore[arg-type]
        return Graded(self.value * other, self.east * other, self.north * other)

    __rmul__ = __mul__

    @property
    def slope(self) -> np.ndarray:
        """Rise over run along the steepest way."""
        return np.hypot(self.east, self.north)


def constant(value, like: Graded) -> Graded:
    """A number that is the same all around each place."""
    zero = np.zeros_like(like.value)
    return Graded(zero + value, zero, zero)


def ramp(x: Graded, low, high) -> Graded:
    """0 below `low`, 1 above `high`, a cubic between."""
    t = np.clip((x.value - low) / (high - low), 0.0, 1.0)
    rise = 6.0 * t * (1.0 - t) / (high - low)
    return Graded(t * t * (3.0 - 2.0 * t), x.east * rise, x.north * rise)


ROUNDED = 0.14


def edge(x: Graded, half) -> Graded:
    """0 below −`half`, 1 above `half`, straight between but for rounded ends."""
    t = np.clip(0.5 + 0.5 * x.value / half, 0.0, 1.0)
    near = np.minimum(t, 1.0 - t)
    end = np.minimum(near / ROUNDED, 1.0)
    per = 1.0 / (1.0 - ROUNDED)
    low = per * (near - 0.5 * ROUNDED + 0.5 * ROUNDED * (1.0 - end) ** 2)
    rise = per * end * 0.5 / half
    return Graded(np.where(t < 0.5, low, 1.0 - low), x.east * rise, x.north * rise)


def blend(a: Graded, b: Graded, share: Graded) -> Graded:
    """`a` where the share is 0, `b` where it is 1."""
    return a + (b - a) * share


def least(a: Graded, b: Graded, width: float) -> Graded:
    """The smaller of two, rounded where they differ by less than `width` (Quilez's quadratic)."""
    share = np.clip(0.5 + 0.5 * (b.value - a.value) / width, 0.0, 1.0)
    # the derivative by the share is 0, so that the slopes just mix
    return a * share + b * (1.0 - share) - width * share * (1.0 - share)


def size(x: Graded) -> Graded:
    """Without its sign."""
    return x * np.where(x.value < 0.0, -1.0, 1.0)


def rounded_size(x: Graded, width: float) -> Graded:
    """Without its sign, rounded within `width` of zero."""
    root = np.sqrt(x.value**2 + width**2)
    return Graded(root, x.east * x.value / root, x.north * x.value / root)


def away(x: Graded, least_slope: float) -> Graded:
    """Distance (m) from where a number is 0, to first order: over its slope, which is held above a least.

    Its own slope is 1 (less where the least holds): that of the slope is left out.
    """
    per = 1.0 / np.maximum(x.slope, least_slope)
    return x * per
