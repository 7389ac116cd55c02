"""What the clipmap holds: the right tiles, always, and in each texel what its place alone decides."""

from __future__ import annotations

import numpy as np
import pytest
from ground import CLIPMAP, VIEWS, Ground

from fallstreak.frame.gbuffer import COLOR, DEPTH
from fallstreak.terrain.clipmap import MAX_JOBS, Clipmap, packed_jobs


class Gpu:
    """What the shaders do with jobs: writes the tile's name into its slot of a wrapping window."""

    def __init__(self, clip):
        self.clip = clip
        shape = (clip.levels, clip.tiles, clip.tiles, 2)
        self.held = {kind: np.full(shape, 2**31 - 1, np.int64) for kind in ("shape", "surface")}

    def run(self, kind, packed, count):
        jobs = packed.ravel()[:count].astype(np.int64)
        for level, row, column in zip(jobs >> 16, jobs >> 8 & 255, jobs & 255, strict=True):
            tile = self.clip.windows[level, :2] + np.array([column, row])
            if kind == "surface":
                about = [tile + np.array([i, j]) for i in (-1, 0, 1) for j in (-1, 0, 1)]
                assert all((self.at("shape", level, t) == t).all() for t in about)
            x, y = tile % self.clip.tiles
            self.held[kind][level, y, x] = tile

    def at(self, kind, level, tile):
        x, y = tile % self.clip.tiles
        return self.held[kind][level, y, x]


@pytest.mark.parametrize("tiles", [4, 6])
def test_windows_never_show_a_stale_tile(tiles):
    clip = Clipmap(0.5, tiles, 8, 1e6)
    gpu = Gpu(clip)
    rng = np.random.default_rng(tiles)
    place, velocity, moves, worked = np.zeros(2), np.array([3.0, -5.0]), 0, 0
    finest = 0
    for frame in range(300):
        if rng.random() < 0.04:
            place = rng.uniform(-3e4, 3e4, 2)
        velocity += rng.normal(0, 3.0, 2)
        place = place + velocity
        finest = int(rng.integers(0, 4)) if frame % 20 == 0 else finest
        moves += clip.move(*place, finest)
        for kind in ("shape", "surface"):
            jobs = clip.jobs(kind)
            gpu.run(kind, packed_jobs(jobs), len(jobs))
            clip.done(kind, jobs)
            worked += len(jobs)
        for level in range(finest, clip.levels):
            # the window, told without the class: whole tiles, the camera within half a tile of its middle
            size = 0.5 * 32 * 2.0**level
            first = clip.windows[level, :2]
            assert (np.abs(place / size - first - tiles / 2) <= 0.5 + 1e-9).all()
            for row in range(tiles):
                for column in range(tiles):
                    tile = first + np.array([column, row])
                    assert (gpu.at("shape", level, tile) == tile).all()
                    if 0 < row < tiles - 1 and 0 < column < tiles - 1:
                        assert (gpu.at("surface", level, tile) == tile).all()
        assert len(clip.jobs("shape")) == 0 and len(clip.jobs("surface")) == 0
    assert moves > 100
    assert worked < 0.25 * 300 * 2 * clip.levels * tiles**2  # most of the work is never done twice


def test_tiles_beyond_the_map_are_not_worked_out():
    clip = Clipmap(0.5, 16, 10, 1000.0)
    clip.move(900.0, 0.0, 2)
    jobs = clip.jobs("shape")
    level, row, column = (x.astype(int) for x in (jobs >> 16, jobs >> 8 & 255, jobs & 255))
    assert level.min() == 2 and level.max() == 9
    size = 16.0 * 2.0**level
    low = (clip.windows[level, :2] + np.stack([column, row], 1)) * size[:, None]
    away = np.hypot(*np.maximum(np.maximum(low, -(low + size[:, None])), 0.0).T)
    assert (away <= 1050.0 + 3 * size).all()
    # and all that can be seen is: every tile that touches the map
    clip.done("shape", jobs)
    assert len(jobs) < 0.5 * 8 * 16**2
    grid = np.stack(np.meshgrid(np.arange(16), np.arange(16)), -1)
    for k in range(2, 10):
        corner = (clip.windows[k, :2] + grid) * 16.0 * 2.0**k
        away = np.hypot(*np.moveaxis(np.maximum(np.maximum(corner, -(corner + 16.0 * 2.0**k)), 0.0), -1, 0))
        assert (level == k).sum() >= (away < 1000.0).sum()


def test_all_tiles_at_once_fit_the_uniform():
    clip = Clipmap(0.25, 32, 15, 1e6)
    clip.move(0.0, 0.0, 0)
    assert len(clip.jobs("shape")) <= MAX_JOBS
    packed = packed_jobs(clip.jobs("shape"))
    assert packed.nbytes + clip.windows.nbytes <= 65536  # WebGPU's default for a uniform binding


@pytest.fixture(scope="module")
def ground(device):
    return Ground(device)


def texels(ground):
    """The clipmap as the GPU holds it, by texture and tile in use."""
    out = {}
    for name in CLIPMAP:
        image = ground.read(f"terrain.{name}")
        for tile in ground.tiles_in_use("shape" if name == "shape" else "surface"):
            out[(name, *map(int, tile))] = ground.tile(image, *tile)
    return out


def same(a, b):
    assert a.keys() == b.keys() and len(a) > 100
    for key, value in a.items():
        assert value.tobytes() == b[key].tobytes(), key


@pytest.mark.parametrize("scene", ["jacksboro", "mars"])
def test_a_texel_depends_on_its_place_alone(device, scene):
    """Away and back, or begun elsewhere: the same bytes in the clipmap and in the picture."""
    here = (2000.0, -4000.0, 60.0, 300.0, -12.0)
    ground = Ground(device, scene=scene)
    ground.draw(*here)
    first, picture = texels(ground), [ground.read(name) for name in (*COLOR, DEPTH)]
    ground.draw(-30e3, 21e3, 400.0, 0.0, -30.0)
    for step in range(12):  # back in strides of a tile or three
        ground.draw(2000.0 + 400.0 / 2.2**step, -4000.0 + 700.0 / 2.2**step, 60.0, 10.0 * step, -12.0)
    ground.draw(*here)
    same(first, texels(ground))
    for name, before in zip((*COLOR, DEPTH), picture, strict=True):
        assert ground.read(name).tobytes() == before.tobytes(), name


@pytest.mark.parametrize("view", ["eye", "far"])
def test_bounds_are_those_of_the_samples(ground, view):
    ground.draw(*VIEWS[view])
    shape, bounds = ground.read("terrain.shape"), ground.bounds()
    tiles = ground.tiles_in_use("shape")
    assert len(tiles) > 200
    for level, column, row in tiles:
        heights = np.ascontiguousarray(ground.tile(shape, level, column, row)[..., 0]).view(np.float32)
        low, high, *moved = bounds[level, row % bounds.shape[1], column % bounds.shape[2]]
        assert low == heights.min() and high == heights.max() and moved == [0.0, 0.0]


def test_levels_hold_the_land_as_their_samples_carry_it(ground):
    """Heights of whole tiles of every level against the float64 twin; normals against its differences."""
    ground.draw(*VIEWS["hill"])
    clip, model = ground.terrain.clip, ground.terrain.model
    shape, surface = ground.read("terrain.shape"), ground.read("terrain.surface").astype(float)
    tiles = ground.tiles_in_use("surface")
    rng = np.random.default_rng(2)
    for level, column, row in tiles[rng.choice(len(tiles), 24, replace=False)]:
        step = clip.spacing * 2.0**level
        x, y = np.meshgrid(column * 32 + np.arange(-1, 33), row * 32 + np.arange(-1, 33))
        expected = model.shape(x * step, y * step, step).height
        heights = np.ascontiguousarray(ground.tile(shape, level, column, row)[..., 0]).view(np.float32)
        reach = np.hypot(x * step, y * step).max()
        assert np.abs(heights - expected[1:-1, 1:-1]).max() < max(0.02, 1e-6 * reach)
        slopes = [
            (expected[1:-1, 2:] - expected[1:-1, :-2]) / (2 * step),
            (expected[2:, 1:-1] - expected[:-2, 1:-1]) / (2 * step),
        ]
        normal = np.stack([-slopes[0], -slopes[1], np.ones_like(slopes[0])], -1)
        normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
        off = np.linalg.norm(ground.tile(surface, level, column, row)[..., :3] - normal, axis=-1)
        assert off.max() < max(0.01, 0.02 / step)  # half floats, and heights good to a centimetre
