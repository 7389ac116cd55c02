"""Colours of artists: what the hours make of a model's."""

from __future__ import annotations

import numpy as np
import pytest

from fallstreak.clouds.shapes import load
from fallstreak.clouds.sprites.artist import ROWS, hours, paint


def test_hours_go_round_and_add_up():
    for height in np.linspace(-1.0, 1.0, 41):
        for east in (-1.0, -0.1, 0.0, 0.2, 1.0):
            weights = hours(height, east)
            assert sum(weights.values()) == pytest.approx(1.0) and min(weights.values()) >= 0.0
    assert hours(1.0, 0.0)["noon"] == 1.0
    assert hours(0.0, 0.9)["dawn"] == hours(0.0, -0.9)["sunset"] == 1.0
    assert hours(-0.5, 0.3)["night"] == 1.0


def test_colours_change_without_steps():
    models = load(["cumulus_congestus_a"])
    turns = np.linspace(0.0, 2.0 * np.pi, 721)
    tables = np.array([paint(models, np.sin(t) * 0.9, np.cos(t)) for t in turns])
    assert np.abs(np.diff(tables, axis=0)).max() < 0.05


def test_the_table_is_the_models_own_at_an_hour_of_its_own():
    (model,) = load(["cumulus_congestus_a"])
    (rows,) = paint([model], 0.0, -1.0)
    assert rows.shape == (ROWS, 4)
    sunset = model.colours.sunset
    levels = np.array(model.colours.levels)
    assert rows[:5, :3] == pytest.approx(levels[:, 1:4] * sunset.ambient / 100.0)
    assert rows[6] == pytest.approx([*sunset.directional, sunset.least / 100.0])
    assert rows[7, 0] == pytest.approx(sunset.most / 100.0)
