"""Clouds: one field, drawn by several techniques.

What it is
    Clouds are objects on a lattice per layer: a cell may hold one, a copy (place, turn, size, age) of a cloud
    model, which is a handful of boxes (`shapes`). The boxes are the matter: `field` makes extinction of them,
    sprites fill them, spheres fill them, puffs sample the field. So every technique shows the same clouds in
    the same places.

The way of a frame
    ``clouds.cells``     which clouds there are about the camera, one thread a cell
    ``clouds.shadow``    optical depth towards the sun (at night the moon), see `shadow`
    a technique          draws into ``clouds.layer``: no light but what light does there (below)
    ``frame.clouds``     makes light of it and lays it over the picture (frame/clouds.wesl)

``clouds.layer``
    rgba16float, premultiplied by opacity. Red: light from the key (sun, at night moon), radiance over a white
    Lambert surface's that faces it. Green: ambient share, 0 sees the ground alone, 1 the sky alone. Blue:
    log2(distance in m) / 24. Alpha: opacity.

Sources
    Sprites: Wang 2004, "Realistic and Fast Cloud Rendering" (Flight Simulator 2004). Puffs: X-Plane 10.
    Spheres: Glider game.
"""
