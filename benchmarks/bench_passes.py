"""What the passes after the ground cost: a day in `low` and `high`, a night, and the moon from near."""

from math import asin, atan2, degrees, radians
from statistics import median

import fallstreak as fs

SIZE, CLOSE_UP, WARM_UP, MEASURED = (640, 360), (640, 640), 6, 25
GROUPS = {
    "lighting": "frame.lighting",
    "temporal anti-aliasing": "frame.temporal",
    "meter": "frame.meter",
    "exposure": "frame.exposure",
    "bloom": "frame.bloom",
    "tone map": "frame.tonemap",
    "airglow and Milky Way": "sky.night",
    "stars": "sky.stars",
    "moon": "sky.moon",
}


def run(report):
    night = fs.load("night")
    columns = {
        "day low": _costs(fs.load("jacksboro"), "low"),
        "day high": _costs(fs.load("jacksboro"), "high"),
        "night high": _costs(night, "high"),
        "moon close-up": _costs(_at_the_moon(night), "high", CLOSE_UP),
    }
    rows = [(name, *(column[name] for column in columns.values())) for name in GROUPS]
    report.table(f"GPU ms, median of {MEASURED} frames after {WARM_UP}", ("pass", *columns), rows)
    how = f"{SIZE[0]}x{SIZE[1]}, median of {MEASURED} frames after {WARM_UP}, timestamps around its passes"
    for name in ("airglow and Milky Way", "stars", "moon"):
        report.add(f"passes: {name}", columns["night high"][name], "ms", how=f"night, high, {how}")
    how = f"0.6° of the sky on {CLOSE_UP[0]}x{CLOSE_UP[1]}, median of {MEASURED} frames after {WARM_UP}"
    report.add("passes: moon close-up", columns["moon close-up"]["moon"], "ms", how=how)


def _costs(world, quality, size=SIZE):
    """Milliseconds of every group of passes; 0 where none of them ran."""
    with fs.Renderer(world, size=size, quality=quality) as renderer:
        renderer.pass_times = True
        frames = []
        for index in range(WARM_UP + MEASURED):
            renderer.render(index)
            frames.append([(p["name"], p["gpu_ms"] or 0.0) for p in renderer.stats()["passes"] if p["ran"]])
    return {
        group: median(sum(ms for name, ms in frame if name.startswith(start)) for frame in frames[WARM_UP:])
        for group, start in GROUPS.items()
    }


def _at_the_moon(world):
    """The same night through a telescope."""
    from fallstreak.sky.ephemeris import Ephemeris

    place = Ephemeris(radians(world.place.latitude), radians(world.place.longitude))
    east, north, up = place.at(world.time).moon_direction
    heading, pitch = degrees(atan2(east, north)) % 360.0, degrees(asin(up))
    return world.updated({"camera.heading": heading, "camera.pitch": pitch, "camera.fov": 0.6})
