"""Clouds: what the techniques cost and how well they keep to the field, beside the goals of each."""

import time
from contextlib import ExitStack
from statistics import median

import numpy as np

import fallstreak as fs

TECHNIQUES = ("sprites", "puffs", "spheres")
# m east and north, degrees
PUFF_PLACES = (
    (0.0, 0.0, 20.0),
    (90e3, 40e3, 110.0),
    (-80e3, 70e3, 200.0),
    (30e3, -100e3, 290.0),
    (-60e3, -50e3, 65.0),
)
SMALL = (320, 180)


def run(report):
    _cost(report)
    _ring(report)
    _flight(report)
    _puffs(report)
    _glider(report)
    _agreement(report)
    _many(report)


def _frames(world, *, size, quality="low", warm=6, count=12, apart=False, fps=30.0):
    """Seconds of each of `count` frames, the last statistics and counters of the technique."""
    with fs.Renderer(world, size=size, quality=quality, fps=fps) as renderer:
        renderer.pass_times = apart
        for index in range(warm):
            renderer.render(index)
        walls, stats = [], []
        for index in range(warm, warm + count):
            start = time.perf_counter()
            renderer.render(index)
            walls.append(time.perf_counter() - start)
            stats.append(renderer.stats())
        counts = renderer.pipeline.clouds.technique.counts() if world.clouds.layers else {}
    return walls, stats, counts


def _spent(stats, prefix="clouds."):
    """Median over frames of the GPU's ms in passes whose name begins so."""
    return median(sum(p["gpu_ms"] or 0.0 for p in s["passes"] if p["name"].startswith(prefix)) for s in stats)


def _cost(report):
    """The same sky in each technique: whole frame, the clouds' passes, Python, memory."""
    rows = []
    for scene in ("towering", "overcast"):
        for technique in TECHNIQUES:
            world = fs.load(scene, [f"clouds.technique={technique}"])
            walls, _, counts = _frames(world, size=(640, 360))
            _, apart, _ = _frames(world, size=(640, 360), apart=True)
            bare = fs.load(scene, ["clouds.layers=[]"])
            without, _, _ = _frames(bare, size=(640, 360))
            gpu = _spent(apart) + _spent(apart, "frame.clouds")
            rows.append((f"{scene}, {technique}", 1e3 * median(walls), 1e3 * median(without), gpu))
            report.note(f"{scene}, {technique}: {counts}")
    report.table(
        "640x360 low, ms (median of 12)",
        ("scene, technique", "frame", "without clouds", "clouds' passes"),
        rows,
    )


def _ring(report):
    """Sprites: the same sky with the ring and without, frame by frame in turn, and without any clouds."""
    difference = 0.0
    for coverage in (0.25, 0.5, 1.0):
        world = fs.load("overcast", ["clouds.technique=sprites"])
        layers = [x.model_dump(exclude_defaults=True) | {"oktas": 8 * coverage} for x in world.clouds.layers]
        world = world.updated({"clouds.layers": layers})
        without = world.updated({"clouds.sprites.ring": False})
        bare = world.updated({"clouds.layers": []})
        walls, pictures = _in_turn([world, without, bare], size=(1280, 720), count=8)
        ring, direct, rest = (median(own) for own in walls)
        how = "overcast, sprites, 1280x720 low, medians of 8 frames, drawn in turn"
        report.add(
            f"frame time without the ring over with it, coverage {coverage:g}",
            direct / ring,
            "",
            goal=">= 3" if coverage == 1.0 else None,
            how=how,
        )
        report.add(
            f"what clouds add to a frame, without the ring over with it, coverage {coverage:g}",
            (direct - rest) / max(ring - rest, 1e-6),
            "",
            how=f"{how}; a frame without clouds taken off both",
        )
        difference = max(difference, float(np.abs(pictures[0] - pictures[1]).mean()))
    report.add(
        "mean difference of the pictures with and without the ring",
        difference,
        "of 255",
        goal="<= 2",
        how="the same frames of these sequences, 8-bit pictures, the worst of the three coverages",
    )
    radius = fs.load("overcast").clouds.sprites.ring_radius
    for scene in ("overcast", "hundred_miles"):
        # all within the second frame that nobody sees, to just before another ring is begun
        way = [{"at": 0, "north": 0.0}, {"at": 0.01, "north": 0.145 * radius}]
        world = fs.load(scene, ["clouds.technique=sprites"]).updated({"camera.keyframes": way})
        _, pictures = _in_turn(
            [world, world.updated({"clouds.sprites.ring": False})], size=(640, 360), warm=1, count=1
        )
        report.add(
            f"mean difference where a ring is oldest, {scene}",
            float(np.abs(pictures[0] - pictures[1]).mean()),
            "of 255",
            how="640x360 low, the camera 14.5 % of the radius from the ring's middle",
        )
    seam, beside = _seams()
    report.add(
        "difference about the seams of the octagon over that beside them",
        seam / beside,
        "",
        goal="<= 1.5",
        how=f"hundred_miles, mean of eight headings, 320x180 high: {seam:.2f} of 255 within two pixels",
    )


def _in_turn(worlds, *, size, count, warm=4):
    """Seconds of `count` frames of each of some worlds, drawn in turn, and their last pictures."""
    with ExitStack() as stack:
        renderers = [stack.enter_context(fs.Renderer(w, size=size, quality="low")) for w in worlds]
        walls, pictures = [[] for _ in worlds], [None] * len(worlds)
        for index in range(warm + count):
            for which, renderer in enumerate(renderers):
                start = time.perf_counter()
                pictures[which] = renderer.render(index).ldr.astype(float)
                walls[which].append(time.perf_counter() - start)
    return [own[warm:] for own in walls], pictures


def _seams():
    """Mean differences, ring and no ring, within two pixels of the octagon's seams and beside them."""
    headings = [{"at": float(k), "heading": 22.5 + 45.0 * k} for k in range(8)]
    world = fs.load("hundred_miles", ["clouds.technique=sprites", "camera.fov=30", "camera.pitch=2"])
    world = world.updated({"camera.keyframes": headings})
    pictures = []
    for ring in (True, False):
        own = world.updated({"clouds.sprites.ring": ring})
        with fs.Renderer(own, size=(320, 180), quality="high", fps=1) as renderer:
            pictures.append([renderer.render(k).ldr.astype(float) for k in range(8)])
    columns = np.abs(np.subtract(*pictures)).mean((0, 1, 3))
    return columns[158:162].mean(), np.delete(columns[138:182], np.s_[18:26]).mean()


def _flight(report):
    """Sprites with the ring at 150 m/s: whether new rings stall a frame."""
    way = [{"at": 0, "north": 0.0}, {"at": 10, "north": 1500.0}]
    for update in ("side", "block"):
        world = fs.load("overcast", ["clouds.technique=sprites", f"clouds.sprites.ring_update={update}"])
        world = world.updated({"camera.height": 1200.0, "camera.above": "sea", "camera.keyframes": way})
        walls, work, drawing = [], [], []
        with fs.Renderer(world, size=(640, 360), quality="low", fps=15.0) as renderer:
            renderer.render(0)  # brings everything up
            for index in range(1, 121):
                start, begin = time.perf_counter(), time.process_time()
                renderer.render(index)
                walls.append(time.perf_counter() - start)
                work.append(time.process_time() - begin)
                drawing.append(bool(renderer.pipeline.clouds.technique.ring.plan.parts))
        how = f"overcast, sprites, ring_update {update}, 640x360 low, 120 frames at 15 per second"
        report.add(
            f"99th percentile over median of frame times at 150 m/s, {update}",
            float(np.percentile(walls, 99) / median(walls)),
            "",
            goal="<= 1.5" if update == "side" else None,
            how=how,
        )
        work, drawing = np.array(work), np.array(drawing)
        report.add(
            f"processor time of frames that draw a part of a ring over that of others, {update}",
            float(np.median(work[drawing]) / np.median(work[~drawing])),
            "",
            how=f"{how}; medians of {drawing.sum()} and {(~drawing).sum()} frames; means little on a GPU",
        )


def _puffs(report):
    """Number of puffs, what buckets save, and the largest change of a tile on a flight and a climb."""
    base = fs.load("hundred_miles", ["clouds.technique=puffs"])
    drawn, saved = {}, []
    views = {
        "visibility 10 km": {"clouds.visibility": 1e4},
        "visibility 40 km": {"clouds.visibility": 4e4},
        "visibility 160 km": {},
        "from 400 km up": {"camera.height": 4e5, "camera.pitch": -25.0},
    }
    # a short view may be all gap: several places stand for the sky
    places = [
        {"camera.east": east, "camera.north": north, "camera.heading": heading}
        for east, north, heading in PUFF_PLACES
    ]
    for name, changes in views.items():
        each = [
            _frames(base.updated({**changes, **place}), size=SMALL, warm=1, count=1)[2]["drawn"]
            for place in places
        ]
        drawn[name] = float(np.mean(each))
        how = f"hundred_miles, mean of five places from {min(each)} to {max(each)}"
        report.add(f"puffs drawn, {name}", drawn[name], "", goal="<= 30000", how=how)
    middle = (max(drawn.values()) + min(drawn.values())) / 2
    report.add(
        "puffs drawn: how far the extremes are from their middle",
        100 * (max(drawn.values()) - middle) / middle,
        "%",
        goal="<= 20",
        how="over the four views above",
    )
    for heading in range(0, 360, 45):
        _, _, counts = _frames(base.updated({"camera.heading": float(heading)}), size=SMALL, warm=3, count=1)
        saved.append(counts["buckets"] / max(counts["buckets_in_sight"], 1))
    report.add(
        "buckets over buckets in sight, mean over headings",
        float(np.mean(saved)),
        "",
        goal=">= 2",
        how="hundred_miles, eight headings",
    )
    ways = {
        "60 frames at 150 m/s": {"camera.keyframes": [{"at": 0, "north": 0.0}, {"at": 2, "north": 300.0}]},
        # away from the sun, whose disc would be the largest change where thin cloud leaves it
        "240 frames from 2 to 400 km": {
            "camera.heading": 95.0,
            "camera.keyframes": [
                {"at": 8 * i / 48, "height": 2e3 * 200 ** (i / 48), "pitch": -7 - 23 * i / 48}
                for i in range(49)
            ],
        },
    }
    for name, changes in ways.items():
        worst = _largest_change(base.updated(changes), 60 if "60" in name else 240)
        report.add(
            f"puffs: largest change of an 8x8 tile, {name}", worst, "of 255", how="320x180 low, 30 per second"
        )


def _largest_change(world, count):
    worst, before = 0.0, None
    with fs.Renderer(world, size=SMALL, quality="low", fps=30) as renderer:
        for index in range(count):
            picture = renderer.render(index).ldr.astype(float).mean(2)
            tiles = picture[: 8 * (SMALL[1] // 8)].reshape(SMALL[1] // 8, 8, SMALL[0] // 8, 8).mean((1, 3))
            if before is not None:
                worst = max(worst, float(np.abs(tiles - before).max()))
            before = tiles
    return worst


def _glider(report):
    world = fs.load("canyon_glider")
    walls, _, _ = _frames(world, size=(640, 360))
    _, apart, counts = _frames(world, size=(640, 360), apart=True)
    how = "canyon_glider, 640x360 low, median of 12 frames"
    report.add("frames per second of canyon_glider", 1 / median(walls), "1/s", goal=">= 30", how=how)
    report.add(
        "GPU time of its clouds",
        _spent(apart) + _spent(apart, "frame.clouds"),
        "ms",
        how=f"{how}; passes one by one; {counts}",
    )


def _agreement(report):
    """Where the field's optical depth is over 1, a technique should draw opacity over .6."""
    base = fs.load("towering")
    depth = None
    for technique in TECHNIQUES:
        world = base.updated({"clouds.technique": technique})
        frame = fs.render(world, size=(160, 90), quality="high", samples=1, layers=("clouds", "depth"))
        if depth is None:
            depth = _optical_depth(world, (160, 90), frame.depth)
        field, drawn = depth > 1.0, frame.clouds > 0.6
        union = (field | drawn).sum()
        report.add(
            f"agreement of {technique} with the field",
            float((field & drawn).sum() / union),
            "",
            goal=">= 0.7",
            how="towering, 160x90: intersection over union of optical depth > 1 and opacity > .6",
        )


def _optical_depth(world, size, reach):
    """Optical depth of the field along the middle of every pixel's ray, to what lies behind or 80 km."""
    from fallstreak.world.state import map_coordinates

    with fs.Renderer(world, size=size, quality="low", still=True) as renderer:
        state = renderer.state(0)
    width, height = size
    t = np.tan(state.camera.fov / 2)
    x = (2 * (np.arange(width) + 0.5) / width - 1) * t * width / height
    y = (1 - 2 * (np.arange(height) + 0.5) / height) * t
    rays = np.stack(np.broadcast_arrays(x[None, :], y[:, None], -1.0), -1)
    rays = rays / np.linalg.norm(rays, axis=-1, keepdims=True) @ state.camera.rotation.T
    ends = state.camera.position + rays * np.minimum(reach, 80e3)[..., None]
    radius = state.planet_radius

    def on_map(place):
        height_above = np.linalg.norm(place + np.array([0.0, 0.0, radius])) - radius
        return (*map_coordinates(place, radius), height_above)

    start = on_map(state.camera.position)
    return world.clouds.optical_depth(start, np.array([[on_map(p) for p in row] for row in ends]))


def _many(report):
    """Few clouds and five thousand must cost Python the same."""
    base = fs.load("hundred_miles")
    for technique in TECHNIQUES:
        calls, python, clouds = [], [], []
        for coverage, size in ((0.02, 4.0), (0.5, 0.5)):
            layer = {"genus": "cumulus_mediocris", "coverage": coverage, "size": size, "base": 650.0}
            world = base.updated({"clouds.layers": [layer], "clouds.technique": technique})
            _, stats, _ = _frames(world, size=SMALL, count=20)
            calls.append(stats[-1]["calls"])
            python.append(median(s["cpu_ms"] for s in stats))
            clouds.append(_number(world))
        how = f"{technique}: {clouds[0]:,} and {clouds[1]:,} clouds in reach, {SMALL[0]}x{SMALL[1]} low"
        report.add(f"Python time per frame, {technique}", python[1], "ms", goal="<= 2", how=how)
        report.add(
            f"WebGPU calls that more clouds add, {technique}", calls[1] - calls[0], "", goal="== 0", how=how
        )


def _number(world):
    """Clouds in the window about the camera, by the field's twin."""
    from fallstreak.clouds.field import field_of

    field, width = field_of(world), fs.QUALITY["low"].cloud_cells
    columns = np.arange(width) - width // 2
    cells = np.stack(np.meshgrid(columns, columns), -1).reshape(-1, 2)
    return sum(int((field.clouds(i, cells, 0.0)["formation"] > 0.0).sum()) for i in range(len(field.layers)))
