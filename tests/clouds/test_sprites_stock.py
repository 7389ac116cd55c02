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


def test_more_density_is_more_small_sprites_round_the_same_boxes():
    packed = pack(load(shipped()))
    usual, first = stock(packed)
    dense, first_of_dense = stock(packed, 2.5)
    assert (first_of_dense[:, 2] == 3 * first[:, 2]).all()
    assert (first_of_dense[:, [1, 3]] == first[:, [1, 3]]).all()
    for at, more in zip(first, first_of_dense, strict=True):
        own = usual[at[0] + 1 + at[3] + at[1] :][: at[2]]
        added = dense[more[0] + 1 + more[3] + more[1] :][at[2] : more[2]]
        np.testing.assert_array_equal(added["centre"][:, 2], np.tile(own["centre"][:, 2], 2))
        assert (np.floor(added["share"]) == np.repeat([1, 2], len(own))).all()
