"""The noise functions as people call them: shapes, types, what is refused and how; nothing crashes."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest

from fallstreak import noise
from fallstreak.noise.arguments import LARGEST_PERIOD, fades_of
from fallstreak.noise.kinds import FRACTALS, KINDS

EACH = [(name, d) for name, kind in KINDS.items() for d in kind.dimensions]
# What compiles another loop each; float64 finds cells in the same way in all dimensions.
EACH_PRECISION = [(name, d, np.float32) for name, d in EACH] + [(name, 3, np.float64) for name in KINDS]


def points(*shape, dimensions=3, dtype=np.float32, seed=0):
    return np.random.default_rng(seed).uniform(-50, 50, (*shape, dimensions)).astype(dtype)


@pytest.mark.parametrize(("kind", "dimensions"), EACH)
def test_every_kind_in_its_range(kind, dimensions):
    value = noise.sample(points(5000, dimensions=dimensions), kind)
    about = KINDS[kind]
    room = 0.25 * (about.high - about.low)
    assert value.shape == (5000,) and value.dtype == np.float32
    assert about.low - room < value.min() < value.max() < about.high + room
    assert value.max() - value.min() > 0.4 * (about.high - about.low)


@pytest.mark.parametrize("fractal", FRACTALS)
def test_every_fractal_in_its_range(fractal):
    value = noise.fbm(points(5000), 6, fractal=fractal)
    about = FRACTALS[fractal]
    assert about.low - 0.1 <= value.min() < value.max() <= about.high + 0.1
    assert np.array_equal(value, getattr(noise, fractal)(points(5000), 6))


@pytest.mark.parametrize("shape", [(), (0,), (1,), (7,), (257,), (3, 0, 2), (4, 5), (2, 3, 4)])
def test_shapes_are_kept(shape):
    p = points(*shape)
    rows, arrays = noise.fbm(p, 3), noise.fbm(tuple(np.moveaxis(p, -1, 0)), 3)
    assert isinstance(rows, np.ndarray) and rows.shape == arrays.shape == shape
    assert np.array_equal(rows, arrays)


def test_a_list_and_a_tuple_of_numbers_are_points():
    assert noise.sample([[0.5, 0.25], [1.5, 2.0]]).shape == (2,)
    assert noise.sample((0.5, 0.25)).shape == ()
    assert noise.sample((0.5, 0.25)) == noise.sample([[0.5, 0.25]])[0]


def test_whatever_lies_strangely_in_memory_gives_the_same():
    p = points(60, 40)
    expected = noise.fbm(p, 4)
    assert np.array_equal(noise.fbm(np.asfortranarray(p), 4), expected)
    assert np.array_equal(noise.fbm(p[::-1, ::2], 4), expected[::-1, ::2])
    assert np.array_equal(noise.fbm(p[..., ::-1][..., ::-1], 4), expected)
    assert np.array_equal(noise.fbm(p.astype(">f4"), 4), expected)
    p.flags.writeable = False
    assert np.array_equal(noise.fbm(p, 4), expected)
    unaligned = np.frombuffer(b"\0" + p.tobytes(), np.uint8)[1:].view(np.float32).reshape(p.shape)
    assert not unaligned.flags.aligned
    assert np.array_equal(noise.fbm(unaligned, 4), expected)


@pytest.mark.parametrize("dtype", [np.int8, np.uint16, np.int32, np.int64, np.uint64, np.float16])
def test_integers_and_halves_are_converted(dtype):
    p = np.abs(points(100)).astype(dtype)
    value = noise.sample(p, frequency=0.37)
    assert np.abs(value - noise.sample(p.astype(np.float64), frequency=0.37)).max() < 1e-5


def test_mixed_precisions_become_the_finer_one():
    x, y = points(100, dimensions=2).T
    mixed, fine = noise.sample((x.astype(np.float64), y)), noise.sample((x.astype(float), y.astype(float)))
    assert np.array_equal(mixed, fine)


@pytest.mark.parametrize(("kind", "dimensions", "dtype"), EACH_PRECISION)
@pytest.mark.parametrize("threads", [1, None])
def test_nan_and_infinity_give_nan_and_touch_nothing_else(kind, dimensions, dtype, threads):
    p = points(600, dimensions=dimensions, dtype=dtype)
    expected = noise.fbm(p, 3, kind=kind, threads=threads)
    bad = np.zeros(len(p), bool)
    for place, value in ((3, np.nan), (100, np.inf), (101, -np.inf), (599, np.nan)):
        p[place, place % dimensions] = value
        bad[place] = True
    value = noise.fbm(p, 3, kind=kind, threads=threads)
    assert np.isnan(value[bad]).all()
    # where cells cannot be found in float32 they are in float64, which shears simplices more exactly
    assert np.abs(value[~bad] - expected[~bad]).max() <= (1e-5 if kind == "simplex" else 0)


@pytest.mark.parametrize(("kind", "dimensions", "dtype"), EACH_PRECISION)
def test_absurdly_far_away_nothing_crashes(kind, dimensions, dtype):
    for far in (1e6, 2.0**31, -(2.0**31), 2.0**40, -1e18, 3e38):
        value = noise.fbm(np.full((33, dimensions), far, dtype), 4, kind=kind)
        assert np.isfinite(value).all() or far in (2.0**40, -1e18, 3e38)


def test_any_number_of_threads_gives_the_same():
    p = points(20_011)
    expected = noise.fbm(p, 5, threads=1)
    for threads in (2, 3, 4096, None, np.int64(2)):
        assert np.array_equal(noise.fbm(p, 5, threads=threads), expected)


def test_out_is_filled_and_returned():
    p = points(40, 30)
    expected = noise.fbm(p, 4)
    out = np.empty((40, 30), np.float32)
    assert noise.fbm(p, 4, out=out) is out and np.array_equal(out, expected)
    strided = np.zeros((40, 60), np.float32)[:, ::2]
    assert noise.fbm(p, 4, out=strided) is strided and np.array_equal(strided, expected)
    turned = np.empty((30, 40), np.float32).T
    assert noise.fbm(p, 4, out=turned) is turned and np.array_equal(turned, expected)
    table = np.zeros((1200, 4), np.float32)  # points and values interleaved: no byte is shared
    table[:, :3] = p.reshape(-1, 3)
    noise.fbm(table[:, :3], 4, out=table[:, 3])
    assert np.array_equal(table[:, 3], expected.ravel())


def test_seeds_differ_and_the_largest_is_allowed():
    p = points(1000)
    a, b, c = (noise.sample(p, seed=s) for s in (0, 1, 2**32 - 1))
    assert not np.array_equal(a, b) and not np.array_equal(a, c)
    assert np.array_equal(c, noise.sample(p, seed=np.uint32(2**32 - 1)))


def test_frequency_scales_the_points():
    p = points(1000, dtype=np.float64)
    assert np.abs(noise.fbm(p, 4, frequency=2.0) - noise.fbm(2.0 * p, 4)).max() < 1e-6


@pytest.mark.parametrize(("kind", "dimensions"), [(k, d) for k, d in EACH if d in KINDS[k].periodic])
def test_a_period_repeats_exactly(kind, dimensions):
    p = np.random.default_rng(1).integers(0, 512, (2000, dimensions)) / 64.0  # exact in float32
    period = (3, 2, 1, 5)[:dimensions]
    value = noise.fbm(p, 4, kind=kind, period=period, seed=5)
    for axis in range(dimensions):
        for turns in (1, -2, 64):
            moved = p.copy()
            moved[:, axis] += turns * period[axis]
            assert np.array_equal(noise.fbm(moved, 4, kind=kind, period=period, seed=5), value)


def test_one_number_is_the_period_of_all_axes():
    p = points(500)
    assert np.array_equal(noise.sample(p, period=4), noise.sample(p, period=(4, 4, 4)))


def test_spacing_removes_what_samples_cannot_show():
    p = points(2000)
    full = noise.fbm(p, 8)
    assert np.array_equal(noise.fbm(p, 8, spacing=2.0**-11), full)
    assert not noise.fbm(p, 8, spacing=1.0).any()
    two = noise.fbm(p, 8, spacing=0.125)  # octaves 0 and 1 with 8 and 4 samples a wave, the third with 2
    weights = 0.5 ** np.arange(8)
    assert np.allclose(two, noise.fbm(p, 2) * weights[:2].sum() / weights.sum(), atol=1e-6)
    fades = fades_of(2.0**-1.5 / 8, 8, 2.0, 1.0)
    assert fades is not None and fades[0] == 1 and fades[-1] == 0 and abs(fades[3] - 0.5) < 1e-9


def test_warp_by_nothing_is_fbm_and_by_something_is_not():
    p = points(2000)
    assert np.abs(noise.warp(p, 0.0, 4) - noise.fbm(p, 4)).max() < 1e-6
    assert np.abs(noise.warp(p, 1.0, 4) - noise.fbm(p, 4)).max() > 0.1


@pytest.mark.parametrize("kind", [name for name, about in KINDS.items() if about.gradient])
@pytest.mark.parametrize("dimensions", [2, 3])
def test_gradient_gives_the_value_and_its_slope(kind, dimensions):
    p = points(500, dimensions=dimensions, dtype=np.float64) / 10
    value, slope = noise.gradient(p, kind, seed=3, frequency=0.7)
    assert value.shape == (500,) and slope.shape == (500, dimensions) and slope.dtype == np.float32
    assert np.abs(value - noise.sample(p, kind, seed=3, frequency=0.7)).max() < 1e-6
    for axis in range(dimensions):
        step = np.eye(dimensions)[axis] * 1e-2
        ahead, behind = (noise.sample(p + s, kind, seed=3, frequency=0.7) for s in (step, -step))
        assert np.abs((ahead - behind) / 2e-2 - slope[:, axis]).max() < 5e-3


@pytest.mark.parametrize("dimensions", [2, 3])
def test_curl_has_one_velocity_a_point(dimensions):
    p = points(30, 20, dimensions=dimensions)
    velocity = noise.curl(p, octaves=3)
    assert velocity.shape == (30, 20, dimensions) and velocity.dtype == np.float32
    out = np.empty((30, 20, 2 * dimensions), np.float32)[..., ::2]
    assert noise.curl(p, octaves=3, out=out) is out and np.array_equal(out, velocity)


@pytest.mark.parametrize("shape", [(5, 7), (3, 4, 5), (2, 3, 4, 5), (0, 4), (1, 1), (300, 1000)])
def test_grid_is_what_its_points_give(shape):
    count = len(shape)
    step, origin = (0.5, 0.25, 0.125, 1.5)[:count], (-1.5, 7.25, 0.5, 100.0)[:count]
    value = noise.grid(shape, step=step, origin=origin, octaves=3, seed=4)
    places = np.indices(shape)[::-1]
    expected = noise.fbm(tuple(o + s * i for o, s, i in zip(origin, step, places, strict=True)), 3, seed=4)
    assert value.shape == shape and value.dtype == np.float32
    assert np.array_equal(value, expected)


def test_a_periodic_grid_fits_to_its_copies():
    tile = noise.grid((64, 96), period=(6, 4), octaves=4, frequency=3.0)
    wide = noise.grid((64, 192), period=(6, 4), octaves=4, frequency=3.0, step=(6 / 3 / 96, 4 / 3 / 64))
    assert np.array_equal(wide[:, :96], tile) and np.abs(wide[:, 96:] - tile).max() < 1e-6


def test_cube_is_what_its_directions_give():
    value = noise.cube(16, octaves=4, radius=3.0, seed=2)
    ways = noise.cube_directions(16)
    assert value.shape == (6, 16, 16) and np.abs(np.linalg.norm(ways, axis=-1) - 1).max() < 1e-12
    assert np.abs(value - noise.fbm(3.0 * ways, 4, seed=2)).max() < 1e-6
    for face, axis, sign in ((0, 0, 1), (1, 0, -1), (2, 1, 1), (3, 1, -1), (4, 2, 1), (5, 2, -1)):
        assert (sign * ways[face, ..., axis] > 0.57).all()


def test_cube_has_no_seams():
    """Neighbouring texels over an edge are as alike as those within a face."""
    size = 64
    value, ways = noise.cube(size, octaves=3).reshape(-1), noise.cube_directions(size).reshape(-1, 3)
    edge = np.abs(np.sort(np.abs(ways), axis=1)[:, 1] / np.abs(ways).max(1)) > 1 - 2.0 / size
    near = ways[edge] @ ways[edge].T > np.cos(1.6 / size)
    assert np.abs(value[edge][:, None] - value[edge])[near].max() < 0.2


NOT_ALLOWED = [
    ({"kind": "perln"}, r"kind='perln' is not allowed: it must be perlin, .* \(did you mean 'perlin'\?\)"),
    ({"kind": None}, "kind=None is not allowed"),
    ({"kind": "x" * 500}, "kind='xxx.*…"),
    ({"fractal": "fmb"}, r"fractal='fmb' .*did you mean 'fbm'"),
    ({"octaves": 0}, "octaves=0 is not allowed: it must be an integer from 1 to 32"),
    ({"octaves": 33}, "octaves=33 is not allowed"),
    ({"octaves": 2.5}, "octaves=2.5 is not allowed"),
    ({"octaves": True}, "octaves=True is not allowed"),
    ({"octaves": 10**400}, "octaves=1000.*… is not allowed"),
    ({"octaves": "8"}, "octaves='8' is not allowed"),
    ({"lacunarity": 0.5}, "lacunarity=0.5 is not allowed: it must be a number from 1 to 16"),
    ({"lacunarity": np.nan}, "lacunarity=nan is not allowed"),
    ({"gain": -0.1}, "gain=-0.1 is not allowed: it must be a number from 0 to 4"),
    ({"gain": np.inf}, "gain=inf is not allowed"),
    ({"seed": -1}, "seed=-1 is not allowed: it must be an integer from 0 to 4294967295"),
    ({"seed": 2**32}, "seed=4294967296 is not allowed"),
    ({"seed": 1.0}, "seed=1.0 is not allowed"),
    ({"frequency": 0}, "frequency=0 is not allowed"),
    ({"frequency": "1"}, "frequency='1' is not allowed"),
    ({"frequency": 1j}, "frequency=1j is not allowed"),
    ({"spacing": 0.0}, "spacing=0.0 is not allowed"),
    ({"spacing": -1}, "spacing=-1 is not allowed"),
    ({"threads": 0}, "threads=0 is not allowed: it must be an integer from 1"),
    ({"period": 0}, "period=0 is not allowed"),
    ({"period": 2.5}, "period=2.5 is not allowed"),
    ({"period": (4, 4)}, r"period=\(4, 4\) is not allowed: it must be an integer, or 3 of them"),
    ({"period": "444"}, "period='444' is not allowed"),
    ({"period": 4, "lacunarity": 1.9}, "lacunarity=1.9 is not allowed with a period"),
    ({"period": LARGEST_PERIOD, "octaves": 2}, r"period=.* is not allowed with octaves=2"),
    ({"out": [1, 2]}, r"out=\[1, 2\] is not allowed: it must be a numpy array"),
    (
        {"out": np.empty(9, np.float32)},
        r"out is float32 of shape \(9,\): it must be float32 of shape \(10,\)",
    ),
    ({"out": np.empty(10)}, "out is float64 of shape"),
    ({"out": np.broadcast_to(np.float32(0), (10,))}, "out is read-only"),
]


@pytest.mark.parametrize(
    ("options", "message"), NOT_ALLOWED, ids=lambda value: value[:40] if isinstance(value, str) else ""
)
def test_what_is_not_allowed_is_said_in_one_sentence(options, message):
    with pytest.raises(ValueError, match=message) as caught:
        noise.fbm(points(10), **({"octaves": 4} | options))
    assert len(str(caught.value)) < 260 and "\n" not in str(caught.value)


BAD_POINTS = [
    (1.5, "points is a single number"),
    ([1.0, 2.0, 3.0, 4.0, 5.0], r"points of shape \(5,\) have 5 coordinates"),
    (np.zeros((4, 1)), r"points of shape \(4, 1\) have 1 coordinate:"),
    (np.zeros((4, 0)), "have 0 coordinates"),
    ((np.zeros(3),), "points is a tuple of 1 coordinate"),
    ((np.zeros(3), np.zeros(4)), r"points has arrays of shapes \(3,\) and \(4,\)"),
    ((), "points is a tuple of 0 coordinates"),
    ([["a", "b"]], "points has dtype <U1: it must be float32, float64 or an integer type"),
    (None, "points has dtype object"),
    ([[True, False]], "points has dtype bool"),
    ([[1j, 2j]], "points has dtype complex128"),
    ([[1.0, 2.0], [3.0]], "points is not an array: its rows have different lengths"),
]


@pytest.mark.parametrize(
    ("bad", "message"), BAD_POINTS, ids=lambda value: value[:40] if isinstance(value, str) else ""
)
def test_bad_points_are_said_in_one_sentence(bad, message):
    with pytest.raises(ValueError, match=message):
        noise.sample(bad)


def test_out_must_not_be_part_of_the_points():
    p = points(10)
    with pytest.raises(ValueError, match="out shares memory with points"):
        noise.sample(p, out=p[:, 0])


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (
            lambda: noise.sample(points(3, dimensions=4), "value"),
            "kind='value' .* 4 dimensions: it has 2 or 3",
        ),
        (
            lambda: noise.gradient(points(3), "value"),
            "kind='value' is not allowed: it must be perlin or simplex",
        ),
        (lambda: noise.curl(points(3, dimensions=4)), "curl noise is in 2 or 3 dimensions"),
        (lambda: noise.warp(points(3), np.nan), "amount=nan is not allowed"),
        (lambda: noise.grid((4,)), r"shape=\(4,\) is not allowed: it must have 2, 3 or 4 sizes"),
        (lambda: noise.grid(4), "shape=4 is not allowed"),
        (lambda: noise.grid((4, -1)), "shape=-1 is not allowed"),
        (lambda: noise.grid((4, 2.0)), "shape=2.0 is not allowed"),
        (lambda: noise.grid((4, 4), step=(1, 2, 3)), r"step=\(1, 2, 3\) .* 2 of them"),
        (lambda: noise.grid((4, 4), origin=np.inf), "origin=inf is not allowed"),
        (lambda: noise.cube(0), "size=0 is not allowed: it must be an integer from 1 to 16384"),
        (lambda: noise.cube(4, radius=-1), "radius=-1 is not allowed"),
    ],
)
def test_other_functions_refuse_as_clearly(call, message):
    with pytest.raises(ValueError, match=message):
        call()


def test_the_functions_are_not_hidden_by_modules_of_the_same_name():
    import fallstreak.noise

    p = points(3, dimensions=2)
    for _ in range(2):  # the first call may import modules
        noise.curl(p)
        noise.gradient(p)
    assert callable(fallstreak.noise.gradient) and callable(fallstreak.noise.curl)


def test_importing_compiles_nothing():
    code = """
import sys
import numba.core.dispatcher as d
compiled = []
d.Dispatcher.compile = lambda self, signature: compiled.append(self)
import fallstreak as fs
assert "numba" in sys.modules and "fallstreak.noise" not in sys.modules
fs.noise.fbm
print(compiled)
"""
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert result.stdout == "[]\n", result.stderr
