"""What the eye would see of the ground's mesh: its error on the screen, holes, and popping along a flight."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
from terrain_stage import LANDS, Stage

DISTANCES = (0.0, 10.0, 30.0, 100.0, 300.0, 1e3, 3e3, 10e3, 30e3, 160e3)
_STEPS = 8
SUN = np.array([0.5, 0.3, 0.8]) / np.linalg.norm([0.5, 0.3, 0.8])


def screen_error(report, device):
    """The drawn mesh against the float64 land at a quarter of a pixel's footprint, in pixels, by distance."""
    from fallstreak.terrain.ray import Surface
    from fallstreak.world.state import view_values

    views = (
        (300.0, -500.0, 2.0, 60.0, -4.0),
        (300.0, -500.0, 120.0, 200.0, -8.0),
        (0.0, 0.0, 3e3, 20.0, -15.0),
    )
    found = {}
    for land in ("jacksboro", "canyons", "alpine", "dunes"):
        stage = Stage(device, land, "high", (1280, 720))
        surface = Surface(stage.model)
        rows = []
        for view in views:
            state = stage.pose(*view)
            stage.draw(state)
            values = view_values(state)
            rng = np.random.default_rng(1)
            for slot in rng.permutation(stage.hold(state))[:60]:
                rows.append(_errors(stage, surface, values, state.camera.position, slot, rng))
        found[land] = np.concatenate(rows)
    table = []
    for near, far in pairwise(DISTANCES):
        row = [f"{near:g} - {far:g} m"]
        for pixels in found.values():
            here = pixels[(pixels[:, 0] >= near) & (pixels[:, 0] < far), 1]
            row.append(
                " / ".join(f"{x:.2f}" for x in np.percentile(here, [50, 95, 99])) if len(here) else "-"
            )
        table.append(row)
    report.table(
        "Error of the mesh on the screen at high, 1280x720, pixels: median / 95 % / 99 % of places",
        ("distance", *found),
        table,
    )
    for land, pixels in found.items():
        report.add(
            f"terrain: screen-space error at high, {land}",
            float(np.percentile(pixels[:, 1], 95)),
            "px",
            goal="<= 1",
            how="95 of 100 places on triangles in view; shift of the surface across the line of sight",
        )


def _errors(stage, surface, values, camera, slot, rng):
    """(n, 2): distance and error in pixels at random places of a node's triangles in the picture."""
    grid = stage.quality.terrain_grid
    place, world = stage.mesh(slot)
    quad = rng.integers(0, grid, (24, 2))
    a = quad[:, 1] * (grid + 1) + quad[:, 0]
    corners = np.stack([a, np.where(rng.random(24) < 0.5, a + 1, a + grid + 1), a + grid + 2], 1)
    weight = rng.dirichlet([1.0, 1.0, 1.0], 24)[..., None]
    m, p = (place[corners] * weight).sum(1), (world[corners] * weight).sum(1) - camera
    one, two = (world[corners[:, i]] - world[corners[:, 0]] for i in (1, 2))
    normal = np.cross(one, two)
    size = np.linalg.norm(normal, axis=1)
    distance = np.linalg.norm(p, axis=1)
    clip = np.concatenate([p, np.ones((24, 1))], 1) @ values["clip_from_world"].T
    shown = (size > 0.0) & (clip[:, 3] > 0.0) & (np.abs(clip[:, :2]) < clip[:, 3:]).all(1)
    shown &= np.hypot(*m.T) < 0.85 * stage.model.extent
    if not shown.any():
        return np.zeros((0, 2))
    m, p, distance, normal = (
        m[shown],
        p[shown],
        distance[shown],
        (normal / np.maximum(size, 1e-9)[:, None])[shown],
    )
    pixel = distance * values["pixel_angle"]
    off = surface.points(m[:, 0], m[:, 1], np.maximum(0.25 * pixel, 0.25)) - camera - p
    facing = (normal * p).sum(1) / distance
    across = np.abs((off * normal).sum(1)) * np.sqrt(1.0 - np.minimum(facing**2, 1.0))
    return np.stack([distance, across / pixel], 1)


def cracks(report, device):
    """Background where ground must be, over 200 cameras."""
    heights, places, count, holes, worst = (2.0, 60.0, 800.0, 6e3, 30e3), 8, 0, 0, ""
    rng = np.random.default_rng(2)
    for land in LANDS:
        stage = Stage(device, land, "high", (160, 90))
        for _ in range(places):
            east, north = rng.uniform(-20e3, 20e3, 2)
            for height in heights:
                state = stage.pose(east, north, height, rng.uniform(0, 360), rng.uniform(-40, -8))
                stage.draw(state)
                empty = (stage.read("gbuffer.depth") == 0.0) & _below_horizon(stage, state)
                count += 1
                if empty.sum():
                    worst = f"; {land} {east:.0f} {north:.0f}, {height:g} m: {int(empty.sum())}"
                holes += int(empty.sum())
    report.add(
        "terrain: background pixels under the horizon",
        holes,
        "px",
        goal="== 0",
        how=f"{count} cameras over {', '.join(LANDS)} from 2 m to 30 km, 160x90 high{worst}",
    )


def _below_horizon(stage, state):
    """Pixels whose ray meets the sphere of the lowest ground."""
    from fallstreak.world.state import view_values

    width, height = stage.size
    x, y = np.meshgrid((np.arange(width) + 0.5) / width * 2 - 1, 1 - (np.arange(height) + 0.5) / height * 2)
    clip = np.stack([x, y, 0.0 * x, 0.0 * x + 1.0], -1)
    ray = (clip @ view_values(state)["world_from_clip"].T)[..., :3]
    ray /= np.linalg.norm(ray, axis=-1, keepdims=True)
    centre = state.camera.position + np.array([0.0, 0.0, state.planet_radius])
    along = ray @ centre
    low = state.planet_radius + stage.terrain._fixed["lowest"] - 1.0
    return (along < 0.0) & (centre @ centre - along**2 < low**2)


def popping(report, device):
    """What of a picture changes from frame to frame that the camera's motion does not explain."""
    for land, height, speed in (("jacksboro", 40.0, 40.0), ("canyons", 40.0, 40.0)):
        stage = Stage(device, land, "high", (160, 90))
        path = -np.arange(200) * speed / 24.0
        ground = float(np.max(stage.world.terrain.height(path, 0.0)))
        before, tiles, switches, nodes = None, [], 0, None
        python = []
        for east in path:
            state = stage.pose(east, 0.0, ground + height, 277.0, -12.0, above=False)
            python.append(stage.draw(state))
            now = _picture(stage, state)
            set_now = {tuple(n) for n in stage.nodes()[0]}
            if before is not None:
                tiles.append(_change(before, now, state))
                switches += set_now != nodes
            before, nodes = now, set_now
        each = np.concatenate(tiles)
        worst = np.argsort([-step.max() for step in tiles])[:_STEPS]
        jump = max(_jump(stage, path[step : step + 2], ground + height) for step in worst)
        how = f"200 frames at {speed:g} m/s, {height:g} m high, 160x90 high, nodes change in {switches}; "
        report.add(
            f"terrain: popping, {land}",
            100.0 * float(each.max()),
            "%",
            how=how + "largest change of an 8x8 tile from frame to frame, reprojected, of the picture's mean",
        )
        report.add(
            f"terrain: the same of other sampling points, {land}",
            100.0 * _sampling(stage, state),
            "%",
            how="the last view 40 times, sampling points moved within their pixels: no popping in it",
        )
        report.add(
            f"terrain: popping, {land}, in a tenth of a frame",
            100.0 * jump,
            "%",
            how=f"the {_STEPS} worst steps in tenths: a jump would stand in one of them, motion is spread",
        )
        report.add(
            f"terrain: popping, {land}, 999 of 1000 tiles",
            100.0 * float(np.percentile(each, 99.9)),
            "%",
            how=how,
        )
        report.add(
            f"terrain: Python time of a frame in flight, {land}",
            float(np.median(python)),
            "ms",
            goal="<= 2",
            how="update and record, processor time, median of 200 frames with new tiles",
        )


def _jump(stage, ends, height):
    """The largest change of a tile in a tenth of the way between two frames."""
    before, worst = None, 0.0
    for east in np.linspace(*ends, 11):
        state = stage.pose(east, 0.0, height, 277.0, -12.0, above=False)
        stage.draw(state)
        now = _picture(stage, state)
        if before is not None:
            worst = max(worst, float(_change(before, now, state).max()))
        before = now
    return worst


def _sampling(stage, state):
    """The largest change of a tile that other sampling points make of the same view."""
    rng = np.random.default_rng(4)
    before, worst = None, 0.0
    for _ in range(40):
        jittered = replace(state, jitter=tuple(rng.uniform(-0.5, 0.5, 2)))
        stage.draw(jittered)
        now = _picture(stage, jittered)
        if before is not None:
            worst = max(worst, float(_change(before, now, jittered).max()))
        before = now
    return worst


def _picture(stage, state):
    """Brightness under a fixed sun and position of every pixel, and the camera."""
    from fallstreak.world.state import view_values

    values = view_values(state)
    albedo = (stage.read("gbuffer.albedo")[..., :3] / 255.0) ** 2
    code = stage.read("gbuffer.normal")
    p = (np.stack([code & 1023, code >> 10 & 1023], -1) - 511.0) / 511.0
    z = 1.0 - np.abs(p).sum(-1)
    fold = np.maximum(-z, 0.0)[..., None]
    normal = np.concatenate([p - np.where(p >= 0.0, fold, -fold), z[..., None]], -1)
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    light = albedo @ [0.2126, 0.7152, 0.0722] * (0.3 + np.maximum(normal @ SUN, 0.0))
    depth = stage.read("gbuffer.depth").astype(float)
    width, height = stage.size
    x, y = np.meshgrid((np.arange(width) + 0.5) / width * 2 - 1, 1 - (np.arange(height) + 0.5) / height * 2)
    clip = np.stack([x, y, np.maximum(depth, 1e-12), np.ones_like(x)], -1) @ values["world_from_clip"].T
    return light, clip[..., :3] / clip[..., 3:], depth > 0.0, state, values


def _change(before, now, state):
    """Of each 8 × 8 tile most of which was in sight before: change of its mean over the picture's mean."""
    light, point, seen, _, _ = now
    old_light, old_point, old_seen, old_state, old_values = before
    moved = point + (state.camera.position - old_state.camera.position)
    clip = np.concatenate([moved, np.ones((*moved.shape[:2], 1))], -1) @ old_values["clip_from_world"].T
    height, width = light.shape
    u = (clip[..., 0] / clip[..., 3] * 0.5 + 0.5) * width - 0.5
    v = (0.5 - clip[..., 1] / clip[..., 3] * 0.5) * height - 0.5
    inside = (u >= 0) & (v >= 0) & (u < width - 1) & (v < height - 1) & seen & (clip[..., 3] > 0.0)
    i, j = (np.where(inside, x, 0).astype(int) for x in (u, v))
    f, g = np.where(inside, u - i, 0.0), np.where(inside, v - j, 0.0)
    taps = [
        (j, i, (1 - f) * (1 - g)),
        (j, i + 1, f * (1 - g)),
        (j + 1, i, (1 - f) * g),
        (j + 1, i + 1, f * g),
    ]
    taps = [(np.minimum(r, height - 1), np.minimum(c, width - 1), w) for r, c, w in taps]
    distance = np.linalg.norm(moved, axis=-1)
    for r, c, _ in taps:  # the same ground, not what stood before it
        same = np.abs(np.linalg.norm(old_point[r, c], axis=-1) / distance - 1.0) < 0.05
        inside &= same & old_seen[r, c]
    old = sum(old_light[r, c] * w for r, c, w in taps)
    change = np.where(inside, light - old, 0.0)

    def tile(x):
        return x[: height // 8 * 8, : width // 8 * 8].reshape(height // 8, 8, width // 8, 8).sum((1, 3))

    count = tile(inside.astype(float))
    enough = count >= 48
    return np.abs(tile(change)[enough] / count[enough]) / light[seen].mean()
