"""The ground: cost of its passes, its mesh against float64, holes, popping, Python's share, queries."""

from __future__ import annotations

import sys
import time
from pathlib import Path

import numpy as np

import fallstreak as fs

sys.path.insert(0, str(Path(__file__).parent))

import terrain_looks
from terrain_stage import Stage

VIEWS = {
    "1.7 m": (0.0, 0.0, 1.7, 135.0, -3.0),
    "200 m": (0.0, 0.0, 200.0, 135.0, -8.0),
    "5 km": (0.0, -10e3, 5e3, 0.0, -22.0),
    "30 km": (0.0, -30e3, 30e3, 0.0, -30.0),
    "400 km": (0.0, -200e3, 400e3, 0.0, -35.0),
}
SIZE, ROUNDS = (640, 360), 5
CROWDS = (  # quality, size, view, vertical field of view, plants at least
    ("high", SIZE, VIEWS["200 m"], 45.0, None),
    ("ultra", (1280, 720), (-8e3, -8e3, 900.0, 0.0, -90.0), 100.0, 100_000),
)
PASSES = ("selection", "heights", "mesh", "gbuffer", "globe")


def run(report):
    """`fallstreak bench terrain`."""
    from fallstreak.gpu import Device

    device = Device.open()
    _build(report)
    _costs(report, device)
    _plants(report, device)
    _queries(report)
    terrain_looks.screen_error(report, device)
    terrain_looks.cracks(report, device)
    terrain_looks.popping(report, device)


def _build(report):
    from fallstreak.terrain.model import terrain_model

    start = time.perf_counter()
    model = terrain_model(fs.load("jacksboro"))
    report.add(
        "terrain: time to build", time.perf_counter() - start, "s", goal="<= 3", how="jacksboro, all levels"
    )
    report.add("terrain: levels", model.land.pyramid.nbytes / 2**20, "MiB", goal="<= 48", how="GPU memory")


def _costs(report, device):
    stage = Stage(device, "jacksboro", "low", SIZE)
    clip = stage.terrain.clip.clip
    texels = clip.levels * (32 * clip.tiles) ** 2
    report.add(
        "terrain: clipmap",
        (8 + 8 + 4 + 4 + 4) * texels / 2**20,
        "MiB",
        how=f"GPU memory, {clip.levels} levels of {32 * clip.tiles}², {SIZE[0]}x{SIZE[1]} low",
    )
    rows = []
    for name, view in VIEWS.items():
        state = stage.pose(*view)
        stage.draw(stage.pose(60e3, 60e3, 1000.0, 0.0, -10.0))  # so that all tiles are new
        walls, python, steady = [], [], []
        for _ in range(1 + ROUNDS):
            stage.graph.stats()  # waits
            start = time.perf_counter()
            python.append(stage.draw(state))
            steady.append(stage.costs())
            walls.append((time.perf_counter() - start) * 1e3)
        cost = {p: min(s[p] for s in steady[1:]) for p in PASSES}
        nodes, triangles = stage.nodes()
        count = stage.hold(state)
        error = max(
            _vertex_error(stage, slot) for slot in np.linspace(0, count - 1, min(count, 10)).astype(int)
        )
        new = walls[0] - min(walls[1:])
        rows.append((name, len(nodes), triangles, new, *cost.values(), error, float(np.median(python[1:]))))
    report.table(
        f"Ground of jacksboro, {SIZE[0]}x{SIZE[1]} low, ms, best of {ROUNDS}; new: all tiles of the clipmap",
        ("camera", "nodes", "tris", "new", "select", "heights", "mesh", "draw", "globe", "err m", "Python"),
        [(r[0], r[1], r[2], *(f"{x:.2g}" for x in r[3:])) for r in rows],
    )
    how = f"{SIZE[0]}x{SIZE[1]} low, best of {ROUNDS}, worst of the heights {', '.join(VIEWS)}"
    cost = max(sum(r[4:9]) for r in rows)
    report.add("terrain: cost of its passes", cost, "ms", goal="<= 35", how=how + ", camera at rest")
    report.add("terrain: all tiles new", max(r[3] for r in rows), "ms", how=how + "; wall clock")
    report.add("terrain: triangles", max(r[2] for r in rows), "", how=how)
    report.add("terrain: nodes", max(r[1] for r in rows), "", how=how)
    report.add(
        "terrain: vertices against float64",
        max(r[9] for r in rows),
        "m",
        goal="<= 0.02",
        how="largest difference of a height within 2 km of the camera",
    )
    report.add("terrain: Python time of a frame", max(r[10] for r in rows), "ms", goal="<= 2", how=how)


def _vertex_error(stage, slot):
    from fallstreak.terrain.selection import morphed, vertex_shape

    vertices = morphed(stage._frame, stage._nodes[slot], stage.quality.terrain_grid)
    near = np.hypot(*vertices.offset.T) < 2e3
    expected, _ = vertex_shape(stage.model, stage.terrain.clip.spacing, vertices)
    held = stage._heights[slot, :, 0].copy().view(np.float32)
    return float(np.abs(held - expected)[near].max(initial=0.0))


def _plants(report, device):
    """A view that holds a hundred thousand plants; few and many cost Python the same calls."""
    for quality, size, view, fov, least in CROWDS:
        found = []
        for density in (0.02, 1.0):
            stage = Stage(device, "jacksboro", quality, size, [f"terrain.vegetation={density}"])
            state = stage.pose(*view, fov=fov)
            python = [stage.draw(state) for _ in range(6)]
            plants = int(stage.read("plants.draws").view(np.uint32).reshape(-1, 5)[:, 1].sum())
            found.append((plants, stage.graph.stats()["calls"], min(python), stage.costs()["plants"]))
        (few, calls, _, _), (many, more, python, cost) = found
        name = f"from {view[2]:g} m at {quality}"
        how = f"jacksboro, {size[0]}x{size[1]}, {fov:g} degrees high"
        goal = {"goal": f">= {least}"} if least else {}
        report.add(f"terrain: plants drawn {name}", many, "", how=how, **goal)
        report.add(f"terrain: cost of the plants {name}", cost, "ms", how=f"{many} of them, all their passes")
        report.add(f"terrain: Python time of a frame with plants {name}", python, "ms", goal="<= 2", how=how)
        report.add(
            f"terrain: WebGPU calls that more plants add {name}",
            more - calls,
            "calls",
            goal="== 0",
            how=f"{few} and {many} plants, {more} calls",
        )


def _queries(report):
    world = fs.load("jacksboro")
    rng = np.random.default_rng(3)
    east, north = rng.uniform(-9e3, 9e3, (2, 100_000))
    for name in ("height", "normal", "materials"):
        ask = getattr(world.terrain, name)
        ask(east[:10], north[:10])
        start = time.perf_counter()
        ask(east, north)
        micro = (time.perf_counter() - start) * 10.0
        report.add(f"terrain: query {name}", micro, "us", how="per place, 100,000 at once, jacksboro")
    radius = world.planet.radius
    from fallstreak.world.state import position_on_planet

    origin = position_on_planet(0.0, 0.0, float(world.terrain.height(0.0, 0.0)) + 200.0, radius)
    angle = rng.uniform(-0.4, 0.4, 2000)
    ray = np.stack([np.sin(angle), np.cos(angle), rng.uniform(-0.4, 0.02, 2000)], 1)
    for how in ("first", "again"):
        start = time.perf_counter()
        world.terrain.ray(origin, ray)
        report.add(
            f"terrain: query ray, {how}",
            (time.perf_counter() - start) * 500.0,
            "us",
            how="per ray, 2,000 at once",
        )
