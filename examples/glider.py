"""A glider flown from Python: it circles in a thermal, and its transform is set anew for every frame.

The flight is a few lines of mechanics: a bank angle turns it, sinking costs height, rising air gives more.
The camera follows on keyframes made from the same flight. Writes glider/frame.0000.png and so on.
"""

from math import asin, cos, degrees, exp, hypot, radians, sin, tan
from pathlib import Path

import fallstreak as fs

FPS, SPEED, SINK = 24, 27.0, 0.8  # 1/s, m/s, m/s
THERMAL, WIDTH, LIFT = (120.0, 260.0), 140.0, 4.0  # m, m, m/s

flight = []
east, north, height, heading, bank = 0.0, 0.0, 780.0, radians(10.0), 0.0
for _ in range(-2 * FPS, 240):
    near = exp(-((hypot(east - THERMAL[0], north - THERMAL[1]) / WIDTH) ** 2))
    bank += (radians(36.0) * near - bank) / (0.8 * FPS)  # the pilot banks where the air rises, without haste
    heading += 9.81 * tan(bank) / SPEED / FPS
    climb = LIFT * near - SINK / cos(bank)
    east += SPEED * sin(heading) / FPS
    north += SPEED * cos(heading) / FPS
    height += climb / FPS
    flight.append(
        {
            "east": east,
            "north": north,
            "height": height,
            "heading": degrees(heading),
            "pitch": degrees(asin(climb / SPEED)) - 1.0,
            "roll": degrees(bank),
        }
    )

# the camera is where the glider was 0.9 s ago, a little higher, and looks where that flies now
keyframes = []
for frame in range(0, 241, 12):
    behind, ahead = flight[frame + 26], flight[min(frame + 40, len(flight) - 1)]
    keyframes.append(
        {
            "at": frame / FPS,
            "east": behind["east"],
            "north": behind["north"],
            "height": behind["height"] + 7.0,
            "heading": ahead["heading"] % 360.0,
            "pitch": -9.0,
            "roll": 0.3 * ahead["roll"],
        }
    )
world = fs.load("jacksboro").updated(
    {
        "time": "2025-10-18T16:30:00-04:00",
        "camera": {"above": "sea", "fov": 50.0, "keyframes": keyframes},
        "models": [{"file": "glider"}],
    }
)
folder = Path("glider")
folder.mkdir(exist_ok=True)
with fs.Renderer(world, size=(640, 360), quality="medium", fps=FPS) as renderer:
    glider = renderer.models["glider"]
    for index in range(240):
        glider.place(**flight[index + 2 * FPS], above="sea")
        renderer.render(index).save(folder / f"frame.{index:04d}.png")
