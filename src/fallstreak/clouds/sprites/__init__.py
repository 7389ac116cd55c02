"""Clouds of sprites, with a ring of pictures for the far ones.

Source
    Wang 2004, "Realistic and Fast Cloud Rendering" (Flight Simulator 2004).

How
    A sprite is an ellipsoid of the cloud model: a box's own, or a smaller one under its surface (`stock`). It
    is drawn as the ellipse that it is on the screen, in a square about it that faces the camera. Each pixel's
    ray meets the ellipsoid exactly; the field's noise, looked up where it does, and a texture eat at it;
    opacity is that of the matter left on the ray, so that what is drawn agrees with the field, from inside a
    cloud, too. Noise lies in the world: nothing of it turns with the camera. Where a sprite lies in other
    matter of its cloud it is soft and swells, before the sky it is as sharp as the field.
    Light comes from ``clouds/light.wesl``: optical depths through all boxes of the cloud from five places of
    the cloud's own smooth surface before the sprite; between them the light's logarithm follows the normal.
    So sprites that overlap agree. Noise only shades it a little.
    Passes, as many for any number of clouds: ``select`` (clouds in sight), ``budget`` (how far there is room
    for all their sprites), ``expand`` (sprites as fine as their size on the screen asks for, those that the
    cloud itself hides left out; their light), ``clouds/order``, ``deal`` and five indirect draws, near to
    far, each laid under those before it (a sixth behind the ring). After each, ``closed`` marks by depth
    where nothing behind is seen any more: there the rest is not shaded. Far clouds are a few sprites, or
    one, by the same code.

Limits
    At most 32,768 sprites; beyond that, far clouds are one sprite each. Overlapping sprites are blended one
    over the other by their middles' distance: where they change places there is a slight step.
"""

from .passes import Sprites

__all__ = ["Sprites"]
