"""Maps and the sphere."""

from __future__ import annotations

import numpy as np
import pytest

from fallstreak.terrain import projection
from fallstreak.world.state import position_on_planet

R = 6.36e6


def test_geographic_and_back():
    rng = np.random.default_rng(1)
    e, n = rng.uniform(-3e5, 3e5, (2, 200))
    for place in ((36.6, -84.2), (0.0, 179.9), (-70.0, 10.0), (89.9, 0.0)):
        back = projection.map_from_geographic(*projection.geographic_from_map(e, n, place, R), place, R)
        assert np.abs(back - np.stack([e, n])).max() < 1e-6


def test_map_is_azimuthal_equidistant():
    e, n = projection.map_from_geographic(37.6, -84.2, (36.6, -84.2), R)
    assert (float(e), float(n)) == pytest.approx((0.0, R * np.pi / 180), abs=1e-6)


def test_world_positions_agree_with_the_camera_s():
    for e, n, h in ((0, 0, 100), (1e5, -3e4, 2000), (-5.0, 2.0, 0.0), (1e6, 1e6, 4e5)):
        assert projection.world_from_map(e, n, h, R) == pytest.approx(
            position_on_planet(e, n, h, R), abs=1e-6
        )
        back = projection.map_from_world(projection.world_from_map(e, n, h, R), R)
        assert [float(b) for b in back] == pytest.approx([e, n, h], abs=1e-6)


def test_ground_drops_by_half_the_square_over_the_radius():
    for d in (1e3, 50e3, 160e3):
        x, _, z = projection.world_from_map(d, 0.0, 0.0, R)
        assert float(z) == pytest.approx(-d * d / (2 * R), rel=2e-4)
        assert np.hypot(x, R + z) == pytest.approx(R, abs=1e-6)
    assert -float(projection.world_from_map(50e3, 0, 0, R)[2]) == pytest.approx(196.5, abs=0.1)


def test_utm_against_published_points():
    # the meridian arc from the equator to 45° N on WGS84 is 4984944.378 m; UTM scales it by 0.9996
    assert projection.utm_from_geographic(45.0, 9.0, 32, False) == pytest.approx(
        (500000.0, 4984944.378 * 0.9996), abs=1e-3
    )
    rng = np.random.default_rng(2)
    e, n = rng.uniform(2e5, 8e5, 100), rng.uniform(1e5, 9e6, 100)
    back = projection.utm_from_geographic(*projection.geographic_from_utm(e, n, 17, False), 17, False)
    assert np.abs(np.stack(back) - np.stack([e, n])).max() < 1e-3
