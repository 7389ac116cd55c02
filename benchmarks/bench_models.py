"""Models: Python's time per frame by the number of copies, WebGPU calls, the pass itself, loading a file."""

from __future__ import annotations

import json
import time
from base64 import b64encode
from itertools import count
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

import fallstreak as fs

SIZE, ROUNDS = (640, 360), 21
COUNTS = (1, 10, 100, 1_000, 10_000, 100_000)


def run(report):
    from fallstreak.models import model as library

    library.load_model(None, "glider")  # imports pygltflib and Pillow
    for name in ("glider", "ship"):
        library._load.cache_clear()
        start = time.perf_counter()
        loaded = library.load_model(None, name)
        seconds = time.perf_counter() - start
        how = f"{loaded.triangles:,} triangles, textures decoded"
        report.add(f"models: {name} loads", seconds, "s", goal="<= 1", how=how)
    with TemporaryDirectory() as folder:
        rows = [_copies(number, _triangle(Path(folder))) for number in COUNTS]
    report.table(
        f"Python's time by the number of copies, best of {ROUNDS}, ms",
        ("copies", "place()", "frame: all move", "frame: all rest", "WebGPU calls", "MiB of moved copies"),
        [(f"{r[0]:,}", *(f"{x:.3g}" for x in r[1:4]), r[4], f"{64 * r[0] / 2**20:.3g}") for r in rows],
    )
    by = {row[0]: row for row in rows}
    for number, column, what, goal in (
        (1_000, 2, "1,000 copies that move", "<= 0.5"),
        (10_000, 2, "10,000 copies that move", "<= 2"),
        (100_000, 3, "100,000 copies that rest", "<= 0.1"),
    ):
        how = "packing and handing over, beside place()" if column == 2 else "finding that nothing moved"
        report.add(f"models: Python a frame, {what}", by[number][column], "ms", goal=goal, how=how)
    spread = max(r[4] for r in rows) - min(r[4] for r in rows)
    report.add("models: calls that copies add", spread, "", goal="<= 0", how="1 to 100,000 copies")
    for name, distance, share in (("glider", 9.0, "a twelfth"), ("ship", 4000.0, "a sixth")):
        ms = _pass_ms(name, distance)
        if ms is not None:
            how = f"GPU time of the draw over {share} of {SIZE[0]}x{SIZE[1]}, best of {ROUNDS}"
            report.add(f"models: {name} into the G-buffer", ms, "ms", how=how)


def _best(function, before=lambda: None) -> float:
    """Milliseconds of the best of some calls, each after `before`, which does not count."""
    times = []
    for _ in range(ROUNDS):
        before()
        start = time.perf_counter()
        function()
        times.append(time.perf_counter() - start)
    return 1e3 * min(times)


def _triangle(folder: Path) -> Path:
    """A model of one triangle: what copies cost Python, and not what they cost to draw."""
    corners = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0)], np.float32).tobytes()
    data = "data:application/octet-stream;base64," + b64encode(corners).decode()
    tree = {
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
        "bufferViews": [{"buffer": 0, "byteLength": len(corners)}],
        "buffers": [{"byteLength": len(corners), "uri": data}],
    }
    path = folder / "triangle.gltf"
    path.write_text(json.dumps(tree))
    return path


def _copies(number: int, file: Path) -> tuple[int, float, float, float, int]:
    """Copies all over a region of 40 km."""
    world = fs.World(
        camera={"height": 500.0, "above": "sea"},
        models=[{"file": str(file), "above": "sea", "capacity": number}],
    )
    rng = np.random.default_rng(0)
    east, north = rng.uniform(-2e4, 2e4, number), rng.uniform(-4e4, -1e3, number)
    turn = rng.uniform(0.0, 360.0, number)
    with fs.Renderer(world, SIZE, "low", samples=1) as renderer:
        thing, frames = renderer.models["triangle"], count(1)

        def place() -> None:
            thing.place(east=east, north=north, height=1000.0 + turn, heading=turn, above="sea")

        def update() -> None:
            index = next(frames)
            renderer.models.latch(index, False)
            renderer.pipeline.models.update(renderer.state(index))

        place()
        renderer.render(0)
        calls = renderer.stats()["calls"]
        placing, moving = _best(place), _best(update, place)
        update()  # "before" catches up
        return number, placing, moving, _best(update), calls


def _pass_ms(name: str, distance: float) -> float | None:
    world = fs.World(
        camera={"height": 1000.0, "above": "sea", "fov": 35.0},
        models=[{"file": name, "above": "sea", "height": 1000.0, "north": distance, "heading": 60.0}],
    )
    best = []
    with fs.Renderer(world, SIZE, "low", samples=1) as renderer:
        renderer.pass_times = True
        for index in range(ROUNDS):
            renderer.render(index)
            passes = {p["name"]: p["gpu_ms"] for p in renderer.stats()["passes"]}
            best.append(passes["models.gbuffer"])
    return None if None in best else min(best)
