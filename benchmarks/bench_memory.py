"""What a long sequence does to the process's memory, and what a large picture takes on the GPU."""

import gc
import os
from pathlib import Path

import fallstreak as fs

FRAMES, SETTLED = 300, 50


def run(report):
    world = fs.load("jacksboro")
    with fs.Renderer(world, size=(160, 90), quality="low") as renderer:
        sizes = []
        for index in range(FRAMES):
            renderer.render(index)
            if index >= SETTLED:
                sizes.append(_resident_bytes())
    gc.collect()
    report.add(
        "memory growth over a sequence",
        (max(sizes) - sizes[0]) / 1e6,
        "MB",
        goal="< 5",
        how=f"resident, largest of frames {SETTLED} to {FRAMES} less frame {SETTLED}; jacksboro 160x90 low",
    )
    with fs.Renderer(world, size=(1280, 720), quality="high") as renderer:
        for index in range(2):
            renderer.render(index)
        stats = renderer.stats()
    for kind in ("texture", "buffer"):
        report.add(f"GPU {kind} bytes", stats[f"{kind}_bytes"] / 1e6, "MB", how="jacksboro 1280x720 high")
    report.add(
        "GPU bytes",
        (stats["texture_bytes"] + stats["buffer_bytes"]) / 1e6,
        "MB",
        goal="< 512",
        how="all textures and buffers alive, jacksboro 1280x720 high",
    )


def _resident_bytes() -> int:
    try:
        return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")
    except OSError:  # not Linux: the peak is all there is
        import resource
        import sys

        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * (1 if sys.platform == "darwin" else 1024)
