"""A flight along keyframes: a numbered sequence from Python.

`submit` starts a frame and returns at once, so that the last one is fetched and written while the next is
rendered. Writes flight/frame.0000.png and so on. On the command line `fallstreak render` does this too, and
can be stopped and resumed.
"""

from pathlib import Path

import fallstreak as fs

world = fs.load("jacksboro").updated(
    {
        "time_scale": 60,  # a minute of the evening passes in a second of the film
        "camera.keyframes": [
            {"at": 0, "east": 0, "north": 0, "height": 60, "heading": 235, "pitch": -2},
            {"at": 2, "east": -3000, "north": -2000, "height": 700, "heading": 245, "pitch": -8},
            {"at": 4, "east": -7000, "north": -3000, "height": 1500, "heading": 290, "pitch": -6},
        ],
    }
)
folder = Path("flight")
folder.mkdir(exist_ok=True)

with fs.Renderer(world, size=(640, 360), quality="medium", fps=24) as renderer:
    before = None
    for index in range(96):
        pending = renderer.submit(index)
        if before is not None:
            frame = before.result()
            frame.save(folder / f"frame.{frame.metadata['frame']:04d}.png")
        before = pending
    frame = before.result()
    frame.save(folder / f"frame.{frame.metadata['frame']:04d}.png")
