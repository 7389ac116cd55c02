"""What a whole frame costs in steady state: frames per second, what dominates, and what Python adds."""

import os
import time
from statistics import median

import fallstreak as fs

SIZE = (640, 360)
WARM_UP, MEASURED = 10, 60


def run(report):
    world = fs.load("jacksboro")
    with fs.Renderer(world, size=SIZE, quality="low") as renderer:
        for index in range(WARM_UP):
            renderer.render(index)
        walls, python, stats = [], [], []
        for index in range(WARM_UP, WARM_UP + MEASURED):
            start, thread = time.perf_counter(), time.thread_time()
            pending = renderer.submit(index)
            python.append(time.thread_time() - thread)
            pending.result()
            walls.append(time.perf_counter() - start)
            stats.append(renderer.stats())
        renderer.pass_times = True
        apart = []
        for index in range(WARM_UP + MEASURED, WARM_UP + 2 * MEASURED):
            renderer.render(index)
            apart.append(renderer.stats())
    how = f"jacksboro {SIZE[0]}x{SIZE[1]} low, sequence, median of {MEASURED} frames after {WARM_UP}"
    threads = os.environ.get("LP_NUM_THREADS", "all")
    report.add(
        "frames per second",
        1 / median(walls),
        "1/s",
        goal=">= 10",
        how=f"{how}; from render() to the 8-bit picture as numpy; software threads: {threads}",
    )
    _what_dominates(report, apart, median(walls))
    report.add(
        "Python time per frame: recording and submitting",
        median(s["cpu_ms"] for s in stats),
        "ms",
        goal="<= 2",
        how=f"{how}; wall clock of FrameGraph.execute: uniforms, all passes, read-back, submit",
    )
    report.add(
        "Python time per frame: the same and updating sun, camera and systems",
        median(python) * 1e3,
        "ms",
        how=f"{how}; processor time of Renderer.submit",
    )
    _calls(report, world)


def _what_dominates(report, stats, wall):
    """Prints median times of every pass, dearest first, and how much of the frame the dearest take.

    Passes were recorded one by one for it; in the frames that are timed as a whole, neighbours share one of
    the GPU's.
    """
    names = [p["name"] for p in stats[-1]["passes"]]
    rows = []
    for index, name in enumerate(names):
        gpu = median(s["passes"][index]["gpu_ms"] or 0.0 for s in stats)
        cpu = median(s["passes"][index]["cpu_ms"] for s in stats)
        ran = sum(s["passes"][index]["ran"] for s in stats) / len(stats)
        rows.append((name, gpu, cpu, f"{ran:.0%}"))
    rows.sort(key=lambda row: -row[1])
    report.table("passes (median, recorded one by one)", ("pass", "GPU ms", "CPU ms", "of frames"), rows)
    total = sum(row[1] for row in rows)
    share = " + ".join(f"{name} {gpu:.1f} ms" for name, gpu, _, _ in rows[:3])
    report.note(f"dominant: {share} of {total:.1f} ms in passes; whole frame {wall * 1e3:.1f} ms")


def _calls(report, world):
    """The same frame with few and with many terrain nodes and stars must cost Python the same calls."""
    few = world.updated({"terrain.source": "fractal", "terrain.extent": 2e3, "sky.star_magnitude_limit": 1.0})
    many = world.updated(
        {"terrain.source": "fractal", "terrain.extent": 160e3, "sky.star_magnitude_limit": 6.5}
    )
    counts = []
    for variant in (few, many):
        with fs.Renderer(variant, size=(160, 90), quality="low") as renderer:
            for index in range(4):
                renderer.render(index)
            counts.append(renderer.stats()["calls"])
    report.add(
        "WebGPU calls per frame", counts[1], "calls", how="steady state, 160 km of terrain, stars to 6.5 mag"
    )
    report.add(
        "WebGPU calls that more terrain nodes and stars add",
        counts[1] - counts[0],
        "calls",
        goal="== 0",
        how="the same with 2 km of terrain and stars to 1.0 mag, subtracted",
    )
