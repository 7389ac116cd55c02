"""Simplex noise (K. Perlin 2001, in the form of S. Gustavson, "Simplex noise demystified", 2005).

Points are sheared by F = (√(D + 1) − 1) / D of the sum of their coordinates, so that simplices become
halves (sixths, 24ths) of cubes: `place.py` finds the cube and the offsets in it. Sorting the offsets tells
the corners of the simplex: from the cube's own corner one step along each axis, largest offset first. Back
in the points' space (G of their sum subtracted) each corner adds ``(1/2 − r²)^4 · gradient · way``, while
r² < 1/2, where gradients and hash are those of Perlin noise. With this radius every corner's share ends
before the simplex does, so the noise is smooth everywhere. `SCALES` make 1 the largest possible value.

With a period it lies on another lattice: `simplex_periodic.py`.
"""

from __future__ import annotations

from .gradients import gradient2, gradient3, gradient4, unscale
from .kernels import kernel
from .lanes import fma, larger, select
from .lattice import axis_pair, index, inlined, pair
from .place import unshear

SCALES = (65.35, 76.88, 62.77)
S2, S3, S4 = SCALES
G2, G3, G4 = (unshear(d) for d in (2, 3, 4))


@inlined
def _corners2(cells, offsets, words, periods):
    """Index and way of each of the three corners."""
    hx0, hx1 = axis_pair(cells[0], words[0], periods[0])
    hy0, hy1 = axis_pair(cells[1], words[1], periods[1])
    x, y = offsets
    first = x > y
    middle = index(select(first, hx1, hx0), select(first, hy0, hy1))
    return (
        (index(hx0, hy0), x, y),
        (middle, x + select(first, G2 - 1.0, G2), y + select(first, G2, G2 - 1.0)),
        (index(hx1, hy1), x + (2.0 * G2 - 1.0), y + (2.0 * G2 - 1.0)),
    )


@inlined
def _share2(corner):
    """What a corner adds: falloff and gradient along the way, to be multiplied."""
    h, x, y = corner
    t = larger(0.0, fma(-x, x, fma(-y, y, 0.5)))
    t = t * t
    gx, gy = gradient2(h)
    return t * t, fma(gx, x, gy * y)


@kernel("simplex", 2)
def simplex2(cells, offsets, words, periods):
    a, b, c = _corners2(cells, offsets, words, periods)
    fall, ramp = _share2(a)
    total = fall * ramp
    fall, ramp = _share2(b)
    total = fma(fall, ramp, total)
    fall, ramp = _share2(c)
    return (fma(fall, ramp, total) * S2,)


@inlined
def _corners3(cells, offsets, words, periods):
    hx0, hx1 = axis_pair(cells[0], words[0], periods[0])
    hy0, hy1 = axis_pair(cells[1], words[1], periods[1])
    hz0, hz1 = axis_pair(cells[2], words[2], periods[2])
    x, y, z = offsets
    xy, xz, yz = x > y, x > z, y > z
    # the axis of the largest offset comes first, that of the smallest last
    i, j, k = xy & xz, ~xy & yz, ~(xz | yz)
    hx, hy, hz = select(i, hx1, hx0), select(j, hy1, hy0), select(k, hz1, hz0)
    first = (
        index(pair(hx, hy), hz),
        x + select(i, G3 - 1.0, G3),
        y + select(j, G3 - 1.0, G3),
        z + select(k, G3 - 1.0, G3),
    )
    i, j, k = xy | xz, ~xy | yz, ~(xz & yz)
    hx, hy, hz = select(i, hx1, hx0), select(j, hy1, hy0), select(k, hz1, hz0)
    second = (
        index(pair(hx, hy), hz),
        x + select(i, 2.0 * G3 - 1.0, 2.0 * G3),
        y + select(j, 2.0 * G3 - 1.0, 2.0 * G3),
        z + select(k, 2.0 * G3 - 1.0, 2.0 * G3),
    )
    end = 3.0 * G3 - 1.0
    return (
        (index(pair(hx0, hy0), hz0), x, y, z),
        first,
        second,
        (index(pair(hx1, hy1), hz1), x + end, y + end, z + end),
    )


@inlined
def _share3(corner):
    h, x, y, z = corner
    t = larger(0.0, fma(-x, x, fma(-y, y, fma(-z, z, 0.5))))
    t = t * t
    gx, gy, gz = gradient3(h)
    return t * t, fma(gx, x, fma(gy, y, gz * z))


@kernel("simplex", 3)
def simplex3(cells, offsets, words, periods):
    a, b, c, d = _corners3(cells, offsets, words, periods)
    fall, ramp = _share3(a)
    total = fall * ramp
    fall, ramp = _share3(b)
    total = fma(fall, ramp, total)
    fall, ramp = _share3(c)
    total = fma(fall, ramp, total)
    fall, ramp = _share3(d)
    return (unscale(fma(fall, ramp, total)) * S3,)


@inlined
def _step4(rank, threshold, hashes, ways, shift):
    """The corner that lies one along every axis whose offset is among the largest."""
    (rx, ry, rz, rw), (x, y, z, w) = rank, ways
    i, j, k, m = rx >= threshold, ry >= threshold, rz >= threshold, rw >= threshold
    (hx0, hx1), (hy0, hy1), (hz0, hz1), (hw0, hw1) = hashes
    xy = pair(select(i, hx1, hx0), select(j, hy1, hy0))
    zw = pair(select(k, hz1, hz0), select(m, hw1, hw0))
    near = shift - 1.0
    return (
        index(xy, zw),
        x + select(i, near, shift),
        y + select(j, near, shift),
        z + select(k, near, shift),
        w + select(m, near, shift),
    )


@inlined
def _corners4(cells, offsets, words, periods):
    px = axis_pair(cells[0], words[0], periods[0])
    py = axis_pair(cells[1], words[1], periods[1])
    pz = axis_pair(cells[2], words[2], periods[2])
    pw = axis_pair(cells[3], words[3], periods[3])
    x, y, z, w = offsets
    xy, xz, xw = select(x > y, 1.0, 0.0), select(x > z, 1.0, 0.0), select(x > w, 1.0, 0.0)
    yz, yw, zw = select(y > z, 1.0, 0.0), select(y > w, 1.0, 0.0), select(z > w, 1.0, 0.0)
    # how many of the others each offset exceeds
    rank = xy + xz + xw, yz + yw + (1.0 - xy), zw + (2.0 - xz - yz), 3.0 - xw - yw - zw
    hashes, ways = (px, py, pz, pw), (x, y, z, w)
    end = 4.0 * G4 - 1.0
    return (
        (index(pair(px[0], py[0]), pair(pz[0], pw[0])), x, y, z, w),
        _step4(rank, 3.0, hashes, ways, G4),
        _step4(rank, 2.0, hashes, ways, 2.0 * G4),
        _step4(rank, 1.0, hashes, ways, 3.0 * G4),
        (index(pair(px[1], py[1]), pair(pz[1], pw[1])), x + end, y + end, z + end, w + end),
    )


@inlined
def _share4(corner):
    h, x, y, z, w = corner
    t = larger(0.0, fma(-x, x, fma(-y, y, fma(-z, z, fma(-w, w, 0.5)))))
    t = t * t
    gx, gy, gz, gw = gradient4(h)
    return t * t, fma(gx, x, fma(gy, y, fma(gz, z, gw * w)))


@kernel("simplex", 4)
def simplex4(cells, offsets, words, periods):
    a, b, c, d, e = _corners4(cells, offsets, words, periods)
    fall, ramp = _share4(a)
    total = fall * ramp
    fall, ramp = _share4(b)
    total = fma(fall, ramp, total)
    fall, ramp = _share4(c)
    total = fma(fall, ramp, total)
    fall, ramp = _share4(d)
    total = fma(fall, ramp, total)
    fall, ramp = _share4(e)
    return (unscale(fma(fall, ramp, total)) * S4,)


# -- with derivatives: t^4 (g·d) has the derivatives t^4 g - 8 t^3 (g·d) d
# ------------------------------------


@inlined
def _slopes2(corner):
    h, x, y = corner
    t = larger(0.0, fma(-x, x, fma(-y, y, 0.5)))
    cube = t * t * t
    fall = cube * t
    gx, gy = gradient2(h)
    ramp = fma(gx, x, gy * y)
    pull = -8.0 * cube * ramp
    return fall * ramp, fma(fall, gx, pull * x), fma(fall, gy, pull * y)


@kernel("simplex", 2, derivatives=True)
def simplex2_slopes(cells, offsets, words, periods):
    a, b, c = _corners2(cells, offsets, words, periods)
    av, ax, ay = _slopes2(a)
    bv, bx, by = _slopes2(b)
    cv, cx, cy = _slopes2(c)
    return (av + bv + cv) * S2, (ax + bx + cx) * S2, (ay + by + cy) * S2


@inlined
def _slopes3(corner):
    h, x, y, z = corner
    t = larger(0.0, fma(-x, x, fma(-y, y, fma(-z, z, 0.5))))
    cube = t * t * t
    fall = cube * t
    gx, gy, gz = gradient3(h)
    ramp = fma(gx, x, fma(gy, y, gz * z))
    pull = -8.0 * cube * ramp
    return fall * ramp, fma(fall, gx, pull * x), fma(fall, gy, pull * y), fma(fall, gz, pull * z)


@kernel("simplex", 3, derivatives=True)
def simplex3_slopes(cells, offsets, words, periods):
    a, b, c, d = _corners3(cells, offsets, words, periods)
    av, ax, ay, az = _slopes3(a)
    bv, bx, by, bz = _slopes3(b)
    cv, cx, cy, cz = _slopes3(c)
    dv, dx, dy, dz = _slopes3(d)
    return (
        unscale(av + bv + cv + dv) * S3,
        unscale(ax + bx + cx + dx) * S3,
        unscale(ay + by + cy + dy) * S3,
        unscale(az + bz + cz + dz) * S3,
    )


@inlined
def _slopes4(corner):
    h, x, y, z, w = corner
    t = larger(0.0, fma(-x, x, fma(-y, y, fma(-z, z, fma(-w, w, 0.5)))))
    cube = t * t * t
    fall = cube * t
    gx, gy, gz, gw = gradient4(h)
    ramp = fma(gx, x, fma(gy, y, fma(gz, z, gw * w)))
    pull = -8.0 * cube * ramp
    slopes = (
        fma(fall, gx, pull * x),
        fma(fall, gy, pull * y),
        fma(fall, gz, pull * z),
        fma(fall, gw, pull * w),
    )
    return fall * ramp, slopes[0], slopes[1], slopes[2], slopes[3]


@kernel("simplex", 4, derivatives=True)
def simplex4_slopes(cells, offsets, words, periods):
    a, b, c, d, e = _corners4(cells, offsets, words, periods)
    av, ax, ay, az, aw = _slopes4(a)
    bv, bx, by, bz, bw = _slopes4(b)
    cv, cx, cy, cz, cw = _slopes4(c)
    dv, dx, dy, dz, dw = _slopes4(d)
    ev, ex, ey, ez, ew = _slopes4(e)
    return (
        unscale(av + bv + cv + dv + ev) * S4,
        unscale(ax + bx + cx + dx + ex) * S4,
        unscale(ay + by + cy + dy + ey) * S4,
        unscale(az + bz + cz + dz + ez) * S4,
        unscale(aw + bw + cw + dw + ew) * S4,
    )
