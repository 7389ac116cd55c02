"""Contact shadows: where a thing touches the ground, from the picture's own depth.

A map of shadows has texels of centimetres to metres and moves its receivers by almost two of them, so that
the last hand's breadth at the foot of a stone or a stem stays lit. Here a ray goes from each pixel towards
the light, `world.shadows.contact` metres long, in sixteen steps at most, and asks the depth buffer at each
whether it has gone behind something.

Source: screen-space ray marching is common property; what is our own is how a surface is kept from shading
itself. Depth in reverse-Z is near / distance along the view, and that is *affine in the picture* over any
plane. The gradient at the pixel therefore foretells the depth of its own plane wherever the ray goes, at
any tilt, and only what stands nearer than that can throw a shadow. No offset and no normal is needed, and
none of a normal map's bumps is taken for a wall.

Limits: only what the picture shows throws such shadows, each thing as deep as `contact.wesl` says, so
shadows of things in front of each other can be wrong by that; they fade from 25 m on and are gone at 50 m.

Cost: rays have as many steps as they have pixels in the picture, so distant ones have few; pixels whose
light does not matter (turned away, too far) have none.
"""
