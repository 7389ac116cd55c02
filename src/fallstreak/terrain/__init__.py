"""The ground: elevation from files or noise on a curved planet, out to 160 km, and the globe beyond.

How a picture of it comes about:

1. `elevation`, `geotiff`, `projection`: a file becomes heights that know where on the planet they lie.
2. `continuation` (tiling and blending by example) or `fractal`: land everywhere, not only where the file is.
3. `pyramid`: nested levels of 768² B-spline coefficients around the anchor, slopes, and bounds for each node.
4. `selection.wesl`: one workgroup walks a quadtree (CDLOD) and writes the arguments of an indirect draw.
5. `heights_pass.wesl`, `mesh.wesl`, `draw.wesl`: vertices that morph, placed by `placement.wesl` without ever
   subtracting large numbers; the material per pixel (`temperate.wesl`, `mars.wesl`).
6. `globe.wesl`, `planet.wesl`: the rest of the sphere to the horizon.

`model` holds the same heights in float64 for Python and for the tests, `selection` the same nodes.

Sources: Strugar 2010 (CDLOD), Heitz & Neyret 2018 (tiling and blending), Unser et al. 1991 (splines), Karney
2011 (UTM), Musgrave 1994 (multifractals), Worley 1996 (cells). Limits: heights are known to about 50 m around
the anchor (13 m at best), no overhangs, trees are painted, no rivers or lakes; a camera more than 3000 km
from the anchor sees the globe only. Cost: docs/terrain.md.
"""
