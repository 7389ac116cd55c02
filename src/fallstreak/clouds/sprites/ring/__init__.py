"""The ring: eight pictures of far clouds about the camera, in place of the clouds.

Source
    Wang 2004, "Realistic and Fast Cloud Rendering" (Flight Simulator 2004): an octagon, eight pictures of
    256² texels, blocks of 16 km² beyond a radius that the user sets, one picture a frame over eight frames.

How
    `plan` decides on the CPU, once a frame: what of a ring is drawn now, how far the ring that comes in has
    come in. A picture is drawn with the same passes as the sprites in sight, from the ring's middle, and kept
    as four bytes a texel (``keep.wesl``). ``show.wesl`` draws the octagon behind the sprites near by. Its
    sides stand upright at twice the radius: to a camera that has left the middle, clouds at the radius then
    seem as much too far as those at the horizon seem too near, and all shift with the angle to them.
    A first frame, and one after a cut, draws all eight sides at once; a ring that is made anew, a quarter of
    a side (`parts`). Who is so fast that rings would be out of date when they are complete has none.
    A block counts from the ring's middle and drifts with its layer, so that a cloud does not change sides
    while a ring is in sight; while one comes in, a cloud may be in both, in one, or in none, and is drawn as
    much as the rings do not show it.
    On weak machines (``ring_update = "block"``) a frame draws one block, what is behind first; far blocks
    are taken together to squares as wide as they are far away, and a ring takes some 70 frames.

Cost
    4 MB for the pictures of two rings, 0.5 MB for the parts of a side (of all sides with "block": 4 MB).
    Twice that with ``colours = "artist"``.

Limits
    Pictures have 5.3 texels a degree. Layers more than 3,048 m above or below the camera, and clouds higher
    than the pictures, are drawn one by one.
"""
