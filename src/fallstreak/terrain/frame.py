"""What every pass of the ground is told of a frame."""

from __future__ import annotations

from ..gpu import Struct

TERRAIN_FRAME = Struct(
    "TerrainFrame",
    [
        ("camera_map", "vec2f", "m, camera on the map, east and north of the anchor"),
        ("camera_local", "vec2f", "m, camera_map − tile, exact"),
        ("camera_fraction", "vec2f", "m, from the corner of the camera's leaf cell to the camera"),
        ("camera_cell", "vec2i", "leaf cell under the camera"),
        ("tile", "vec2i", "m, whole multiple of 4096 near the camera: the origin of noise"),
        ("camera_height", "f32", "m above sea level"),
        ("camera_above", "f32", "m from the nearest ground, below or beside"),
        ("sun", "vec3f", "unit, towards the sun, world axes"),
        ("pole", "vec3f", "the planet's north pole in world axes"),
        (
            "camera_sample",
            "vec2u",
            "sample of the clipmap's level 0 below the camera, in its wrapping window",
        ),
        ("camera_rest", "vec2f", "the rest of the way to the camera, in samples of level 0"),
        ("clip_levels", "u32", "number of levels of the clipmap"),
        ("finest", "f32", "finest level that is of use from here"),
        ("shift_bound", "f32", "m, how far from its place on the map the ground may be drawn"),
        ("extent", "f32", "m, half the width of the map"),
        ("leaf", "f32", "m, width of the smallest node"),
        ("range", "f32", "a node is drawn up to this many of its own widths away"),
        ("coarse_range", "f32", "the same where land is rugged in samples as wide as its own"),
        ("coarse_level", "f32", "of the clipmap, a real number: up to here it is `range`"),
        ("spacing", "f32", "m between texels of level 0 of an elevation model"),
        ("levels", "f32", "number of levels of an elevation model"),
        ("lowest", "f32", "m, lowest ground anywhere"),
        ("highest", "f32", "m, highest ground or water anywhere"),
        ("globe_height", "f32", "m above sea level of the sphere beyond the terrain"),
        ("map_cosine", "f32", "cosine of the angle of the terrain's round map; 2 where there is none"),
        ("land_near", "f32", "1 where the planet near the anchor must be land, -1 sea"),
        ("depth", "u32", "quadtree level of the leaves"),
        ("indices", "u32", "of one node's mesh"),
        ("seed", "u32", "of all noise here"),
    ],
)
