"""Shadows of clouds on everything: one map that all techniques and the ground share.

What it is
    ``clouds.shadow``: pictures of all clouds' optical depth, seen along the key light (sun, at night moon),
    of three sizes in one another about the camera, and one seen straight down. Each texel is one ray through
    the boxes of the clouds near it, in closed form (``light.wesl``), so the map holds no noise and needs no
    technique. Beside the depth it keeps where on the ray the matter is: a look-up tells what lies above any
    height, for the ground, for clouds under clouds, for a cloud's own shade.
    ``clouds.overhead``: what of key light and sky light arrives under the clouds from all sides, blurred as
    the ground sees them; energy is kept (delta-Eddington, see ``light.py``).

Limits
    Within the map space is flat and the light parallel; the largest map reaches 48 km, beyond it land is lit
    by the map's mean. Edges are as soft as a texel of the finest map, which is 6 km wide, or from far away as
    the sun's disc makes them, by way of the next map. Light lower than 2 degrees throws shadows as
    from there. A ray keeps mean and spread of the heights of its deepest cloud, and the mean heights of what
    lies before it and behind: inside of clouds under a sun lower than some 5 degrees the shade is rough.
    Where clouds touch, their fields add up and close the gap between them; here it stays open.

Files
    ``model`` (where the maps lie), ``frame.wesl`` (the same for shaders), ``map.wesl`` and ``overhead.wesl``
    (the passes), ``lookup.wesl`` (what others ask)
"""

from .passes import CLOUD_SHADOW, ShadowMap

__all__ = ["CLOUD_SHADOW", "ShadowMap"]
