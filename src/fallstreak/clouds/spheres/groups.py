"""Groups of spheres: what a cloud model is made of for this technique.

The boxes' ellipsoids are the body; smaller ones sit on the body's surface, where that is the cloud's, spread
evenly by farthest-point choice. Every one is scaled, sheared and turned a little differently (``pose.wesl``
morphs them with time), and their surfaces melt into one another (``surface.wesl``).
"""

from __future__ import annotations

import numpy as np

from ..shapes import SWELL, CloudModel

MOST = 48
"""Spheres of a model, but for models that have more boxes."""
SUNK = 0.3
"""Depth of a bump's middle below the surface it sits on, over its radius."""
OUTLINE = 1.08
"""Farthest that a sphere's surface is from its middle, noise and all, over its half axis."""
MORPHED = 1.1
"""Largest size and way of a bump, over those in the table (``pose.wesl``)."""
_TRIES = 96  # directions on each ellipsoid

SPHERE = np.dtype(
    [
        ("centre", "<f4", 3),
        ("cosine", "<f4"),
        ("offset", "<f4", 3),
        ("sine", "<f4"),
        ("axes", "<f4", 3),
        ("swell", "<f4"),
        ("spread", "<f4", 2),
        ("shear", "<f4"),
        ("phase", "<f4"),
    ]
)
"""64 bytes, in the model's metres. `centre` of its box, whose axes are turned by `cosine`, `sine`; `offset`
from there and half `axes`, along the box's axes; `swell`, `spread`: growth of the horizontal axes and of the
offset with a cloud's swell; `shear` along x per z; `phase` radians of its morphing, negative: a box that
keeps its shape."""


def group(model: CloudModel, seed: int = 0) -> np.ndarray:
    """The spheres of a model, (n,) of `SPHERE`, bodies first; the same for the same model and seed."""
    boxes = model.boxes
    out = np.zeros(len(boxes), SPHERE)
    out["centre"], out["cosine"], out["sine"] = boxes["centre"], boxes["cosine"], boxes["sine"]
    out["axes"], out["swell"], out["phase"] = SWELL * boxes["half"], SWELL, -1.0
    room = MOST - len(boxes)
    if room <= 0:
        return out
    bumps, places, sizes = _candidates(boxes, np.random.default_rng([seed, len(boxes)]))
    return np.concatenate([out, bumps[_spread(places, sizes, room)]])


def filled(model: CloudModel, spheres: np.ndarray) -> np.ndarray:
    """Radius and height that a model's spheres reach at most, over those beyond which its field is 0."""
    c, s = spheres["cosine"], spheres["sine"]
    way = spheres["offset"] * np.where(spheres["phase"] < 0.0, 1.0, MORPHED)[:, None]
    size = OUTLINE * spheres["axes"] * np.where(spheres["phase"] < 0.0, 1.0, MORPHED)[:, None]
    east = spheres["centre"][:, 0] + c * way[:, 0] - s * way[:, 1]
    north = spheres["centre"][:, 1] + s * way[:, 0] + c * way[:, 1]
    radius = float((np.hypot(east, north) + size[:, :2].max(1)).max())
    height = float((spheres["centre"][:, 2] + way[:, 2] + size[:, 2]).max())
    return np.array([radius / model.reach, height / model.top], np.float32)


def _candidates(boxes: np.ndarray, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Bumps on all boxes where their surface is the cloud's; their places and radii, m."""
    half = SWELL * boxes["half"].astype(float)
    each = np.repeat(np.arange(len(boxes)), _TRIES)
    # even over the sphere, none on the underside
    step = np.tile(np.arange(_TRIES), len(boxes))
    z = 1.0 - (step + rng.random(len(each))) / _TRIES * 1.25
    turn = step * np.pi * (3.0 - 5.0**0.5) + 6.2832 * rng.random(len(boxes))[each]
    flat = np.sqrt(np.maximum(1.0 - z * z, 0.0))
    way = np.column_stack([flat * np.cos(turn), flat * np.sin(turn), z])
    size = np.cbrt(half.prod(1))[each] * (0.22 + 0.28 * rng.random(len(each)))
    size = np.minimum(size, 0.8 * half[each].min(1))

    c, s = boxes["cosine"][each].astype(float), boxes["sine"][each].astype(float)
    off = way * np.maximum(half[each] - SUNK * size[:, None], 0.2 * half[each])
    places = boxes["centre"][each] + np.column_stack(
        [c * off[:, 0] - s * off[:, 1], s * off[:, 0] + c * off[:, 1], off[:, 2]]
    )
    others = _field(boxes, half, places, each)
    seen = (others < 0.2) & (places[:, 2] > 0.4 * size)
    bumps = np.zeros(len(each), SPHERE)
    bumps["centre"], bumps["cosine"], bumps["sine"] = boxes["centre"][each], c, s
    bumps["offset"] = off
    bumps["axes"] = size[:, None] * (0.85 + 0.3 * rng.random((len(each), 3)))
    bumps["swell"], bumps["spread"] = 0.3, SWELL * way[:, :2]
    bumps["shear"] = 0.5 * (rng.random(len(each)) - 0.5)
    bumps["phase"] = 6.2832 * rng.random(len(each))
    return bumps[seen], places[seen], size[seen]


def _field(boxes: np.ndarray, half: np.ndarray, places: np.ndarray, own: np.ndarray) -> np.ndarray:
    """The field of the other boxes at places."""
    v = places[:, None] - boxes["centre"]
    c, s = boxes["cosine"], boxes["sine"]
    x = (c * v[..., 0] + s * v[..., 1]) / half[:, 0]
    y = (c * v[..., 1] - s * v[..., 0]) / half[:, 1]
    k = np.maximum(1.0 - 0.5 * (x * x + y * y + (v[..., 2] / half[:, 2]) ** 2), 0.0) ** 2
    k[np.arange(len(places)), own] = 0.0
    return k.sum(1)


def _spread(places: np.ndarray, sizes: np.ndarray, count: int) -> np.ndarray:
    """Rows of places far from one another in units of their sizes, greedily: the largest first."""
    if not len(places):
        return np.zeros(0, np.int64)
    chosen = [int(np.argmax(sizes))]
    nearest = np.full(len(places), np.inf)
    while len(chosen) < count:
        last = chosen[-1]
        apart = np.linalg.norm(places - places[last], axis=1) / (sizes + sizes[last])
        nearest = np.minimum(nearest, apart)
        # size counts too: many small ones would crowd where they fit
        best = int(np.argmax(nearest * np.sqrt(sizes)))
        if nearest[best] < 0.35:
            break
        chosen.append(best)
    return np.array(chosen)
