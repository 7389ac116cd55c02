"""Canyon country, on the CPU: float64 twin of ``canyon.wesl``."""

from __future__ import annotations

import numpy as np

from ..land.canyons_graded import Graded
from ..land.canyons_strata import BAND, BED, LAYER, cliff_of, folds, hardness, layer_of, thickening
from ..pattern import missing, smoothstep, speckle, threshold
from .cover import Covers, Sites

PALETTE = ("sandstone", "limestone", "scree", "sand", "soil", "shrubs")

RED, BUFF = np.array([0.330, 0.185, 0.108]), np.array([0.450, 0.330, 0.220])
DEEP, PALER = np.array([0.270, 0.138, 0.082]), np.array([0.28, 0.38, 0.43])
SHALE, ROCK = np.array([0.235, 0.130, 0.088]), np.array([0.350, 0.226, 0.146])
VARNISH = np.array([0.105, 0.075, 0.060])
SAND, CRUST = np.array([0.390, 0.255, 0.155]), np.array([0.195, 0.125, 0.082])
SCREE = np.array([0.265, 0.170, 0.115])
JUNIPERS = np.array([0.054, 0.055, 0.032])
SCRUB, WILLOWS = np.array([0.105, 0.092, 0.050]), np.array([0.066, 0.086, 0.026])


def cover(site: Sites) -> Covers:
    """What covers places."""
    east, north, step, height = np.broadcast_arrays(
        *(np.asarray(x, float) for x in (site.east, site.north, site.step, site.height))
    )
    seed = site.seed

    def noise(power, number):
        return speckle(east, north, power, step, seed + number)

    broad, wide, middle, small = noise(12, 507), noise(10, 501), noise(7, 502), noise(5, 503)
    streaks, lines, fine = noise(4, 504), noise(3, 505), noise(1, 506)
    lost_broad, lost_wide, lost_middle, lost_small = (missing(power, step) for power in (12, 10, 7, 5))
    lost_streaks, lost_lines = missing(4, step), missing(3, step)

    one = np.ones_like(east)
    e, n = Graded(east, one, 0.0 * one), Graded(north, 0.0 * one, one)
    along = height - folds(e, n, seed).value + thickening(e, n, step, seed)
    layer = layer_of(along, LAYER, seed + 40)
    held = np.hypot(site.normal[..., 0], site.normal[..., 1]) / np.maximum(site.normal[..., 2], 0.05)
    left = np.sqrt(np.maximum(site.slope**2 - held**2, 0.0))
    rough = 0.16 * lost_small + 0.09 * lost_streaks
    wall = np.maximum(
        threshold(held + 0.4 * small + 0.3 * streaks, 1.05, 0.2, rough),
        np.maximum(left - 0.18, 0.0) / (left + 1.6),
    )
    gentle = held + smoothstep(12.0, 80.0, step) * np.minimum(0.11 - held, 0.0)
    rise = step * np.minimum(gentle, 4.0)
    told = np.clip(2.0 - 2.0 * rise / LAYER, 0.0, 1.0)
    weak = 1.0 - smoothstep(-0.05, 0.05, (along - layer.low) / layer.thick - (1.0 - cliff_of(layer)))
    hue = 0.5 * (layer.number % 2.0) + 0.5 * layer.own[2]
    buff = smoothstep(0.42, 0.66, hue)
    steep = smoothstep(0.15, 0.5, gentle)
    bed = steep * np.clip(2.0 - 2.0 * rise / BED, 0.0, 1.0) * hardness(along, BED, seed + 42)
    band = steep * np.clip(2.0 - 2.0 * rise / BAND, 0.0, 1.0) * hardness(along, BAND, seed + 43)
    rock = _mix(_mix(DEEP, RED, smoothstep(0.1, 0.35, hue)), BUFF, buff)
    rock = _mix(rock, SHALE, 0.6 * weak)
    rock = _mix(ROCK, rock, told * (1.0 - wall * left / (held + 0.3 + left)))
    rock = rock * np.maximum(1.0 + (bed + 1.2 * band)[..., None] * PALER, 0.4)
    pale = np.clip(0.45 * bed + 0.25 * buff * told, 0.0, 1.0)
    rock = rock * (1.0 + 0.25 * middle + 0.3 * lines + 0.2 * fine)[..., None]

    rough = lost_streaks + 0.64 * lost_lines + 0.81 * lost_middle + 0.09 * lost_small
    dark = threshold(streaks + 0.8 * lines + 0.9 * middle + 0.3 * small, 0.16, 0.14, rough)
    rock = _mix(rock, VARNISH, 0.6 * 0.75 * wall * dark)

    deep = smoothstep(0.03, 0.11, 1.0 - site.open)
    talus = (1.0 - wall) * deep * threshold(gentle + 0.5 * small, 0.36, 0.14, 0.25 * lost_small)
    rough = 0.25 * lost_middle + 0.04 * lost_small + 0.12 * lost_wide
    bare = np.hypot(gentle, np.minimum(left, 0.14))
    bare = threshold(bare + 0.5 * middle + 0.35 * wide + 0.2 * small, 0.16, 0.10, rough)
    bare = (1.0 - wall) * (1.0 - deep) * bare
    loose = np.maximum(1.0 - wall - talus - bare, 0.0)

    above = -site.water
    wet = smoothstep(11.0, 3.0, above + 8.0 * small + 6.0 * streaks) * smoothstep(0.7, 0.35, site.slope)
    beside, dry = loose * wet, loose * (1.0 - wet)
    rough = lost_middle + 0.36 * lost_small + 0.64 * lost_wide + 0.25 * lost_broad
    sandy = threshold(middle + 0.6 * small + 0.8 * wide + 0.5 * broad + 0.3 * site.hollow, 0.10, 0.2, rough)
    rough = lost_lines + 0.49 * lost_streaks + 0.36 * lost_middle
    scrub = threshold(lines + 0.7 * streaks + 0.6 * middle, 0.12, 0.1, rough)
    rough = lost_wide + 0.64 * lost_broad + 0.49 * lost_middle + 0.16 * lost_small
    wooded = threshold(wide + 0.8 * broad + 0.7 * middle + 0.4 * small, 0.14, 0.16, rough)
    stand = wooded * (0.35 + 0.45 * scrub)
    willows = beside * (0.5 + 0.45 * scrub)
    junipers = dry * stand + 0.35 * bare * stand
    bushes = dry * (1.0 - stand) * 0.6 * scrub * (1.0 - 0.5 * sandy) + 0.25 * talus * scrub
    ground = dry * (1.0 - stand) * (1.0 - 0.6 * scrub * (1.0 - 0.5 * sandy))
    blocks = talus - 0.25 * talus * scrub
    stone = wall + bare * (1.0 - 0.35 * stand)

    shares = (
        stone * (1.0 - pale),
        stone * pale,
        blocks,
        ground * sandy + (beside - willows),
        ground * (1.0 - sandy),
        willows + junipers + bushes,
    )
    tone = 1.0 + 0.25 * small + 0.2 * lines + 0.25 * fine
    rest = (
        blocks[..., None] * _mix(SCREE, rock, 0.35)
        + (ground * sandy + beside - willows)[..., None] * SAND
        + (ground * (1.0 - sandy))[..., None] * CRUST
        + willows[..., None] * WILLOWS
        + junipers[..., None] * JUNIPERS
        + bushes[..., None] * SCRUB
    )
    tint = np.maximum(stone[..., None] * rock + rest * tone[..., None], 0.01)
    return Covers(
        np.stack(np.broadcast_arrays(*shares), -1),
        tint,
        beside * smoothstep(1.6, 0.2, above),
        np.clip(0.9 * beside + (0.15 + 0.55 * stand) * (dry + 0.35 * bare) + 0.15 * talus, 0.0, 1.0),
    )


def _mix(a, b, t):
    return a + np.asarray(t)[..., None] * (b - a)
