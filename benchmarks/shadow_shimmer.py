"""How still shadows stand: the same places of the world from frame to frame, and whole pictures.

Two ways to tell a flip. `walk` asks the shadows for the light at the *same places* from each camera: whatever
changes there does so without a reason of geometry. And it compares pictures: a place of one frame is looked
up in the next where it has gone to, if the pixels around it show the same surface and neither frame has a
shadow's edge there, for at an edge a pixel next to the place shows another light by right.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from shadow_stage import Picture, Stage

from fallstreak.shadows.cascades.keep import around, axes_near
from fallstreak.shadows.cascades.passes import TEXELS
from fallstreak.world.state import CameraState

FLIP = 0.25
"""Of the light: what changes by more has flipped."""
CALM = 0.1
"""What pixels around a place may differ by where no shadow ends."""
STEP = 0.0086
"""m, a tenth of the finest texel of the default maps."""
TURN = 0.3
"""Degrees from frame to frame."""
NEAR = 40.0
"""m, as far as the finest map reaches."""


@dataclass
class Flips:
    """What a walk has found.

    Attributes
    ----------
    places : int
        Looked at, over all steps: those in sight.
    flipped : dict
        (source, within `NEAR`) -> how many changed by more than `FLIP`; source "land" or "things".
    at_steps : int
        The same in frames in which a map was drawn or a level swept anew, from all sources.
    pixels, pixels_flipped : int
        Of pictures, those that can be compared and those that flipped.
    dark : float
        Share of the places that lie in shade.
    """

    places: int = 0
    flipped: dict[tuple[str, bool], int] = field(default_factory=dict)
    at_steps: int = 0
    pixels: int = 0
    pixels_flipped: int = 0
    dark: float = 0.0

    @property
    def count(self) -> int:
        """All flips at the same places."""
        return sum(self.flipped.values()) + self.at_steps


def walk(stage: Stage, steps: int = 20, step: float = STEP, turn: float = TURN) -> Flips:
    """The world's camera goes ahead to the right by `step` metres a frame and turns by `turn` degrees."""
    pose = stage.pose()
    found = Flips()
    before: tuple[Picture, np.ndarray] | None = None
    places = normals = away = None
    for n in range(steps + 1):
        camera = stage.camera(
            pose.east + 0.8 * step * n, pose.north + 0.6 * step * n, pose.height, pose.heading + turn * n
        )
        picture, light = stage.render(camera, places, normals)
        if places is None:
            seen = np.isfinite(picture.along)
            places, normals = picture.places[seen], picture.normals[seen]
            away = np.linalg.norm(places - camera.position, axis=-1)
            _, light = stage.render(camera, places, normals)
            found.dark = float((light.min(-1) < 0.5).mean())
        if before is not None:
            change = _visible(stage, camera, places, light - before[1])
            found.places += int(np.isfinite(change[:, 0]).sum())
            flips = change > FLIP
            if stage.renewed:
                found.at_steps += int(flips.sum())
            else:
                for number, source in enumerate(("land", "things")):
                    for near in (True, False):
                        flipped = int(flips[(away < NEAR) == near, number].sum())
                        found.flipped[source, near] = found.flipped.get((source, near), 0) + flipped
            pixels, flipped = _compare(stage, camera, before[0], picture)
            found.pixels += pixels
            found.pixels_flipped += flipped
        before = picture, light
    return found


def _visible(stage: Stage, camera: CameraState, places: np.ndarray, change: np.ndarray) -> np.ndarray:
    """Sizes of changes, NaN at places that are out of the picture."""
    at = stage.pixels(camera, places)
    with np.errstate(invalid="ignore"):
        seen = ((at >= 0.0) & (at <= stage.size)).all(-1)
    return np.where(seen[:, None], np.abs(change), np.nan)


def _compare(stage: Stage, camera: CameraState, before: Picture, now: Picture) -> tuple[int, int]:
    """Pixels of the frame before that can be compared with this one's, and those that have flipped."""
    width, height = stage.size
    at = np.nan_to_num(stage.pixels(camera, before.places) - 0.5, nan=-1.0)
    seen = ((at >= 0.0) & (at < np.array([width - 1, height - 1]))).all(-1)
    x, y = np.where(seen[..., None], at, 0.0).astype(int).transpose(2, 0, 1)

    def around_it(values):
        return np.stack([values[y + j, x + i] for j in (0, 1) for i in (0, 1)])

    along = -((before.places - camera.position) @ camera.rotation)[..., 2]
    with np.errstate(invalid="ignore"):
        seen &= (np.abs(along / around_it(now.along) - 1.0) < 0.02).all(0)
    seen &= ((around_it(now.normals) * before.normals).sum(-1) > 0.9).all(0)
    lit = np.pad(before.light, 1, mode="edge")
    ring = np.stack([lit[j : j + height, i : i + width] for j in range(3) for i in range(3)])
    four = around_it(now.light)
    seen &= (np.ptp(ring, axis=0) < CALM) & (np.ptp(four, axis=0) < CALM)
    return int(seen.sum()), int((seen & (np.abs(four.mean(0) - before.light) > FLIP)).sum())


def land_steps(stage: Stage, farthest: float = 1e4) -> list[tuple[float, int, int]]:
    """What flips as a window of the swept land moves on.

    Returns
    -------
    list of (spacing in m, places, of which flipped)
        Of each level whose next step is less than `farthest` metres away.
    """
    found, pose = [], stage.pose()
    constants = stage.shadows.sweep.constants
    for level in range(constants["SWEEP_LEVELS"]):
        spacing = constants["SWEEP_SPACING"] * 2.0**level
        # windows follow the camera in whole tiles of 32 samples, from somewhere
        first = np.floor(pose.east / (16.0 * spacing)) * 16.0 * spacing
        for border in first + np.array([16.0, 32.0]) * spacing:
            if border - pose.east > farthest:
                continue
            height = pose.above + stage.ground(border, pose.north)
            cameras = [stage.camera(border + side, pose.north, height) for side in (-STEP / 2, STEP / 2)]
            stage.begin()
            stage.render(cameras[0])
            before = stage.windows
            stage.render(cameras[1])
            if (stage.windows != before)[level].any():
                found.append((float(spacing), *_changed(stage, cameras, 0)))
                break
    return found


def map_steps(stage: Stage) -> list[tuple[float, int, int]]:
    """The same of the maps of things, each drawn as the camera came into its window and kept until it leaves.

    Returns
    -------
    list of (reach in m, places, of which flipped)
    """
    pose, found = stage.pose(), []
    stage.render(stage.camera())
    for number, reach in enumerate(stage.reaches):
        axes = axes_near(stage.key, number)

        def window(east, axes=axes, reach=reach):
            return around(axes, stage.camera(east).position, reach, TEXELS)

        def border(east, way, window=window, reach=reach):
            """The last place in this window, and the first in the next."""
            here, inside = window(east), east
            while window(inside + 0.01 * way * reach) == here:
                inside += 0.01 * way * reach
            outside = inside + 0.01 * way * reach
            while abs(outside - inside) > STEP:
                middle = 0.5 * (inside + outside)
                inside, outside = (middle, outside) if window(middle) == here else (inside, middle)
            return inside, outside

        cameras = [stage.camera(east) for east in (border(pose.east, -1.0)[0], *border(pose.east, 1.0))]
        found.append((reach, *_changed(stage, cameras, 1)))
    return found


def _changed(stage: Stage, cameras: list[CameraState], source: int) -> tuple[int, int]:
    """Places that the last but one of some cameras sees after those before it, and those that have flipped as
    seen from the last."""
    stage.begin()
    for camera in cameras[:-1]:
        picture, _ = stage.render(camera)
    seen = np.isfinite(picture.along)
    at = picture.places[seen], picture.normals[seen]
    lights = [stage.render(camera, *at)[1][:, source] for camera in cameras[-2:]]
    return int(seen.sum()), int((np.abs(lights[1] - lights[0]) > FLIP).sum())
