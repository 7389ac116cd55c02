"""All sprites of a world's cloud models, as the GPU chooses among them: four levels of detail of each model.

The coarsest is one sprite that stands for a whole cloud, then a few that stand for several boxes each, then
those that stand for a box each, then the small ones that lie about under the boxes' surfaces.
"""

from __future__ import annotations

from math import ceil

import numpy as np

from ..shapes import SWELL
from ..shapes.pack import Packed

WHOLE, BOX, FINE, FEW = 0, 1, 2, 3
"""Levels of detail."""

NO_BOX = 255
MOST_PARTS = 5

STOCK = np.dtype(
    [
        ("centre", "<f4", 3),
        ("level", "<u4"),
        ("half", "<f4", 3),
        ("widening", "<f4"),
        ("turn", "<f4", 2),
        ("density", "<f4"),
        ("look", "<u4"),
        ("middle", "<f4", 3),
        ("share", "<f4"),
    ]
)
"""64 bytes, in the model's space, m. `half`: half axes of the ellipsoid; they grow by `widening` for each
metre that the boxes of a cloud widen; `turn`: cosine and sine; `look`: texture, chance << 8, shading group <<
16, box of the model << 24; `middle`: of the shading group; `share`: the least density of sprites at which
this one is drawn."""


def stock(packed: Packed, density: float = 1.0) -> tuple[np.ndarray, np.ndarray]:
    """Sprites of all models, by model and level, and where they begin.

    Parameters
    ----------
    packed : Packed
    density : float
        Of small sprites: so many times the model's own may be drawn.

    Returns
    -------
    sprites : (n,) of `STOCK`
    first : (models, 4) uint32
        Of each model: first sprite (the whole one), number of sprites of boxes, number of fine ones (they
        come last), number of the few (they follow the first).
    """
    rows: list[np.ndarray] = []
    first = np.zeros((len(packed.models), 4), np.uint32)
    at = 0
    for entry, model in zip(first, packed.models, strict=True):
        first_box, boxes, first_sprite, sprites = (int(v) for v in model["first"])
        own = packed.boxes[first_box : first_box + boxes]
        made = _of_model(own, packed.sprites[first_sprite : first_sprite + sprites], first_box)
        copies = [_copy(made[made["level"] == FINE], own, k) for k in range(1, ceil(density))]
        made = np.concatenate([made, *copies])
        entry[:] = at, *((made["level"] == level).sum() for level in (BOX, FINE, FEW))
        rows.append(made)
        at += len(made)
    return np.concatenate(rows), first


def _of_model(boxes: np.ndarray, sprites: np.ndarray, first_box: int) -> np.ndarray:
    parts = _parts(boxes)
    few = parts.max() + 1
    out = np.zeros(1 + few + len(sprites), STOCK)
    out[0] = _whole(boxes)
    for part in range(few):
        out[1 + part] = _whole(boxes[parts == part])
        out[1 + part]["level"] = FEW
    box = boxes[sprites["word"][:, 0] - first_box]
    rest = out[1 + few :]
    rest["centre"], rest["density"] = sprites["centre"], box["density"]
    rest["half"] = SWELL * sprites["size"][:, None] * box["half"]
    rest["widening"] = SWELL * sprites["size"]
    rest["turn"] = np.stack([box["cosine"], box["sine"]], -1)
    word = sprites["word"]
    rest["look"] = word[:, 1] | word[:, 2] << 8 | word[:, 3] << 16 | (word[:, 0] - first_box) << 24
    rest["level"] = np.where(_is_first(word[:, 0]), BOX, FINE)
    rest["share"] = (word[:, 2] + 0.5) / 256.0
    groups = word[:, 3]
    for group in np.unique(groups):
        within = boxes["group"] == group
        weight = boxes["half"][within].prod(1)
        rest["middle"][groups == group] = np.average(boxes["centre"][within], axis=0, weights=weight)
    return out[np.argsort(_ORDER[out["level"]], kind="stable")]


def _copy(fine: np.ndarray, boxes: np.ndarray, number: int) -> np.ndarray:
    """Small sprites once more, `number` quarters of a turn further round their boxes."""
    out = fine.copy()
    box = boxes[fine["look"] >> 24]
    c, s = box["cosine"], box["sine"]
    x, y = (fine["centre"] - box["centre"])[:, :2].T
    x, y = (c * x + s * y) / box["half"][:, 0], (c * y - s * x) / box["half"][:, 1]
    for _ in range(number):
        x, y = -y, x
    x, y = x * box["half"][:, 0], y * box["half"][:, 1]
    out["centre"][:, :2] = box["centre"][:, :2] + np.stack([c * x - s * y, s * x + c * y], -1)
    out["look"] = (fine["look"] & ~np.uint32(0xFF00)) | ((((fine["look"] >> 8) + 64 * number) & 0xFF) << 8)
    out["share"] += number
    return out


_ORDER = np.array([0, 2, 3, 1])  # in which levels come


def _parts(boxes: np.ndarray) -> np.ndarray:
    """Which of at most `MOST_PARTS` parts of a cloud each box belongs to: means that move, from far boxes."""
    half = boxes["half"].astype(float)
    centre, volume = boxes["centre"].astype(float), half.prod(1)
    chosen = [int(volume.argmax())]
    while len(chosen) < min(MOST_PARTS, len(boxes)):
        away = np.linalg.norm(centre[:, None] - centre[chosen], axis=-1).min(1)
        chosen.append(int((away * volume ** (1 / 3)).argmax()))
    means = centre[chosen]
    part = np.zeros(len(boxes), int)
    for _ in range(12):
        part = np.linalg.norm(centre[:, None] - means, axis=-1).argmin(1)
        kept = np.unique(part)
        means = np.array([np.average(centre[part == k], axis=0, weights=volume[part == k]) for k in kept])
    return np.unique(part, return_inverse=True)[1]


def _is_first(box: np.ndarray) -> np.ndarray:
    """Of sprites listed by box, those that are the first of theirs."""
    return np.append(True, box[1:] != box[:-1]) if len(box) else np.zeros(0, bool)


def _whole(boxes: np.ndarray) -> np.ndarray:
    """One ellipsoid with the place and about the outline of all boxes: matter's mean and spread."""
    row = np.zeros((), STOCK)
    volume = boxes["half"].prod(1).astype(float)
    weight = volume / volume.sum()
    centre = weight @ boxes["centre"]
    c, s = boxes["cosine"], boxes["sine"]
    half = boxes["half"].astype(float)
    along = np.stack(
        [np.hypot(c * half[:, 0], s * half[:, 1]), np.hypot(s * half[:, 0], c * half[:, 1]), half[:, 2]], -1
    )
    # of a ball of matter, the mean of the square of each coordinate is a fifth of its radius'
    spread = weight @ ((boxes["centre"] - centre) ** 2 + along**2 / 5.0)
    row["centre"], row["middle"] = centre, centre
    row["half"] = SWELL * np.sqrt(5.0 * spread)
    row["widening"], row["turn"], row["density"] = SWELL, (1.0, 0.0), weight @ boxes["density"]
    row["level"], row["share"], row["look"] = WHOLE, 0.0, NO_BOX << 24
    return row
