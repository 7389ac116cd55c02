"""A cloud model: boxes as arrays, the sprites sown in them, colours."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from .sow import sown
from .tables import Colours, ModelFile

SWELL = 1.15
"""The ellipsoid of a box, over the box: an ellipsoid inside it would have half of its volume."""

BOX = np.dtype(
    [
        ("centre", "<f4", 3),
        ("group", "<f4"),
        ("half", "<f4", 3),
        ("cosine", "<f4"),
        ("sine", "<f4"),
        ("density", "<f4"),
        ("spare", "<f4", 2),
    ]
)
"""48 bytes, three vec4f: m, east, north and up from the middle of the cloud's base; `half` the half sizes
along the box's own axes; `cosine`, `sine` of its turn, counter-clockwise from above."""

SPRITE = np.dtype(
    [("centre", "<f4", 3), ("box", "<u2"), ("texture", "<u1"), ("chance", "<u1"), ("size", "<f4")]
)
"""`size` over the ellipsoid of its box, `chance` a random number 0…255."""


@dataclass(frozen=True, eq=False)
class CloudModel:
    """A cloud model.

    Attributes
    ----------
    name, title : str
    boxes : (n,) of `BOX`
    sprites : (m,) of `SPRITE`
        By box, the one in a box's middle first.
    culled : int
        Sprites that were too close to others and are left out.
    colours : Colours
    radius, height : float
        m, of the ellipsoids: the cloud, but for noise.
    reach, top : float
        m, beyond which the field of the boxes is 0 (the ellipsoids times √2).
    """

    name: str
    title: str
    boxes: np.ndarray
    sprites: np.ndarray
    culled: int
    colours: Colours = field(repr=False)

    @classmethod
    def of(cls, name: str, table: ModelFile) -> CloudModel:
        """The model that a file's tables describe."""
        boxes = np.zeros(len(table.boxes), BOX)
        for row, box in zip(boxes, table.boxes, strict=True):
            turn = np.radians(box.turn)
            row["centre"], row["half"] = box.centre, np.asarray(box.size) / 2.0
            row["group"], row["density"] = box.group, box.density
            row["cosine"], row["sine"] = np.cos(turn), np.sin(turn)
        sprites, culled = sown(name, table, boxes, SPRITE, SWELL)
        return cls(name, table.title, boxes, sprites, culled, table.colours)

    @property
    def radius(self) -> float:
        return self._around(1.0)[0]

    @property
    def height(self) -> float:
        return self._around(1.0)[1]

    @property
    def reach(self) -> float:
        return self._around(2.0**0.5)[0]

    @property
    def top(self) -> float:
        return self._around(2.0**0.5)[1]

    def _around(self, wider: float) -> tuple[float, float]:
        """Radius about the vertical axis and height that hold the ellipsoids times `wider`."""
        half = self.boxes["half"].astype(float) * SWELL * wider
        turn = np.linspace(0.0, 2.0 * np.pi, 64, endpoint=False)
        x, y = half[:, :1] * np.cos(turn), half[:, 1:2] * np.sin(turn)
        c, s = self.boxes["cosine"][:, None], self.boxes["sine"][:, None]
        centre = self.boxes["centre"].astype(float)
        away = np.hypot(centre[:, :1] + c * x - s * y, centre[:, 1:2] + s * x + c * y)
        return float(away.max()), float((centre[:, 2] + half[:, 2]).max())
