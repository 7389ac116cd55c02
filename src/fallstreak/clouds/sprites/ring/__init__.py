"""The ring: eight pictures of far clouds about the camera, in place of the clouds.

Source
    Wang 2004, "Realistic and Fast Cloud Rendering" (Flight Simulator 2004): an octagon, eight pictures of 256²
    texels, blocks of 16 km² beyond a radius that the user sets, one picture a frame over eight frames.

How
    `plan` decides on the CPU, once a frame: which picture is drawn now, how far the ring that comes in has come
    in. A picture is drawn with the same passes as the sprites in sight, from the ring's middle, and kept as four
    bytes a texel (`keep.wesl`). `show.wesl` draws the octagon behind the sprites near by. Its sides stand at
    twice the radius: to a camera that has left the middle, clouds at the radius then seem as much too far as
    those at the horizon seem too near.
    Until the first ring is complete, and after a cut, all clouds are drawn one by one.

Limits
    Pictures have 5.7 texels a degree. Layers more than 3,048 m above or below the camera, and clouds higher than
    the pictures, are drawn one by one. With ``colours = "artist"`` there is no ring.
"""
