"""What is where in the sky: clouds on drifting lattices, extinction from their boxes and noise.

What it is
    Up to eight layers. Each has a lattice of square cells that drifts with its wind; a cell may hold one
    cloud, a copy of a cloud model with its own place, size, turn and age. A calibration finds how many clouds
    give the coverage asked for. Extinction comes from the models' boxes, added to a smooth field and eaten by
    noise.

Files
    ``layers``       a layer with every number known; ``genera`` (one folder up) says what is usual
    ``cells``        which cloud a cell holds; ``calibration`` how many it takes; ``coverage`` maps
    ``density``      extinction at places; ``volume`` the noise; ``mean`` extinction of blobs of any size
    ``model``        all of it for a world, on the CPU; ``queries`` what `world.clouds` answers
    ``passes``       on the GPU: the pass ``clouds.cells``, and what shaders bind (``resources.wesl``)

Everything is a function of (world, time, seed). Limits: the map is flat for clouds (azimuthal equidistant
about the anchor), clouds do not change their shape but by growing and shrinking, winds are constant, and thin
sheets where little of the sky is covered show that they are made of round patches.
"""

from .model import Field, field_of

__all__ = ["Field", "field_of"]
