"""Shadows of the land on everything, at all distances, by a swept shadow height.

What it is
    For every sample of the ground the heights under which the light's disc is hidden: wholly, and in part.
    Whoever asks compares its own height with these two (``lookup.wesl``), be it ground, a tree, an aircraft
    or a cloud; it pays for one or two fetches, however far the mountain that throws the shadow.
    One thread walks each line of a level of the ground's clipmap along the light's azimuth, from where the
    light comes, and keeps two running maxima, for the lower and the upper edge of the disc. Lines lie in a
    sheared grid, so that each sample is visited once; where a line enters the window it goes on with what the
    next coarser level says there. Heights are lowered by d²/2R, so the planet's curve is in it.

When
    Windows move in steps, the light on a lattice of some hundredths of a degree: what was swept depends on
    camera and light alone. A level is swept anew when its own or a coarser one's step is reached
    (``schedule``).

Limits
    Shadows are as sharp as a level's samples, which are coarser than the picture's pixels far away; a
    window's samples are 1/87 to 1/302 of the distance by quality and size. One height each: nothing is lit
    under an overhang.

Files
    ``model`` (the same in float64 on the CPU, and rays to check it by), ``schedule`` (which levels are due),
    ``passes``, ``sweep.wesl``, ``lookup.wesl`` (what others ask)
"""

from .passes import ABSENT, Sweep

__all__ = ["ABSENT", "Sweep"]
