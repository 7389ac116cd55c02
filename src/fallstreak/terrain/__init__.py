"""The ground: elevation from files or noise on a curved planet, what covers it, and the globe beyond.

How a picture of it comes about:

1. `land/`: kinds of land, which give the shape of a place; `levels` among them is fed by `elevation/` (files
   become heights that know where they lie), `continuation` and `fractal` (land everywhere) through `pyramid`.
2. `cover/`: kinds of country, which say what a place is covered with.
3. `clipmap`, `clipmap_passes`: both worked out once per sample of nested windows around the camera
   (`shape_pass.wesl`, `surface_pass.wesl`).
4. `selection.wesl`: one workgroup walks a quadtree (CDLOD) and writes the arguments of an indirect draw.
5. `heights_pass.wesl`, `mesh.wesl`, `draw.wesl`: vertices that morph, placed by `placement.wesl` without
   ever subtracting large numbers; `ground.wesl` mixes base materials (`materials/`) in the pixel,
   `water.wesl` is water.
6. `vegetation/`: trees, shrubs and rocks where the cover wants them.
7. `globe.wesl`, `planet.wesl`: the rest of the sphere to the horizon.

`model` holds the same shape in float64 for Python and for the tests, `selection` the same nodes.

Sources: Tanner 1998, Losasso & Hoppe 2004 (clipmaps), Strugar 2010 (CDLOD), the Infinity journal (base
materials), Heitz & Neyret 2018 (tiling and blending), Unser et al. 1991 (splines), Karney 2011 (UTM),
Musgrave 1994 (multifractals), Worley 1996 (cells). Limits and cost: docs/terrain.md.
"""
