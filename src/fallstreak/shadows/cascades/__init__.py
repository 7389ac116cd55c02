"""Shadows of things, plants and models, on everything, by maps seen along the light.

What it is
    Four square maps about the camera (`window`), each four times as wide as the one before; they do not turn
    with it and lie on whole texels of the plane that faces the light, so that nothing flickers when it moves
    or turns. What stands still in them is drawn once and kept until the camera leaves a map's margin, the
    light turns or a thing changes (`keep`).
    What moves has a map of its own, fitted to it and drawn in each frame; so has what is large, still or
    not: a map along the light holds for receivers at any distance, and a ship five kilometres long throws
    its shadow 50 km. Whoever asks takes the nearer of what stands still and what moves: a moving thing is
    never half in shadow, and nothing is copied.

``infinity2007``
    The Infinity journal's way (2007), to compare: four maps of 1024² packed in one of 2048², to 150, 500,
    1666 and 5555 m, fitted to the frustum's slices, with everything in them, land too; the receiver's depth
    is taken .95 to .999 times by the slope; four soft samples; they fade at the far end.

Limits
    A plant's shadow is that of its picture from the light. What throws shadows is not blurred by the sun's
    disc.

Files
    ``window`` (float64: where maps lie), ``keep`` (which are due), ``passes``, ``drawn`` and ``store.wesl``
    (a map as it is drawn, and into its layer), ``lookup.wesl`` (what others ask); ``infinity`` and
    ``packed.wesl`` (the journal's)
"""

from .infinity import PACKED, Packed
from .passes import CASCADES, Cascades

__all__ = ["CASCADES", "PACKED", "Cascades", "Packed"]
