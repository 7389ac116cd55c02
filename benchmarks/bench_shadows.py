"""Shadows: what 50 km of them cost, how fine they are, how still they stand and how well they keep to rays.

Acne of the maps of things and their shadows against rays are tests (``tests/shadows``); here are the figures
of the land, of stillness, of memory and of whole frames.
"""

import sys
import time
from contextlib import ExitStack
from math import cos, pi, radians, sin, tan
from pathlib import Path
from statistics import median
from unittest.mock import patch

import numpy as np

import fallstreak as fs
from fallstreak.gpu import Device
from fallstreak.shadows.cascades.keep import around, axes_near
from fallstreak.shadows.cascades.passes import TEXELS
from fallstreak.shadows.sweep import model
from fallstreak.terrain.model import terrain_model

sys.path.insert(0, str(Path(__file__).parent))  # the files beside this one

from shadow_edges import edges
from shadow_peers import beside
from shadow_shimmer import land_steps, map_steps, walk
from shadow_stage import Stage

RADIUS = 6_371_000.0
AZIMUTHS = (20, 80, 140, 200, 260, 320)
PIXEL = 2.0 * tan(radians(31.0)) / 720
SHIP = {"file": "ship", "above": "sea", "east": 6195.0, "north": -38e3, "height": 3480.0}


def run(report):
    _cost(report)
    _peers(report)
    _air(report)
    _texels(report)
    _shimmer(report)
    _edges(report)
    _rays(report)
    _curve(report)
    _acne(report)
    _memory(report)


def _cost(report):
    """Whole frames over those without shadows, of the same world, drawn in turn."""
    scene = fs.load("long_shadows")
    ahead = {"camera.keyframes": [{"at": 0, "north": -38519.0}, {"at": 10, "north": -37919.0}]}
    rows = []
    for name, changes, goal in (
        ("all stands still", {"models": [SHIP]}, "<= 1.2"),
        ("a ship of 5 km moves", {}, "<= 1.5"),
        ("the ship and the camera (60 m/s) move", ahead, "<= 1.5"),
    ):
        world = scene.updated(changes)
        walls = _in_turn(
            [
                world.updated({"shadows.technique": technique})
                for technique in ("none", "stable", "infinity2007")
            ]
        )
        ratios = [median(b / a for a, b in zip(walls[0], own, strict=True)) for own in walls[1:]]
        rows.append((name, *(1e3 * median(own) for own in walls)))
        how = "long_shadows, 1280x720 low, median ratio of 10 frames drawn in turn"
        report.add(f"frame with shadows over one without: {name}", ratios[0], "", goal=goal, how=how)
        report.add(f"the same, as the journal of 2007 had them, to 5.5 km: {name}", ratios[1], "", how=how)
    report.table("ms a frame", ("", "without", "stable", "infinity2007"), rows)


def _peers(report):
    """An equal scene by pygfx, which has one map of 1 km."""
    try:
        found = beside()
    except ImportError:
        report.note("pygfx is not installed (pip install pygfx): nothing to draw the same scene side by side")
        return
    how = "Jacksboro's hills and 500 boxes, 1280x720, median ratio of 10 frames drawn in turn"
    for name, (without, shadowed) in found.items():
        report.add(
            f"side by side, frame over one without shadows: {name}", median(shadowed / without), "", how=how
        )
    rows = [(name, *(1e3 * median(own) for own in pair)) for name, pair in found.items()]
    report.table("ms a frame, side by side", ("", "without", "with shadows"), rows)


def _air(report):
    """What shadows of the land in the air cost: frames whose sky is not told of any."""

    def without(world):
        with patch("fallstreak.frame.pipeline.land_shades", return_value=False):
            return _renderer(world)

    walls = _in_turn([fs.load("long_shadows")], [without, _renderer])
    ratio = median(b / a for a, b in zip(*walls, strict=True))
    how = "long_shadows, 1280x720 low, median ratio of 10 frames drawn in turn"
    report.add("frame with shadows of land in the air over one without those", ratio, "", how=how)


def _renderer(world):
    return fs.Renderer(world, size=(1280, 720), quality="low", fps=30.0)


def _in_turn(worlds, makers=(_renderer,), count=10, warm=4):
    """Seconds of frames of each world by each maker of a renderer, frame by frame in turn."""
    with ExitStack() as stack:
        renderers = [stack.enter_context(make(world)) for world in worlds for make in makers]
        walls = [[] for _ in renderers]
        for index in range(warm + count):
            for renderer, own in zip(renderers, walls, strict=True):
                start = time.perf_counter()
                renderer.render(index)
                own.append(time.perf_counter() - start)
    return [own[warm:] for own in walls]


def _texels(report):
    key = np.array([0.6, -0.3, 0.4]) / np.linalg.norm([0.6, -0.3, 0.4])
    reaches = [40.0 * 4.0**n for n in range(4)]
    widths = [around(axes_near(key, n), np.zeros(3), r, TEXELS).texel(TEXELS) for n, r in enumerate(reaches)]
    report.add("texel within 40 m", widths[0], "m", goal="<= 0.1", how="half a map over its texels")
    report.table("texels of things", ("to m", "m"), list(zip(reaches, widths, strict=True)))


def _shimmer(report):
    """What flips though nothing has moved but the camera: see `shadow_shimmer`."""
    device = Device.open()
    rows = []
    for scene, changes in (
        ("long_shadows", {"models": [SHIP]}),
        ("jacksboro", {"time": "2025-10-18T17:00:00-04:00"}),
    ):
        for technique in ("stable", "infinity2007"):
            world = fs.load(scene).updated(changes | {"shadows.technique": technique, "clouds.layers": []})
            stage = Stage(device, world, (640, 360))
            found = walk(stage, steps=12)
            goal = "<= 0" if technique == "stable" else None
            how = "640x360 low, 12 steps of 8.6 mm and 0.3 degrees, the same places of the world"
            name = f"{scene}, {technique}"
            report.add(
                f"places whose shadow flips: {name}",
                found.count,
                "",
                goal=goal,
                how=f"{found.places:,}, {how}",
            )
            how = f"{found.pixels:,} pixels of pictures of the same steps, beside the edges"
            report.add(f"pixels whose shadow flips: {name}", found.pixels_flipped, "", goal=goal, how=how)
            sources = [found.flipped[source, near] for source in ("land", "things") for near in (True, False)]
            rows.append((name, found.places, *sources, found.at_steps))
            if scene == "long_shadows" and technique == "stable":
                land, things = land_steps(stage), map_steps(stage)
    columns = ("", "places", "land to 40 m", "beyond", "things to 40 m", "beyond", "where a map is drawn")
    report.table("flips in steps of a tenth of a texel", columns, rows)
    columns = ("", "m", "places", "flipped")
    rows = [("land, samples apart", *row) for row in land] + [("things, to", *row) for row in things]
    report.table("flips as the camera leaves a window that was kept: long_shadows, stable", columns, rows)


def _edges(report):
    """Where shadows of land end in whole pictures, against rays through the land's own model."""
    device = Device.open()
    rows = []
    for name, scene, time_ in (
        ("long_shadows, 3 degrees", "long_shadows", None),
        ("jacksboro, 8 degrees", "jacksboro", "2025-10-18T18:10:00-04:00"),
        ("jacksboro, 21 degrees", "jacksboro", "2025-10-18T17:00:00-04:00"),
    ):
        changes = {"models": [], "clouds.layers": [], "terrain.vegetation": 0.0}
        stage = Stage(
            device, fs.load(scene).updated(changes | ({"time": time_} if time_ else {})), (640, 360)
        )
        share, found = edges(stage, (0.0, 100.0, 1e3, 5e3, 20e3, 60e3))
        how = "640x360 low, float64 rays through the land's model in samples of a pixel"
        report.add(f"land in whole pictures against rays: {name}, IoU of the dark", share, "", how=how)
        everywhere = np.concatenate([off for *_, off in found])
        metric = f"edges in whole pictures against rays: {name}, 90 %"
        report.add(metric, np.quantile(everywhere, 0.9), "pixels", how=how)
        rows += [
            (name, f"{low / 1e3:g}-{high / 1e3:g}", len(off), *map(float, np.quantile(off, (0.5, 0.9))))
            for low, high, off in found
        ]
    columns = ("", "km", "pixels at edges", "median", "90 %")
    report.table("edges of the land's shadows from those of rays, pixels of 640x360", columns, rows)


def _iou(dark, rays):
    return (dark & rays).sum() / max((dark | rays).sum(), 1)


def _rays(report):
    """The sweep of the Jacksboro elevation model against rays, and how far off its edges are."""
    terrain = terrain_model(fs.load("jacksboro"))
    rows = []
    for spacing in (8.0, 32.0, 128.0):
        along = (np.arange(512) - 256) * spacing
        found = terrain.shape(*np.meshgrid(along, along), spacing)
        heights = np.maximum(found.height, found.water)
        x = np.linspace(150.0, 360.0, 211) + 0.37  # places between samples
        places = np.stack(np.meshgrid(x, x), -1).reshape(-1, 2)
        for elevation in (2, 3, 6, 12, 25):
            worst, off = [], []
            for azimuth in AZIMUTHS:
                a, e = radians(azimuth), radians(elevation)
                dark, rays = model.dark_by_both(heights, spacing, a, e, places)
                worst.append(_iou(dark, rays))
                sight = rays.reshape(len(x), len(x))
                edge = (sight[1:] != sight[:-1]).sum() + (sight[:, 1:] != sight[:, :-1]).sum()
                # edges of a grid are 4 / pi as long as what they stand for
                off.append((dark != rays).sum() * spacing / max(edge * pi / 4.0, 1.0))
            if spacing == 32.0:
                report.add(
                    f"swept land against rays, sun {elevation} degrees: intersection over union",
                    min(worst),
                    "",
                    goal=">= 0.97",
                    how="Jacksboro every 32 m, 44,521 places, the worst of six azimuths",
                )
            away = 0.46 * 512 * spacing * 0.75  # where pictures of `low` ask a level of this spacing
            rows.append((f"{away / 1e3:.1f} km, {elevation} deg", max(off), max(off) / (away * PIXEL)))
    report.table("mean distance of shadow edges from those of rays", ("at", "m", "pixels of 720"), rows)


def _curve(report):
    n, spacing = 1000, 100.0
    x, y = np.meshgrid(*2 * ((np.arange(n) - n // 2) * spacing,))
    heights = 1500.0 * (1 + np.sin(x / 9000.0 + np.sin(y / 13000.0))) * (0.6 + 0.4 * np.cos(y / 7000.0))
    heights += 400.0 * np.sin(x / 2100.0) * np.sin(y / 2500.0)
    places = np.random.default_rng(4).uniform(40.0, 959.0, (20000, 2))
    for elevation in (2, 3, 6, 12):
        angles = [(radians(azimuth), radians(elevation)) for azimuth in AZIMUTHS]
        worst = min(_iou(*model.dark_by_both(heights, spacing, *way, places, RADIUS)) for way in angles)
        how = f"range of 100 km, the planet's curve, sun {elevation} degrees, the worst of six azimuths"
        report.add(
            f"swept land against rays over 100 km, sun {elevation}", worst, "", goal=">= 0.97", how=how
        )
    report.note("with the sun at 25 degrees nothing of this range is dark")


def _acne(report):
    """Planes of land that lean from the light by 0 to 85 degrees: none of it is dark."""
    acne, looked = 0, 0
    along = np.arange(256) - 128
    x, y = np.meshgrid(along, along)
    for lean in range(0, 86, 5):
        for azimuth in AZIMUTHS:
            a, e = radians(azimuth), radians(30.0)
            slope = tan(radians(30.0 - (90.0 - lean)))  # of ground that meets the light at 90 - lean degrees
            heights = slope * (x * sin(a) + y * cos(a))
            upper, lower = model.swept(heights, 1.0, a, e)
            light = model.land_light(heights, upper, lower)[32:-32, 32:-32]
            acne += int((light < 1.0 - 0.5 / 255).sum())
            looked += light.size
    how = f"{looked:,} places on planes of land that lean from the light by 0 to 85 degrees"
    report.add("places of land that shade themselves", acne, "", goal="<= 0", how=how)


_BYTES = {"rgba32float": 16, "r32float": 4, "depth32float": 4, "rgba16float": 8, "rg8unorm": 2}


def _memory(report):
    for quality in ("low", "high"):
        with fs.Renderer(fs.load("long_shadows"), size=(1280, 720), quality=quality) as renderer:
            graph = renderer.graph
            textures = {n: t for n, t in graph.textures.items() if n.startswith("shadows.")}
            buffers = {n: b for n, b in graph.buffers.items() if n.startswith("shadows.")}
            used = sum(_BYTES[t.format] * int(np.prod(t.size)) for t in textures.values())
            used += sum(b.size for b in buffers.values())
        report.add(
            f"memory of shadows at {quality}",
            used / 2**20,
            "MiB",
            goal="<= 96" if quality == "high" else None,
            how="long_shadows, 1280x720, all textures and buffers of shadows",
        )
