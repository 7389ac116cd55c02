"""The glider: a sailplane of 15 m span, as pilots know them since fibre glass.

Axes are glTF's: x left, y up, z forward, metres; the origin is the centre of gravity, under the wing. The
wheel stands 0.62 m below it. One texture serves all: its upper half is the fuselage, unrolled, its lower the
wings and the tail.
"""

from __future__ import annotations

import numpy as np
from model_shapes import Glb, Surface, grid, join, steps

NOSE, TAIL = 2.35, -4.35
AROUND = 36
TEXTURE = (2048, 1024)
WHITE, RED, GLASS = (0.80, 0.80, 0.78), (0.55, 0.02, 0.02), (0.012, 0.014, 0.016)

# Along the fuselage: z, height of the middle line, half height above and below it, half width, m.
STATIONS = np.array(
    [
        (2.35, -0.16, 0.002, 0.002, 0.002),
        (2.32, -0.16, 0.045, 0.040, 0.045),
        (2.25, -0.155, 0.095, 0.085, 0.092),
        (2.10, -0.145, 0.165, 0.150, 0.155),
        (1.85, -0.125, 0.255, 0.225, 0.225),
        (1.50, -0.10, 0.355, 0.300, 0.285),
        (1.10, -0.08, 0.430, 0.355, 0.315),
        (0.70, -0.06, 0.445, 0.380, 0.320),
        (0.30, -0.04, 0.405, 0.375, 0.308),
        (-0.10, -0.01, 0.350, 0.340, 0.280),
        (-0.55, 0.03, 0.275, 0.275, 0.232),
        (-1.00, 0.07, 0.205, 0.205, 0.180),
        (-1.50, 0.10, 0.158, 0.158, 0.142),
        (-2.30, 0.125, 0.125, 0.125, 0.113),
        (-3.20, 0.145, 0.100, 0.100, 0.088),
        (-4.00, 0.16, 0.085, 0.085, 0.070),
        (-4.25, 0.165, 0.070, 0.070, 0.050),
        (-4.35, 0.165, 0.010, 0.010, 0.006),
    ]
)


def smooth_stations(count: int) -> np.ndarray:
    """The stations at `count` places, by a monotone cubic, denser where the nose bends."""
    s = steps(count)
    along = NOSE + (TAIL - NOSE) * (0.35 * s + 0.65 * s * s)
    return np.stack([along, *(hermite(-STATIONS[:, 0], column, -along) for column in STATIONS.T[1:])], 1)


def hermite(x: np.ndarray, y: np.ndarray, at: np.ndarray) -> np.ndarray:
    """A smooth curve through points: Fritsch and Butland's tangents."""
    h, d = np.diff(x), np.diff(y) / np.diff(x)
    inner = np.where(
        d[:-1] * d[1:] > 0, 2.0 * d[:-1] * d[1:] / np.where(d[:-1] + d[1:] == 0, 1, d[:-1] + d[1:]), 0.0
    )
    m = np.concatenate([[d[0]], inner, [d[-1]]])
    i = np.clip(np.searchsorted(x, at) - 1, 0, len(h) - 1)
    t = (at - x[i]) / h[i]
    return (
        y[i] * (1 + 2 * t) * (1 - t) ** 2
        + y[i + 1] * t * t * (3 - 2 * t)
        + h[i] * t * (1 - t) * (m[i] * (1 - t) - m[i + 1] * t)
    )


def fuselage() -> Surface:
    """Nose to tail: the lower half rounder than the upper one."""
    rows = smooth_stations(52)
    angle = np.pi * 2.0 * steps(AROUND + 1)  # from the keel over the left side to the top and round
    x, y = np.sin(angle), -np.cos(angle)
    power = np.where(y > 0, 0.92, 0.84)  # a touch squarer than an ellipse
    shape_x, shape_y = np.sign(x) * np.abs(x) ** power, np.sign(y) * np.abs(y) ** power
    points = np.empty((len(rows), AROUND + 1, 3))
    points[..., 0] = rows[:, 4:5] * shape_x
    half = np.where(shape_y > 0, rows[:, 2:3], rows[:, 3:4])
    points[..., 1] = rows[:, 1:2] + half * shape_y
    points[..., 2] = rows[:, :1]
    u = (NOSE - rows[:, :1]) / (NOSE - TAIL) + np.zeros(AROUND + 1)
    uv = np.stack([u, 0.5 * steps(AROUND + 1) + np.zeros((len(rows), 1))], 2)
    return grid(points[:, ::-1], uv[:, ::-1], weld=True)


def airfoil(count: int, thickness: float, camber: float) -> np.ndarray:
    """A section from the trailing edge over the top to the nose and back below: (2 count − 1, 2), chord 1."""
    x = 0.5 + 0.5 * np.cos(np.pi * steps(count))  # dense at both ends
    half = 5 * thickness * (0.2969 * np.sqrt(x) - 0.126 * x - 0.3516 * x**2 + 0.2843 * x**3 - 0.1036 * x**4)
    mean = camber * 4.0 * x * (1.0 - x) * (1.2 - 0.4 * x)
    top, bottom = np.stack([x, mean + half], 1), np.stack([x, mean - half], 1)
    return np.concatenate([top, bottom[-2::-1]])


def wing_like(
    line: np.ndarray, chord: np.ndarray, lean: np.ndarray, thickness: np.ndarray, camber: float, box: tuple
) -> Surface:
    """A wing along a line of quarter-chord points (n, 3), tipped by `lean` (radians about z, 0 = flat).

    `box` is the part of the texture it takes: u0, v0, u1, v1; its v runs from the trailing edge over the top
    and back below.
    """
    count = 15
    sections = np.stack([airfoil(count, t, camber) for t in thickness])
    points = np.empty((len(line), 2 * count - 1, 3))
    back = (0.25 - sections[..., 0]) * chord[:, None]
    rise = sections[..., 1] * chord[:, None]
    points[..., 0] = line[:, :1] - np.sin(lean)[:, None] * rise
    points[..., 1] = line[:, 1:2] + np.cos(lean)[:, None] * rise
    points[..., 2] = line[:, 2:3] + back
    length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
    u0, v0, u1, v1 = box
    u = u0 + (u1 - u0) * (length / length[-1])[:, None] + np.zeros(2 * count - 1)
    x = sections[0, :, 0]
    top = np.arange(2 * count - 1) < count
    v = v0 + (v1 - v0) * np.where(top, 0.5 - 0.5 * x, 0.5 + 0.5 * x)
    body = grid(points, np.stack([u, v + np.zeros_like(u)], 2))
    tip = points[-1]
    cap_uv = np.stack([u[-1], v], 1)
    lower = tip[::-1][:count]
    cap = grid(np.stack([tip[:count], lower]), np.stack([cap_uv[:count], cap_uv[:count]]))
    return join([body, cap])


def wing() -> Surface:
    """The left wing: straight dihedral, then up into the winglet."""
    s = np.concatenate([steps(16, 0.0, 0.955), steps(13, 0.960, 1.0)])
    lean = (
        np.radians(2.6) + np.radians(1.4) * s**2 + np.radians(66.0) * np.clip((s - 0.958) / 0.03, 0, 1) ** 1.5
    )
    run = 7.85 * np.diff(s, prepend=0.0)
    x, y = 0.05 + np.cumsum(run * np.cos(lean)), 0.20 + np.cumsum(run * np.sin(lean))
    chord = np.interp(s, [0, 0.12, 0.55, 0.85, 0.955, 0.975, 1.0], [0.92, 0.86, 0.74, 0.50, 0.34, 0.25, 0.11])
    z = -0.02 - 0.05 * s - 0.55 * np.clip(s - 0.93, 0, 1) / 0.07 * np.clip(s - 0.93, 0, 1) / 0.07
    thickness = np.interp(s, [0, 0.5, 0.95, 1.0], [0.155, 0.145, 0.12, 0.10])
    return wing_like(np.stack([x, y, z], 1), chord, lean, thickness, 0.028, (0.0, 0.5, 1.0, 0.80))


def tail() -> list[Surface]:
    """Fin and the two halves of the stabiliser on top of it."""
    s = steps(9)
    line = np.stack([0.0 * s, 0.17 + 1.32 * s, -3.62 - 0.28 * s], 1)
    fin = wing_like(
        line, 0.98 - 0.38 * s, np.full(9, np.pi / 2), np.full(9, 0.115), 0.0, (0.0, 0.80, 0.4, 1.0)
    )
    t = np.concatenate([steps(8, 0.0, 0.9), [0.95, 0.98, 1.0]])
    line = np.stack([1.28 * t, 1.49 + 0.0 * t, -3.86 - 0.06 * t**2], 1)
    chord = np.interp(t, [0, 0.9, 0.95, 0.98, 1.0], [0.56, 0.36, 0.33, 0.28, 0.18])
    half = wing_like(line, chord, np.zeros(len(t)), np.full(len(t), 0.11), 0.0, (0.42, 0.80, 0.80, 1.0))
    return [fin, half, half.mirrored()]


def wheel() -> Surface:
    """The main wheel, half in the belly."""
    profile = np.array([(0.03, 0.0), (0.04, 0.06), (0.06, 0.10), (0.06, 0.14), (0.045, 0.165), (0.0, 0.175)])
    profile = np.concatenate([profile * (-1, 1), profile[-2::-1]])
    angle = 2 * np.pi * steps(25)[:, None]
    points = np.stack(
        [
            profile[:, 0] + 0.0 * angle,
            -0.445 + profile[:, 1] * np.sin(angle),
            0.12 + profile[:, 1] * np.cos(angle),
        ],
        2,
    )
    uv = np.full((*points.shape[:2], 2), (0.95, 0.95))
    return grid(points, uv, weld=True)


def paint() -> tuple[np.ndarray, np.ndarray]:
    """Colour (sRGB) and surface (occlusion, roughness, metal), each (height, width, 3) uint8."""
    from PIL import Image, ImageDraw, ImageFont

    width, height = TEXTURE
    u, v = np.meshgrid((np.arange(width) + 0.5) / width, (np.arange(height) + 0.5) / height)
    color = np.empty((height, width, 3)) + WHITE
    rough = np.full((height, width), 0.16)
    z = NOSE - (NOSE - TAIL) * u
    side = np.abs(1.0 - 4.0 * v)  # 0 on top (v = 0.25), 1 at the keel; v < 0.5 only
    body = v < 0.5

    def lay(mask: np.ndarray, paint: tuple[float, ...], roughness: float) -> None:
        cover = np.clip(mask, 0.0, 1.0)[..., None]
        color[:] = color * (1 - cover) + np.array(paint) * cover
        rough[:] = rough * (1 - cover[..., 0]) + roughness * cover[..., 0]

    def edge(distance: np.ndarray, soft: float) -> np.ndarray:
        return np.where(body, 0.5 + distance / soft, 0.0)

    # the stripe sweeps along the side from the nose and thins out towards the tail
    centre = 0.555 + 0.02 * np.sin(2.2 * (z - 0.4)) + 0.02 * (z < 0) * z * 0.3
    wide = np.interp(z, [-3.9, -1.0, 1.2, 2.35], [0.012, 0.035, 0.05, 0.10])
    lay(edge(wide - np.abs(side - centre), 0.008), RED, 0.16)
    lay(edge(0.009 - np.abs(side - centre - wide - 0.03), 0.008), RED, 0.16)
    # the canopy: from nose to the wing, deepest in the middle, its frame a dark line
    front, rear = 1.98, 0.22
    t = np.clip((z - rear) / (front - rear), 0.0, 1.0)
    sill = 0.47 * np.sqrt(np.maximum(1.0 - (2.0 * np.clip(t, 0.0, 1.0) - 1.0) ** 4, 0.0)) - 0.02
    inside = np.where((z > rear) & (z < front), sill - side, -1.0)
    lay(edge(inside, 0.010), (0.35, 0.35, 0.34), 0.3)
    lay(edge(inside - 0.018, 0.010), GLASS, 0.03)
    frame = np.minimum(np.abs(z - 1.02) - 0.014, inside)
    lay(np.where(body & (inside > 0.018), 0.5 - frame / 0.010, 0.0), (0.10, 0.10, 0.10), 0.4)
    # wings: gaps of aileron and air brake, red tips
    w = (v - 0.5) / 0.30
    wings = (v >= 0.5) & (v < 0.80)
    chordwise = np.abs(2.0 * w - 1.0)  # 1 at the trailing edge, 0 at the nose
    gap = (np.abs(chordwise - 0.78) < 0.010) & (u > 0.06) & (u < 0.93)
    for at in (0.06, 0.52, 0.93):
        gap |= (np.abs(u - at) < 0.0007) & (chordwise > 0.78)
    lay(np.where(wings & gap, 0.75, 0.0), (0.12, 0.12, 0.12), 0.5)
    brake = (np.abs(chordwise - 0.48) < 0.03) & (u > 0.33) & (u < 0.50) & (w < 0.5)
    rim = brake & (
        (np.abs(np.abs(chordwise - 0.48) - 0.027) < 0.004) | (np.abs(np.abs(u - 0.415) - 0.0845) < 0.0007)
    )
    lay(np.where(wings & rim, 0.75, 0.0), (0.12, 0.12, 0.12), 0.5)
    lay(np.where(wings & (u > 0.955), 1.0, 0.0), RED, 0.16)
    lay(np.where(wings & (np.abs(u - 0.945) < 0.003), 1.0, 0.0), RED, 0.16)
    # rudder: a red band; elevator: its gap
    tail_v = (v - 0.80) / 0.20
    fin, stabiliser = (v >= 0.80) & (u < 0.41), (v >= 0.80) & (u >= 0.41) & (u < 0.81)
    back = np.abs(2.0 * tail_v - 1.0)
    lay(np.where(fin & (np.abs(u - 0.25) < 0.055), 1.0, 0.0), RED, 0.16)
    lay(np.where((fin | stabiliser) & (np.abs(back - 0.68) < 0.012), 0.75, 0.0), (0.12, 0.12, 0.12), 0.5)
    lay(np.where((v > 0.90) & (u > 0.9), 1.0, 0.0), (0.02, 0.02, 0.02), 0.85)
    # the registration, under the left wing alone
    sheet = Image.new("L", TEXTURE, 0)
    big = ImageFont.load_default(74)
    ImageDraw.Draw(sheet).text((int(0.42 * width), int(0.745 * height)), "FS-15", 255, big, anchor="mm")
    lay(np.asarray(sheet) / 255.0, (0.03, 0.03, 0.035), 0.2)
    srgb = np.where(color <= 0.0031308, 12.92 * color, 1.055 * color ** (1 / 2.4) - 0.055)
    surface = np.stack([np.ones_like(rough), rough, np.zeros_like(rough)], 2)
    return tuple(np.round(255 * np.clip(a, 0, 1)).astype(np.uint8) for a in (srgb, surface))


def build() -> Glb:
    """The whole glider."""
    glb = Glb("glider")
    color, surface = (glb.texture(picture) for picture in paint())
    pbr = {"baseColorTexture": {"index": color}, "metallicRoughnessTexture": {"index": surface}}
    material = glb.material(name="gelcoat", pbrMetallicRoughness=pbr)
    left = wing()
    right = left.mirrored()
    right.uv = right.uv.copy()
    right.uv[:, 1] = 0.65 - np.abs(right.uv[:, 1] - 0.65)  # its lower side has the paint of the upper one
    glb.add(join([fuselage(), left, right, *tail(), wheel()]), material)
    return glb
