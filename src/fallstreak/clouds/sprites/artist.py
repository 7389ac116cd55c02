"""Colours as artists gave them (Wang 2004): of the cloud models, at the hour that it is.

A vertex has the ambient colour of its height, five levels from the base to the top times a percentage of the
hour, and a directional colour times a percentage between the hour's least and most: by the cosine between the
ways from its shading group's centre to the vertex and to the light. `artist.wesl` does that per vertex; here
is what it reads.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..shapes import CloudModel

ROWS = 8
"""vec4f of a model: five levels (red, green, blue, height), their opacities, directional colour and least
percentage, most percentage and the last level's opacity."""

_HORIZON, _HIGH, _NIGHT = 0.0, np.sin(np.radians(40.0)), np.sin(np.radians(-10.0))
_TURN = 0.3  # the sun's eastward part beyond which it is morning, or evening, altogether


def hours(height: float, east: float) -> dict[str, float]:
    """How much each of the four hours counts; the sum is 1.

    Parameters
    ----------
    height : float
        Sine of the sun's elevation.
    east : float
        Eastward part of the unit vector towards it.
    """
    noon = float(np.clip((height - _HORIZON) / (_HIGH - _HORIZON), 0.0, 1.0))
    night = float(np.clip((height - _HORIZON) / (_NIGHT - _HORIZON), 0.0, 1.0))
    low = 1.0 - noon - night
    morning = 0.5 + 0.5 * float(np.clip(east / _TURN, -1.0, 1.0))
    return {"dawn": low * morning, "noon": noon, "sunset": low * (1.0 - morning), "night": night}


def paint(models: Sequence[CloudModel], height: float, east: float) -> np.ndarray:
    """What artist.wesl reads, (models, ROWS, 4) float32; `height` and `east` as for `hours`."""
    weights = hours(height, east)
    table = np.zeros((len(models), ROWS, 4), np.float32)
    for rows, model in zip(table, models, strict=True):
        levels = np.array(model.colours.levels)
        told = {name: getattr(model.colours, name) for name in weights}

        def mean(key: str, told: dict = told) -> np.ndarray:
            return np.sum(
                [weights[name] * np.asarray(getattr(hour, key), float) for name, hour in told.items()], 0
            )

        rows[:5, :3] = levels[:, 1:4] * mean("ambient") / 100.0
        rows[:5, 3] = levels[:, 0]
        rows[5] = levels[:4, 4]
        rows[6] = (*mean("directional"), mean("least") / 100.0)
        rows[7, :2] = mean("most") / 100.0, levels[4, 4]
    return table
