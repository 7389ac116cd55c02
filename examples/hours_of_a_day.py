"""One place through a day: nine hours on one sheet.

A world is frozen data: every hour is a new one, made from the first by `updated`. Writes hours.png.
"""

from datetime import timedelta

import numpy as np

import fallstreak as fs
from fallstreak.output import write_png

first = fs.load("jacksboro", ["time=2025-10-18T07:20:00-04:00", "camera.heading=150", "camera.fov=60"])
pictures = []
for step in range(9):
    hour = first.updated({"time": first.time + timedelta(minutes=90 * step)})
    frame = fs.render(hour, size=(480, 270), quality="medium", samples=4)
    pictures.append(frame.ldr)
    print(f"{hour.time:%H:%M}  EV {frame.metadata['ev100']:5.1f}")

columns = 3
rows = [np.hstack(pictures[i : i + columns]) for i in range(0, len(pictures) - columns + 1, columns)]
write_png("hours.png", np.vstack(rows or pictures))
