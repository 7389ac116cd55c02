"""Trees, shrubs and rocks by the tens of thousands, sown by what covers the ground.

What it is
    Four kinds (`flora.KINDS`: conifer, broad-leaved tree, shrub, rock), each on its own lattice of cells,
    at most one to a cell. A cell's plant is a function of the world, the seed and the cell; the cover of
    the clipmap decides whether the ground feeds it, `flora.FLORA` what each country grows.

The way of a frame
    ``plants.select``     squares of 8 × 8 cells in sight (one workgroup)
    ``plants.placement``  a thread per cell: looks up the ground, appends the plant to the lists of the levels
                          of detail that draw it, and counts up their draw arguments
    ``plants.<kind>0``    fine meshes          one indirect draw each, however many stand there
    ``plants.<kind>1``    coarse meshes
    ``plants.<kind>2``    impostors: 8 × 8 pictures over the upper half of directions (Brucks 2018), which
                          ``plants.<kind>.bake`` makes of the fine mesh in the first frame; stones are 80
                          triangles instead

    All are drawn before the ground, whose pixels are the dearer ones, near plants first. Two levels that
    share a plant share its pixels by a dither that changes with the sampling point, so that anti-aliasing
    over frames or samples makes a fade of it. At their radius trees leave one after the other; from there on
    the canopy material stands for them (`tree_radius`).

Shadows (`casters`)
    Into a map seen along the light, all round the camera: ``….plants.select`` and ``….plants.placement`` work
    out what throws shadows into it and how it lies there, then one draw per kind, only when the map is due.
    What is lower than 14 texels is thinned out, what is lower than 1.5 left out.

Wind
    A stem bends as a rod clamped at its foot, with the square of height and of the wind's speed, swings
    in its own time, and gusts travel over the land; branches flutter. Motion vectors follow. All
    frequencies are multiples of 1/64 Hz: no seam at any time.

Limits
    One mesh per kind, turned, stretched and coloured for each plant. A crown shades itself by `look.sky`
    only, others as a solid picture does: no light comes through. Shadows do not sway, and those in a kept map
    are as the plants were when it was made: a little farther or nearer, on a coarser or finer ground. Stones
    and shrubs end at half of the trees' radius. Which plants stand where depends on the quality's radius, by
    the level of the clipmap that their cover is read from.

Cost
    Python sets one uniform (some 15 µs), whatever stands there. On a software adapter (four cores): 0.3
    ms for placement per 1,000 plants in sight, 4 to 6 µs per impostor, 0.3 ms per tree that is a coarse
    mesh. A map of 1024² in autumn woods (300 m of plants): within 50 m 20 ms at 3° of sun, 9 ms at 40°;
    13 ms within 190 m, 7 ms beyond.
"""

from .passes import Vegetation
from .stands import tree_radius

__all__ = ["Vegetation", "tree_radius"]
