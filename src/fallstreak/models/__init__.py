"""Models: glTF 2.0 things in the world, one draw for all copies of each.

Follows the glTF 2.0 specification (Khronos Group 2021) for meshes, nodes and metallic-roughness materials.
A model's triangles, materials and textures are given to the GPU once; a copy is 64 bytes. Positions are
kept exact: vertices relative to the model's origin, the origin relative to the camera by whole tiles and a
remainder.

Limits: no animation, skins or morph targets; no emission (the G-buffer has none) and no blending (drawn as a
mask); one set of texture coordinates. Cost: see ``docs/models.md``.
"""
