"""A climb from 1.7 m to 400 km: no dead pixels, and no jump where one method takes over from another."""

import numpy as np

import fallstreak as fs

SIZE, FRAMES = (160, 96), 200  # 96 = 12 tiles of 8
LOW, HIGH = 1.7, 400e3
FLOOR = 1e-6  # cd/m²: darker than the darkest night sky, so a dead pixel and no dark one


def run(report):
    world = fs.load("jacksboro").updated(
        {
            "time": "2024-06-21T18:30:00Z",  # noon at Jacksboro: the whole way in daylight
            "camera.pitch": -10.0,
            "camera.fov": 60.0,
            "camera.keyframes": (),
            "camera.above": "ground",
            "film.exposure": "fixed",
            "film.ev100": 15.0,
            "sky.stars": False,
        }
    )
    heights = np.geomspace(LOW, HIGH, FRAMES)
    # The camera keeps the horizon in its place: else its moving by would be all there is to see.
    dips = np.degrees(np.arccos(world.planet.radius / (world.planet.radius + heights)))
    keyframes = [
        {"at": float(i), "height": float(h), "pitch": float(-10.0 - dip)}
        for i, (h, dip) in enumerate(zip(heights, dips, strict=True))
    ]
    world = world.updated({"camera.keyframes": keyframes, "time_scale": 0.0})
    bad = dead = 0
    means, tiles = [], []
    with fs.Renderer(world, size=SIZE, quality="low", fps=1, layers=("hdr",)) as renderer:
        for index in range(FRAMES):
            luminance = renderer.render(index).hdr @ (0.2126, 0.7152, 0.0722)
            bad += int(np.count_nonzero(~np.isfinite(luminance)))
            # Space over the limb is black by right: dead is a dark pixel with bright neighbours on all sides.
            dead += _holes(np.nan_to_num(luminance))
            means.append(luminance.mean())
            tiles.append(luminance.reshape(SIZE[1] // 8, 8, SIZE[0] // 8, 8).mean(axis=(1, 3)))
    how = (
        f"{FRAMES} frames, {LOW} m to {HIGH / 1e3:g} km by equal factors, noon, {SIZE[0]}x{SIZE[1]} low, HDR"
    )
    report.add("climb: values not finite", bad, "", goal="== 0", how=how)
    report.add(
        "climb: dead pixels", dead, "", goal="== 0", how=how + "; dark with all eight neighbours bright"
    )
    means, tiles = np.array(means), np.array(tiles)
    jumps = np.abs(np.diff(means)) / np.maximum(means[1:], means[:-1])
    worst = int(jumps.argmax())
    report.add(
        "climb: largest change of mean luminance",
        jumps.max() * 100,
        "%",
        how=f"{how}; from one frame to the next, here at {heights[worst]:.0f} m",
    )
    # A climb changes the picture steadily; a hand-over between methods would show as a jolt.
    jolts = np.abs(np.diff(means, 2)) / means[1:-1]
    report.add(
        "climb: largest jolt of mean luminance",
        jolts.max() * 100,
        "%",
        how=f"{how}; second difference from frame to frame, at {heights[1 + int(jolts.argmax())]:.0f} m",
    )
    changes = np.abs(np.diff(tiles, axis=0)) / means[:-1, None, None]
    worst = int(changes.max(axis=(1, 2)).argmax())
    report.add(
        "climb: largest change of an 8x8 tile",
        changes.max() * 100,
        "% of the mean",
        how=f"{how}; from one frame to the next, here at {heights[worst]:.0f} m",
    )


def _holes(luminance):
    neighbours = np.stack(
        [
            luminance[1 + dy : luminance.shape[0] - 1 + dy, 1 + dx : luminance.shape[1] - 1 + dx]
            for dy in (-1, 0, 1)
            for dx in (-1, 0, 1)
            if (dy, dx) != (0, 0)
        ]
    )
    return int(np.count_nonzero((luminance[1:-1, 1:-1] <= FLOOR) & (neighbours.min(axis=0) > 1.0)))
