"""The stock of sprites: levels of detail of each model."""

from __future__ import annotations

import numpy as np

from fallstreak.clouds.shapes import SWELL, load, pack, shipped
from fallstreak.clouds.sprites.stock import BOX, FEW, FINE, MOST_PARTS, WHOLE, stock


def test_levels_come_in_order_and_cover_the_model():
    models = load(shipped())
    rows, first = stock(pack(models))
    ends = [*first[1:, 0], len(rows)]
    for model, (at, boxes, fine, few), end in zip(models, first, ends, strict=True):
        own = rows[at:end]
        assert len(own) == 1 + few + boxes + fine and 1 <= few <= MOST_PARTS
        levels = [WHOLE, *[FEW] * few, *[BOX] * boxes, *[FINE] * fine]
        assert own["level"].tolist() == levels
        assert boxes == len(np.unique(model.sprites["box"]))
        # what stands for the cloud from far is about as high and as wide, and lies in it
        for level, low, high in ((WHOLE, 0.75, 1.35), (FEW, 0.85, 1.2)):
            some = own[own["level"] == level]
            top = (some["centre"][:, 2] + some["half"][:, 2]).max()
            assert low < top / model.height < high
            across = (np.hypot(some["centre"][:, 0], some["centre"][:, 1]) + some["half"][:, :2].max(1)).max()
            assert 0.6 < across / model.radius < 1.35
        bodies = own[own["level"] == BOX]
        assert np.isin(bodies["half"][:, 2].round(2), (SWELL * model.boxes["half"][:, 2]).round(2)).all()
