"""The sky as a measuring instrument: luminance over the sun's elevation, in clear and in hazy air.

A world made in Python, without a scene file: no terrain, a camera that looks straight up. `frame.hdr` is in
cd/m², free of exposure and tone, so the numbers can be put beside a luminance meter's.
"""

from datetime import UTC, datetime

import numpy as np

import fallstreak as fs

print("UTC      clear air   hazy air   (luminance of the zenith, cd/m²)")
for hour in range(4, 13):
    zenith = []
    for turbidity in (1.0, 5.0):
        world = fs.World(
            name="zenith",
            time=datetime(2025, 3, 20, hour, 30, tzinfo=UTC),
            place={"latitude": 50.0, "longitude": 0.0},
            sky={"turbidity": turbidity},
            camera={"pitch": 90.0, "fov": 10.0},
        )
        frame = fs.render(world, size=(64, 64), samples=1)
        red, green, blue = frame.hdr.mean(axis=(0, 1), dtype=np.float64)
        zenith.append(0.2126 * red + 0.7152 * green + 0.0722 * blue)
    print(f"{hour:02d}:30 {zenith[0]:12.4g} {zenith[1]:10.4g}")
