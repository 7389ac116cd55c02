"""Synthetic data: pictures of random moments and views, each with depth, normals and a mask of the sky.

The same seed gives the same data on the same graphics adapter. Writes labelled/view.00.npz (for numpy),
labelled/view.00.png (to look at: picture, depth, normals side by side) and so on.
"""

from datetime import timedelta
from pathlib import Path

import numpy as np

import fallstreak as fs
from fallstreak.output import write_png

rng = np.random.default_rng(seed=1)
scene = fs.load("jacksboro")
folder = Path("labelled")
folder.mkdir(exist_ok=True)

for number in range(6):
    world = scene.updated(
        {
            "time": scene.time - timedelta(hours=float(rng.uniform(0, 9))),
            "sky.turbidity": float(rng.uniform(1, 6)),
            "camera.height": float(rng.uniform(30, 1500)),
            "camera.heading": float(rng.uniform(0, 360)),
            "camera.pitch": float(rng.uniform(-25, 5)),
        }
    )
    frame = fs.render(world, size=(512, 288), layers=("hdr", "depth", "normal"))
    frame.save(folder / f"view.{number:02d}.npz")

    sky = np.isinf(frame.depth)
    nearness = np.where(sky, 0.0, np.clip(1.0 - np.log10(frame.depth / frame.depth.min()) / 3, 0.1, 1.0))
    depth = np.repeat((255 * nearness).astype(np.uint8)[..., None], 3, axis=2)
    normal = (127.5 + 127.5 * frame.normal).astype(np.uint8)
    write_png(folder / f"view.{number:02d}.png", np.hstack([frame.ldr, depth, normal]))
    print(f"view {number}: {sky.mean():4.0%} sky, nearest ground {frame.depth.min():.0f} m")
