"""Every kind of noise written a second time, in float64 numpy, from the definitions and not from the package.

Slow and plain on purpose: corners are visited one by one, derivatives are differences of the value, a curl is
the curl of differences. Points are ``(..., D)`` float64 arrays in cells; `words` are what a seed and an
octave give the hash (`axis_words`), `period` is None or D integers.

Sources: K. Perlin, "Improving noise" (2002) and his reference implementation for `improved`; S. Worley, "A
cellular texture basis function" (1996); S. Gustavson, "Simplex noise demystified" (2005); F. K. Musgrave in
"Texturing and modeling", ch. 16, for the multifractals; R. Bridson, "Curl-noise" (2007).
"""

from __future__ import annotations

from itertools import product

import numpy as np

MASK = 0xFFFFFFFF

# fmt: off
PERMUTATION = np.array([
    151,160,137,91,90,15,131,13,201,95,96,53,194,233,7,225,140,36,103,30,69,142,8,99,37,240,21,10,23,
    190,6,148,247,120,234,75,0,26,197,62,94,252,219,203,117,35,11,32,57,177,33,88,237,149,56,87,174,20,
    125,136,171,168,68,175,74,165,71,134,139,48,27,166,77,146,158,231,83,111,229,122,60,211,133,230,220,
    105,92,41,55,46,245,40,244,102,143,54,65,25,63,161,1,216,80,73,209,76,132,187,208,89,18,169,200,196,
    135,130,116,188,159,86,164,100,109,198,173,186,3,64,52,217,226,250,124,123,5,202,38,147,118,126,255,
    82,85,212,207,206,59,227,47,16,58,17,182,189,28,42,223,183,170,213,119,248,152,2,44,154,163,70,221,
    153,101,155,167,43,172,9,129,22,39,253,19,98,108,110,79,113,224,232,178,185,112,104,218,246,97,228,
    251,34,242,193,238,210,144,12,191,179,162,241,81,51,145,235,249,14,239,107,49,192,214,31,181,199,
    106,157,184,84,204,176,115,121,50,45,127,4,150,254,138,236,205,93,222,114,67,29,24,72,243,141,128,
    195,78,66,215,61,156,180,
])
# fmt: on
assert sorted(PERMUTATION) == list(range(256))


def scattered(dimensions, count=4000, reach=60.0, seed=3):
    """Points anywhere within `reach` of the origin, (count, D)."""
    return np.random.default_rng(seed).uniform(-reach, reach, (count, dimensions))


def fade(t):
    return t * t * t * (t * (t * 6.0 - 15.0) + 10.0)


def lattice(points, period):
    """Cell, fraction, and a function that gives the wrapped int64 index at an offset from the cell."""
    points = np.asarray(points, np.float64)
    cell = np.floor(points)
    fraction = points - cell
    cell = cell.astype(np.int64)

    def at(offset):
        index = cell + np.asarray(offset)
        return index if period is None else np.mod(index, np.asarray(period))

    return fraction, at


def lerp_corners(fraction, corner):
    """Σ over the 2^D corners of ``corner(offset)`` times the product of the faded weights."""
    dimensions = fraction.shape[-1]
    weight = fade(fraction)
    total = 0.0
    for offset in product((0, 1), repeat=dimensions):
        share = np.prod([weight[..., d] if o else 1 - weight[..., d] for d, o in enumerate(offset)], axis=0)
        total = total + share * corner(offset)
    return total


# -- the hash -----------------------------------------------------------------------------------------------


GOLDEN = 0x9E3779B9


def fmix32(h):
    """The finaliser of MurmurHash 3 (A. Appleby)."""
    h = np.asarray(h, np.uint64) & MASK
    h = ((h ^ (h >> 16)) * 0x85EBCA6B) & MASK
    h = ((h ^ (h >> 13)) * 0xC2B2AE35) & MASK
    return h ^ (h >> 16)


def axis_words(seed, octave):
    """One 32-bit number per axis, x first."""
    state = int(fmix32((int(fmix32((int(seed) + GOLDEN) & MASK)) + octave * GOLDEN) & MASK))
    return fmix32((state + np.arange(1, 5, dtype=np.uint64) * GOLDEN) & MASK)


def signed16(h):
    h = np.asarray(h).astype(np.int64) & 0xFFFF
    return h - ((h >> 15) << 16)


def corner_factors(index, words):
    """The two hashed factors of a lattice point, odd 16-bit numbers in int64 arrays."""
    t = (index.astype(np.uint64) * np.uint64(0x9E3779B1) + words[: index.shape[-1]]) & np.uint64(MASK)
    h = (((t ^ (t >> np.uint64(16))) & np.uint64(0xFFFF)) | np.uint64(0x8001)).astype(np.int64)
    if index.shape[-1] == 2:
        return h[..., 0], h[..., 1]
    a = (h[..., 0] * h[..., 1]) & 0xFFFF
    return a, h[..., 2] if index.shape[-1] == 3 else (h[..., 2] * h[..., 3]) & 0xFFFF


def hash_index(index, words, entries):
    a, b = corner_factors(index, words)
    return ((a * b) >> 16) & (entries - 1)


def hash_value(index, words):
    a, b = corner_factors(index, words)
    return signed16(a * b) / 32768.0


def hash_bits(index, words):
    a, b = corner_factors(index, words)
    p = ((a * b) & MASK) * 0x2C1B3C6D & MASK
    p = (p ^ (p >> 15)) * 0x297A2D39 & MASK
    return p ^ (p >> 15)


# -- Ken Perlin's table -------------------------------------------------------------------------------------


def improved_gradient(h, x, y, z):
    """The product with one of 12 edges, as the Java reference writes it."""
    h = h & 15
    u = np.where(h < 8, x, y)
    v = np.where(h < 4, y, np.where((h == 12) | (h == 14), x, z))
    return np.where(h & 1, -u, u) + np.where(h & 2, -v, v)


def table_shift(words):
    """By how many cells a seed moves the lattice of the kinds with a fixed permutation; 0 for seed 0."""
    return ((words ^ axis_words(0, 0)) & np.uint64(255)).astype(np.int64)[:3]


def permuted(index):
    x, y, z = index
    return PERMUTATION[(PERMUTATION[(PERMUTATION[x & 255] + y) & 255] + z) & 255]


def improved(points, words, period=None):
    fraction, at = lattice(points, period)
    shift = table_shift(words)
    flat = fraction.shape[-1] == 2

    def corner(offset):
        index = at(offset) + shift[: len(offset)]
        x, y = (fraction[..., d] - offset[d] for d in (0, 1))
        z = np.zeros_like(x) if flat else fraction[..., 2] - offset[2]
        row = np.full(x.shape, shift[2]) if flat else index[..., 2]
        return improved_gradient(permuted((index[..., 0], index[..., 1], row)), x, y, z)

    return lerp_corners(fraction, corner)


mixed = fmix32((np.arange(1, 257, dtype=np.uint64) * 0x9E3779B1) & MASK).astype(np.uint32).view(np.int32)
TABLE = np.tile(mixed * (0.7 / 2**31), 2)


def table(points, words, period=None):
    """The journal's: random values where Improved noise has gradients."""
    fraction, at = lattice(points, period)
    shift = table_shift(words)

    def corner(offset):
        index = (at(offset) + shift[: len(offset)]) & 255
        z = index[..., 2] if len(offset) == 3 else shift[2]
        return TABLE[PERMUTATION[(PERMUTATION[index[..., 0]] + index[..., 1]) & 255] + z]

    return lerp_corners(fraction, corner)


# -- gradients -----------------------------------------------------------------------------------------------


def gradient(index, words):
    """The gradient of a lattice point: 8 directions, Perlin's 12 edges (four twice), 32 edges."""
    dimensions = index.shape[-1]
    if dimensions == 2:
        g = hash_index(index, words, 8)
        x, y = np.where(g & 4, 2 - np.sqrt(2), np.sqrt(2)), np.where(g & 4, np.sqrt(2), 2 - np.sqrt(2))
        return np.stack([np.where(g & 1, -x, x), np.where(g & 2, -y, y)], -1)
    if dimensions == 3:
        g = hash_index(index, words, 16)
        return np.stack([improved_gradient(g, *unit) for unit in np.eye(3)], -1)
    g = hash_index(index, words, 32)
    result = np.zeros((*g.shape, 4))
    signs = [np.where(g & 4, -1, 1), np.where(g & 8, -1, 1), np.ones_like(g)]
    for zero in range(4):
        for axis, sign in zip([a for a in range(4) if a != zero], signs, strict=True):
            result[..., axis] = np.where((g & 3) == zero, sign, result[..., axis])
    return result * np.where(g & 16, -1, 1)[..., None] * (2 / 3)


def perlin(points, words, period=None):
    fraction, at = lattice(points, period)

    def corner(offset):
        return (gradient(at(offset), words) * (fraction - offset)).sum(-1)

    return lerp_corners(fraction, corner)


SIMPLEX_SCALES = {2: 65.35, 3: 76.88, 4: 62.77 * 1.5}  # make 1 the largest value


def simplex(points, words, period=None):
    """Every corner of the simplex that holds the point, with a kernel that ends at its far side."""
    if period is not None:
        return periodic_simplex(points, words, period)
    points = np.asarray(points, np.float64)
    dimensions = points.shape[-1]
    root = np.sqrt(dimensions + 1)
    sheared = points + points.sum(-1, keepdims=True) * ((root - 1) / dimensions)
    fraction, at = lattice(sheared, None)
    # from the lowest corner of the cube, a step along the axis of the largest fraction first
    order = np.argsort(-fraction, axis=-1, kind="stable")
    corner = np.zeros(fraction.shape, np.int64)
    total = np.zeros(fraction.shape[:-1])
    for step in range(dimensions + 1):
        if step:
            np.put_along_axis(corner, order[..., step - 1 : step], 1, -1)
        way = fraction - corner
        way = way - way.sum(-1, keepdims=True) * ((1 - 1 / root) / dimensions)
        kernel = np.maximum(0.5 - (way**2).sum(-1), 0) ** 4
        total += kernel * (gradient(at(corner), words) * way).sum(-1)
    return total * SIMPLEX_SCALES[dimensions]


def periodic_simplex(points, words, period):
    """Every point of a repeating lattice (Gustavson, McEwan 2022) that is near, simplices or not.

    2-D: rows of whole numbers, odd ones moved by a half, hashed by the cell they lie in and the row. 3-D: all
    whole numbers, and all of them moved by (1/2, 1/2, 1/2), hashed by twice their coordinates.
    """
    fraction, _ = lattice(points, None)
    cell = np.floor(points).astype(np.int64)
    dimensions = fraction.shape[-1]
    flat = dimensions == 2
    total = np.zeros(fraction.shape[:-1])
    for half in product(range(-2, 5), repeat=dimensions):  # twice the way from the cell
        if half[1] % 2 if flat else len({h % 2 for h in half}) > 1:
            continue
        way = fraction - np.array(half) / 2
        place = 2 * cell + half
        if flat:
            index, there = place // 2 % period, (place[..., 0] - place[..., 1] // 2) % 2 == 0
        else:
            index, there = place % (2 * period), True
        kernel = np.maximum((0.8 if flat else 0.5) - (way**2).sum(-1), 0) ** 4
        total += there * kernel * (gradient(index, words) * way).sum(-1)
    return total * (7.555 if flat else SIMPLEX_SCALES[3])


# -- value and cellular -------------------------------------------------------------------------------------


def value(points, words, period=None):
    fraction, at = lattice(points, period)
    return lerp_corners(fraction, lambda offset: hash_value(at(offset), words))


def feature_point(index, words):
    """Where in its cell the feature point lies, (..., D) in [0, 1)."""
    h = hash_bits(index, words)
    fields = (h >> 9, h << 7) if index.shape[-1] == 2 else (h >> 9, h << 2, h << 13)
    return np.stack([(f & 0x7FFFFF) / 2.0**23 for f in fields], -1)


def cellular(points, words, period=None):
    """Distances to the nearest and second nearest feature point, over all 5^D cells that can hold them."""
    fraction, at = lattice(points, period)
    dimensions = fraction.shape[-1]
    first = np.full(fraction.shape[:-1], np.inf)
    second = first.copy()
    for offset in product(range(-2, 3), repeat=dimensions):
        distance = np.linalg.norm(feature_point(at(offset), words) + offset - fraction, axis=-1)
        second = np.minimum(second, np.maximum(first, distance))
        first = np.minimum(first, distance)
    return first, second


# -- kinds by name ------------------------------------------------------------------------------------------

KINDS = {
    "perlin": perlin,
    "simplex": simplex,
    "value": value,
    "cellular_f1": lambda *a: cellular(*a)[0],
    "cellular_f2": lambda *a: cellular(*a)[1],
    "cellular_f2f1": lambda *a: np.subtract(*cellular(*a)[::-1]),
    "improved": improved,
    "table": table,
}


def sample(points, kind, seed=0, frequency=1.0, period=None):
    """One octave of the public seed."""
    return KINDS[kind](np.asarray(points, np.float64) * frequency, axis_words(seed, 0), cells(points, period))


def cells(points, period):
    """The period as D integers, or None."""
    return None if period is None else np.broadcast_to(period, np.shape(points)[-1:]).astype(np.int64)


def clamp_weights(octaves, frequency, lacunarity, spacing):
    """1 while the wavelength is over four spacings, 0 under two, smoothstep of its logarithm between."""
    if spacing is None:
        return np.ones(octaves)
    t = np.clip(np.log2(1.0 / (frequency * lacunarity ** np.arange(octaves) * spacing)) - 1, 0, 1)
    return t * t * (3 - 2 * t)


def fbm(points, octaves, kind="perlin", fractal="fbm", lacunarity=2.0, gain=0.5, seed=0, frequency=1.0,
        period=None, spacing=None, offset=0):  # fmt: skip
    """The fractals of every kind; `offset` is added to the octave's number where seeds are drawn."""
    points = np.asarray(points, np.float64)
    period = cells(points, period)
    amplitude = gain ** np.arange(octaves, dtype=np.float64)
    kept = amplitude * clamp_weights(octaves, frequency, lacunarity, spacing)
    total = np.zeros(points.shape[:-1])
    weight = np.ones_like(total)
    for i in range(octaves):
        if kept[i] == 0:
            continue
        n = KINDS[kind](
            points * (frequency * lacunarity**i),
            axis_words(seed, i + offset),
            None if period is None else period * int(lacunarity) ** i,
        )
        if fractal == "fbm":
            total += kept[i] * n
        elif fractal == "billow":
            total += kept[i] * (2 * np.abs(n) - 1)
        elif fractal == "turbulence":
            total += kept[i] * np.abs(n)
        elif fractal == "ridged":
            t = (1 - np.abs(n)) ** 2 * weight
            total += kept[i] * t
            weight = np.clip(2 * t, 0, 1)
        elif fractal == "hybrid":
            t = (n + 0.7) * weight
            total += kept[i] * t
            weight = np.clip(t, 0, 1)
        else:
            raise ValueError(fractal)
    return total / amplitude.sum()


def warp(points, amount, octaves, **options):
    points = np.asarray(points, np.float64)
    moved = [fbm(points, octaves, offset=256 * (k + 1), **options) for k in range(points.shape[-1])]
    return fbm(points + amount * np.stack(moved, -1), octaves, **options)


def differences(function, points, step=1e-4):
    """Derivatives of a function of points by central differences of fourth order, (..., D)."""
    points = np.asarray(points, np.float64)
    slopes = []
    for axis in range(points.shape[-1]):
        way = np.zeros(points.shape[-1])
        way[axis] = step
        near = function(points + way) - function(points - way)
        far = function(points + 2 * way) - function(points - 2 * way)
        slopes.append((8 * near - far) / (12 * step))
    return np.stack(slopes, -1)


def curl(points, octaves=1, step=1e-4, **options):
    """The curl of a potential of Perlin noise, by differences of the potential."""

    def slopes(offset):
        return differences(lambda p: fbm(p, octaves, offset=offset, **options), points, step)

    if np.shape(points)[-1] == 2:
        s = slopes(0)
        return np.stack([s[..., 1], -s[..., 0]], -1)
    a, b, c = (slopes(256 * k) for k in range(3))
    return np.stack([c[..., 1] - b[..., 2], a[..., 2] - c[..., 0], b[..., 0] - a[..., 1]], -1)
