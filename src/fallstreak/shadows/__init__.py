"""Shadows of land, plants and models, to fifty kilometres and beyond.

The Infinity journal (2007) packed four maps of everything into one and reached 5.5 km; its author wanted 50
km and more, for mountains at sunset and for a ship five kilometres long. Here every kind of shadow has the
way that suits it:

    ``sweep/``      Land upon everything: the height under which a place lies in the shade, found by one walk
                    along the light over the ground's levels, with the planet's curve and the penumbra.
    ``cascades/``   Things upon everything: maps around the camera that stand still in the world, and one of
                    all models, whose shadows fall any distance away. The journal's own four maps as well.
    ``contact/``    What maps are too coarse for, close to the eye, from the picture's depth.

``light.wesl`` asks all three and writes ``shadows.light``: of sun and moon, how much arrives at each pixel.
Clouds' shadows are the clouds' (``clouds/shadow``); lighting multiplies them in.

Limits and cost: ``docs/shadows.md``.
"""
