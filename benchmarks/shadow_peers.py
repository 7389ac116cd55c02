"""The same land, boxes, camera and light by pygfx, with and without its one shadow map, and by Fallstreak.

pygfx is needed for nothing else; docs/shadows.md says how to install it.
"""

from __future__ import annotations

import json
import time
from base64 import b64encode
from contextlib import ExitStack
from math import atan, degrees, radians, tan
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

import fallstreak as fs
from fallstreak.world.state import local_axes

SIZE = (1280, 720)
SIDE, SAMPLES, BOXES = 1000.0, 256, 500
BOX = np.array([3.0, 3.0, 8.0])  # m, half of each side
EYE = {"east": 0.0, "north": -420.0, "height": 60.0, "heading": 0.0, "pitch": -12.0, "fov": 62.0}

_CORNERS = np.array([(x, y, z) for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)], float)
_SIDES = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))


def beside(frames: int = 10, warm: int = 4) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Seconds of frames without and with shadows, drawn in turn, of each of the two.

    Raises
    ------
    ImportError
        pygfx or what it needs is not installed.
    """
    import pygfx  # noqa: F401  (said before anything is made)

    east, north = np.random.default_rng(1).uniform(-0.45 * SIDE, 0.45 * SIDE, (2, BOXES))
    with TemporaryDirectory() as folder, ExitStack() as stack:
        world = fs.load("jacksboro").updated(
            {
                "time": "2025-10-18T16:48:00-04:00",
                "terrain.vegetation": 0.0,
                "models": [{"file": str(_box_file(Path(folder))), "name": "box", "capacity": BOXES}],
                "camera": EYE,
            }
        )
        ours, renderers = [], []
        for technique in ("none", "stable"):
            own = world.updated({"shadows.technique": technique})
            renderer = stack.enter_context(fs.Renderer(own, SIZE, "low", fps=30.0))
            renderer.models["box"].place(east=east, north=north, height=BOX[2] - 2.0)
            renderers.append(renderer)
            ours.append(renderer.render)
        ours[0](0)  # before pygfx: sets wgpu up, and knows where the sun stands
        axes = local_axes(0.0, 0.0, world.planet.radius)
        sun = axes.T @ np.asarray(renderers[0].graph.uniforms["sky.light"].record["sun_direction"], float)
        draws = {"fallstreak": ours}
        draws["pygfx"] = [
            draw_by_pygfx(world.terrain, east, north, sun, shadows) for shadows in (False, True)
        ]
        times = {name: ([], []) for name in draws}
        for index in range(warm + frames):
            for name, pair in draws.items():
                for draw, own in zip(pair, times[name], strict=True):
                    start = time.perf_counter()
                    draw(index)
                    own.append(time.perf_counter() - start)
        return {name: (np.array(a[warm:]), np.array(b[warm:])) for name, (a, b) in times.items()}


def draw_by_pygfx(terrain, east, north, sun, shadows):
    """A function that draws the scene: 256 x 256 samples of the land's first kilometre, and the boxes."""
    import pygfx as gfx
    from rendercanvas.offscreen import RenderCanvas

    land = gfx.plane_geometry(SIDE, SIDE, SAMPLES - 1, SAMPLES - 1)
    x, y, z = (land.positions.data[:, axis] for axis in range(3))
    z[:] = terrain.height(x, y)
    land.normals.data[:] = terrain.normal(x, y)
    ground = gfx.Mesh(land, gfx.MeshStandardMaterial(color="#6b6a55"))
    boxes = gfx.InstancedMesh(gfx.box_geometry(*2.0 * BOX), gfx.MeshStandardMaterial(color="#b0a090"), BOXES)
    places = np.column_stack([east, north, terrain.height(east, north) + BOX[2] - 2.0])
    for index, place in enumerate(places):
        matrix = np.eye(4)
        matrix[:3, 3] = place
        boxes.set_matrix_at(index, matrix)
    for thing in (ground, boxes):
        thing.cast_shadow = thing.receive_shadow = shadows
    middle = np.array([0.0, 0.0, terrain.height(0.0, 0.0)])
    light = gfx.DirectionalLight(intensity=3.0, cast_shadow=shadows)
    light.local.position = middle + sun  # its map reaches 500 m from there, each way
    light.target.local.position = middle
    scene = gfx.Scene()
    scene.add(gfx.Background.from_color("#8fb0d8"), gfx.AmbientLight(intensity=0.6))
    scene.add(ground, boxes, light, light.target)
    aspect = SIZE[0] / SIZE[1]
    tangent = tan(radians(0.5 * EYE["fov"])) * 0.5 * (1.0 + aspect)  # pygfx: of the mean of width and height
    camera = gfx.PerspectiveCamera(2.0 * degrees(atan(tangent)), aspect, depth_range=(0.5, 5000.0))
    eye = np.array([EYE["east"], EYE["north"], terrain.height(EYE["east"], EYE["north"]) + EYE["height"]])
    camera.local.position = eye
    camera.world.reference_up = (0.0, 0.0, 1.0)
    camera.look_at(eye + np.array([0.0, 1.0, tan(radians(EYE["pitch"]))]))
    canvas = RenderCanvas(size=SIZE, pixel_ratio=1)
    renderer = gfx.WgpuRenderer(canvas, pixel_ratio=1)
    canvas.request_draw(lambda: renderer.render(scene, camera))
    return lambda index: canvas.draw()


def _box_file(folder: Path) -> Path:
    """The box as a model: 24 corners, a normal for each side."""
    corners = np.concatenate([_CORNERS[list(side)] for side in _SIDES]) * BOX
    normals = np.repeat([np.mean(_CORNERS[list(side)], 0) for side in _SIDES], 4, 0)
    triangles = np.concatenate([4 * n + np.array([0, 1, 2, 0, 2, 3]) for n in range(6)])
    # glTF: y up
    parts = [a[:, [0, 2, 1]] * [1, 1, -1] for a in (corners, normals)]
    data = [p.astype(np.float32).tobytes() for p in parts] + [triangles.astype(np.uint16).tobytes()]
    starts = np.cumsum([0, *map(len, data)])
    tree = {
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 1}, "indices": 2}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 24, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5126, "count": 24, "type": "VEC3"},
            {"bufferView": 2, "componentType": 5123, "count": 36, "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteOffset": int(start), "byteLength": len(part)}
            for start, part in zip(starts, data, strict=False)
        ],
        "buffers": [
            {
                "byteLength": int(starts[-1]),
                "uri": "data:application/octet-stream;base64," + b64encode(b"".join(data)).decode(),
            }
        ],
    }
    path = folder / "box.gltf"
    path.write_text(json.dumps(tree))
    return path
