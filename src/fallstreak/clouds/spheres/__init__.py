"""Clouds of spheres with a definite surface, kept in an atlas and shaded late (Glider game).

What it is
    A cloud is a group of spheres: the boxes of its model, and bumps on them (`groups`), scaled, sheared and
    slowly morphing, melted into one another and eaten by the field's noise. Each cloud in sight has a section
    of its own in two atlases: its normals, its surface's depth and light. A section is drawn anew only before
    it would look old. In the picture a cloud is one rectangle that looks its section up, displaced by
    one turbulence (ragged edges), with its surface tilted by a second (cotton), in light that wraps all
    around; light and shade are mixed in a polar colour space (`polar.wesl`, one folder up).
    Clouds have a definite inside: where `world.clouds.inside` says so, the camera sees fog, at once.

The way of a frame, all on the GPU
    ``gather``                 clouds in sight, and those about the camera
    ``by_distance``, ``nearest``  their order; those about the camera for which there is room
    ``assign``                 who has which section; what is drawn anew: the most outdated
    ``pose``                   the spheres of those as they stand now
    ``trace``                  rays through the spheres of a section: surface, normals, light
    ``near_tiles``, ``near``   the same for the picture itself, of clouds about the camera, in each frame
    ``place``, ``cores``       what a cloud's pixels share; how far away the nearest solid cloud is
    ``draw``                   one rectangle a cloud, far to near; then those about the camera, then fog

Source
    "Glider" (2024): groups of sphere meshes in two 4k atlases, turbulence on look-up and normal, light and
    shadow blended in polar coordinates; its author's wishes (scaled, sheared, morphed spheres; metaball
    normals).
    OKLCh: B. Ottosson 2020, "A perceptual color space for image processing".

Limits
    Twelve clouds about the camera. No clouds beyond the field's window of cells.
"""

from .passes import Spheres

__all__ = ["Spheres"]
