"""Shadows on walls that lean over, of which a height for each place knows only the brim: against rays."""

from __future__ import annotations

import numpy as np
from shadow_stage import Stage

import fallstreak as fs


def test_walls_of_a_canyon_are_dark_where_rays_meet_land(device):
    world = fs.load("canyon").updated({"terrain.vegetation": 0.0})
    stage = Stage(device, world, (160, 90))
    seen, _ = stage.render(stage.camera())
    towards = np.isfinite(seen.places[..., 0]) & (seen.normals @ stage.key > 0.1)
    away = 0.5 * seen.normals[towards] + 2.0 * stage.key  # m, off the surface as it is drawn
    hidden = np.isfinite(world.terrain.ray(seen.places[towards] + away, stage.key, 30e3).distance)
    dark = seen.light[towards] < 0.5
    assert len(dark) > 3000
    assert (dark & hidden).sum() / (dark | hidden).sum() > 0.82
