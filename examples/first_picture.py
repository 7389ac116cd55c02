"""A shipped scene, an hour of your choice, one picture.

Writes evening.png, and prints what the light in it measured.
"""

import fallstreak as fs

world = fs.load("jacksboro", ["time=2025-10-18T18:35:00-04:00", "sky.turbidity=3"])
frame = fs.render(world, size=(960, 540), samples=8)
frame.save("evening.png")

sky = frame.hdr[:100].mean(axis=(0, 1))
print("the sky at the upper edge:", " ".join(f"{value:.0f}" for value in sky), "cd/m² of red, green, blue")
print("the picture was exposed at EV", frame.metadata["ev100"])
