"""Clouds of puffs in seven sizes from 1 m to 1,000 km: from inside a cloud to orbit in one climb.

What it is
    The field is sampled on lattices of cells about the camera, one for each size and layer of clouds. A cell
    is a puff: a soft ball. Those smaller than the lumps of their clouds show these: each knows the field, the
    way to the cloud's smooth surface and the light there at five places across it, in closed form from the
    boxes of the models (`surface.wesl`), and noise eats at it as at the field. Larger ones have as much
    matter as the field has there on average, in patches of noise. A puff is a function of its cell, and
    lattices drift with their layers, so that nothing swims as the camera moves. Near ones are small, far
    ones large; where a size ends, the next takes over by shares that make 1 (`levels`).

The way of a frame, all on the GPU
    ``clouds.puffs.buckets``  27 buckets about the camera for each size: those in sight name blocks of cells
    ``clouds.puffs.cells``    each cell in sight asks the field how much its puff stands for
    ``clouds.puffs.lit``      what others do not hide is lit, and given its shape on the screen
    ``clouds.puffs.…``        far to near (`clouds.order`)
    ``clouds.puffs.draw``     one draw of all

Source
    X-Plane 10 (A. Meyer and others), as told by Young: seven resolutions of puffs, each in a 3 × 3 × 3 grid
    of buckets about the camera of which only those in view are drawn.

Cost
    As many puffs are drawn wherever the camera is (`Quality.cloud_puffs`, within some 20 %; 30,000 at most).
    On a software adapter drawing and light take four fifths of it, see ``docs/clouds.md``.

Limits
    What is finer than a puff is noise; heaps narrower than one are round. Beyond the map of the clouds'
    shadows, light within a layer is taken from that layer alone.
"""

from .passes import Puffs

__all__ = ["Puffs"]
