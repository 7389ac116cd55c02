"""The swept shadow height on the CPU, float64; and rays through the same ground, to check it by."""

from __future__ import annotations

from math import cos, hypot, radians, sin, tan

import numpy as np

DISC = radians(0.2665)
"""Radius of sun and moon."""


def swept(
    heights: np.ndarray,
    spacing: float,
    azimuth: float,
    elevation: float,
    radius: float | None = None,
    disc: float = DISC,
    first: tuple[int, int] = (0, 0),
    at: np.ndarray | None = None,
) -> tuple[np.ndarray, np.ndarray]:
    """Heights under which the light's disc is hidden, at the samples of a grid or between them.

    Lines along the azimuth lie in a sheared grid: at row i of the major axis line j has the minor coordinate
    (j + phase + slope i) mod n; two running maxima fall by the tangents of the disc's lower and upper edge.

    Parameters
    ----------
    heights : (n, n)
        m, rows run north, columns east.
    spacing : float
        m between samples.
    azimuth, elevation : float
        rad, of the light; clockwise from north, above the plane that touches the planet in the grid's middle.
    radius : float, optional
        m, of the planet; without it the land is flat.
    disc : float
        rad, radius of the light's disc.
    first : (int, int)
        The grid's first sample in the world, east and north: lines stand still there, wherever the grid lies.
    at : (m, 2), optional
        Columns and rows between samples, bilinear in the sheared grid as ``lookup.wesl`` has it.

    Returns
    -------
    upper, lower : (n, n) or (m,)
        m: from `upper` on all of the disc is seen, below `lower` nothing. What comes from outside of the grid
        is not known: there they are low.
    """
    n = len(heights)
    drop = _drop(n, spacing, radius)
    ground = heights - drop
    way = np.array([sin(azimuth), cos(azimuth)])
    northern = bool(abs(way[1]) > abs(way[0]))
    if not northern:
        ground = ground.T  # rows along the major axis
    major, minor = (way[1], way[0]) if northern else (way[0], way[1])
    slope = minor / major
    step = spacing * hypot(1.0, slope)
    fall = step * np.tan([[elevation - disc], [elevation + disc]])
    phase = (slope * first[northern] - first[not northern]) % 1.0
    lines = np.arange(n) + phase
    shadow = np.full((2, n), -1e6)
    wide = np.zeros((2, n))  # m, of the penumbrae of what throws each
    edges = np.empty((2, n, n))  # row of the major axis, line
    strip = None
    for i in range(n - 1, -1, -1) if major > 0 else range(n):
        along = lines + slope * i
        now = np.floor(along / n)
        if strip is not None:
            shadow[:, now != strip] = -1e6  # came in over the side
        strip = now
        place = along - now * n
        low = np.minimum(place.astype(int), n - 1)
        high = np.minimum(low + 1, n - 1)
        here = ground[i, low] + (place - low) * (ground[i, high] - ground[i, low])
        edges[0, i], edges[1, i] = shadow[0], _lower(here, shadow, wide)
        wide = np.where(here > shadow, 0.0, wide) + (fall[1] - fall[0])
        shadow = np.maximum(shadow, here) - fall
    if at is None:
        row, column = np.mgrid[0:n, 0:n].astype(float)
    else:
        column, row = at.T
    found = _sheared(edges, row if northern else column, column if northern else row, slope, phase)
    found += drop if at is None else _sunk(at, n, spacing, radius)
    return found[0], found[1]


def _sheared(
    edges: np.ndarray, along: np.ndarray, across: np.ndarray, slope: float, phase: float
) -> np.ndarray:
    """Between the nodes of the sheared grid; `along` the major axis, `across` it."""
    n = edges.shape[1]
    line = across - phase - slope * along
    left, row = np.floor(line).astype(int), np.minimum(along.astype(int), n - 2)
    part, f = line - left, along - row
    near = (1.0 - part) * edges[:, row, left % n] + part * edges[:, row, (left + 1) % n]
    far = (1.0 - part) * edges[:, row + 1, left % n] + part * edges[:, row + 1, (left + 1) % n]
    return (1.0 - f) * near + f * far


def _lower(ground: np.ndarray, shadow: np.ndarray, wide: np.ndarray) -> np.ndarray:
    """The lower height that gives ground its share of the light.

    What hides the disc's upper edge first may be a summit far away, and what hides its lower edge the slope
    next to a place, which from there hides nothing: each has its own penumbra, and the lesser share counts.
    """
    far_lower, near_upper = shadow[0] - wide[0], shadow[1] + wide[1]
    far = np.clip((ground - far_lower) / np.maximum(wide[0], 1e-3), 0.0, 1.0)
    near = np.clip((ground - shadow[1]) / np.maximum(near_upper - shadow[1], 1e-3), 0.0, 1.0)
    mixed = (ground - near * shadow[0]) / np.maximum(1.0 - near, 1e-3)
    return np.where(ground <= shadow[1], shadow[1], np.where(near < far, mixed, far_lower))


def land_light(height: np.ndarray, upper: np.ndarray, lower: np.ndarray) -> np.ndarray:
    """Share of the disc that is seen from heights, 0..1."""
    t = np.clip((height - lower) / np.maximum(upper - lower, 1e-3), 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t)


def rays(
    heights: np.ndarray,
    spacing: float,
    azimuth: float,
    elevation: float,
    radius: float | None = None,
    step: float = 0.25,
    at: np.ndarray | None = None,
) -> np.ndarray:
    """Whether the disc's middle is seen, by rays through the bilinear ground.

    Parameters
    ----------
    heights, spacing, azimuth, elevation, radius
        As for `swept`.
    step : float
        Of a ray, in samples; an eighth of it over the first two.
    at : (m, 3), optional
        From where: column, row, m above sea level. Without it from each sample.

    Returns
    -------
    (m,) or (n, n) bool
    """
    n = len(heights)
    drop = _drop(n, spacing, radius)
    ground = heights - drop
    way = np.array([sin(azimuth), cos(azimuth)])
    if at is None:
        y, x = (grid.ravel().astype(float) for grid in np.mgrid[0:n, 0:n])
        start = ground.ravel()
    else:
        x, y = at[:, 0], at[:, 1]
        start = at[:, 2] - _sunk(at[:, :2], n, spacing, radius)
    seen = np.ones(len(start), bool)
    alive = np.arange(len(start))
    rise = spacing * tan(elevation)
    highest = ground.max()
    travelled = 0.0
    while alive.size:
        travelled += step if travelled >= 2.0 else 0.125 * step
        px, py = x[alive] + way[0] * travelled, y[alive] + way[1] * travelled
        inside = (px >= 0) & (py >= 0) & (px <= n - 1) & (py <= n - 1)
        z = start[alive] + rise * travelled
        inside &= z <= highest
        alive, px, py, z = alive[inside], px[inside], py[inside], z[inside]
        hit = between(ground, px, py) > z + 1e-9
        seen[alive[hit]] = False
        alive = alive[~hit]
    return seen.reshape(n, n) if at is None else seen


def between(grid: np.ndarray, column: np.ndarray, row: np.ndarray) -> np.ndarray:
    """Bilinear between the samples of a grid."""
    i, j, fx, fy = _cell(grid, column, row)
    south = grid[j, i] + fx * (grid[j, i + 1] - grid[j, i])
    north = grid[j + 1, i] + fx * (grid[j + 1, i + 1] - grid[j + 1, i])
    return south + fy * (north - south)


def turned_away(
    grid: np.ndarray, spacing: float, column: np.ndarray, row: np.ndarray, azimuth: float, elevation: float
) -> np.ndarray:
    """Whether the bilinear ground faces away from the light: then it is dark without any shadow."""
    i, j, fx, fy = _cell(grid, column, row)
    east = (grid[j, i + 1] - grid[j, i]) * (1 - fy) + (grid[j + 1, i + 1] - grid[j + 1, i]) * fy
    north = (grid[j + 1, i] - grid[j, i]) * (1 - fx) + (grid[j + 1, i + 1] - grid[j, i + 1]) * fx
    return (east * sin(azimuth) + north * cos(azimuth)) / spacing > tan(elevation)


def dark_by_both(
    heights: np.ndarray,
    spacing: float,
    azimuth: float,
    elevation: float,
    places: np.ndarray,
    radius: float | None = None,
) -> tuple[np.ndarray, np.ndarray]:
    """Places (m, 2: column, row) on the ground that are dark by the sweep, or turned away; and by rays."""
    column, row = places.T
    ground = between(heights, column, row)
    # the disc's middle, as of the rays
    upper, _ = swept(heights, spacing, azimuth, elevation, radius, disc=0.0, at=places)
    dark = (ground < upper) | turned_away(heights, spacing, column, row, azimuth, elevation)
    at = np.column_stack([places, ground + 1e-3])
    return dark, ~rays(heights, spacing, azimuth, elevation, radius, at=at)


def _cell(
    grid: np.ndarray, column: np.ndarray, row: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Column and row of the cell around places, and where in it they are."""
    i = np.minimum(column.astype(int), grid.shape[1] - 2)
    j = np.minimum(row.astype(int), grid.shape[0] - 2)
    return i, j, column - i, row - j


def _sunk(at: np.ndarray, n: int, spacing: float, radius: float | None) -> np.ndarray | float:
    """m by which the planet sinks below that plane at places (m, 2: column, row)."""
    return 0.0 if radius is None else ((at - n // 2) ** 2).sum(-1) * spacing**2 / (2.0 * radius)


def _drop(n: int, spacing: float, radius: float | None) -> np.ndarray:
    """m by which the planet sinks below the plane that touches it in the grid's middle."""
    if radius is None:
        return np.zeros((n, n))
    along = (np.arange(n) - n // 2) * spacing
    return (along[:, None] ** 2 + along**2) / (2.0 * radius)
