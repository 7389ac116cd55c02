"""The frame's arithmetic on the CPU in float64: the twin that the shaders are tested against.

Light meets surfaces (`ggx_specular`, `eon_diffuse`), a film meets light (`exposure_key`, `agx`, `neutral`,
`srgb_encode`, `white_balance`, `night_vision`), and a picture meets 8 bits (`triangular_noise`). Each has its
source. Arrays are numpy float64, colours have a last axis of 3 in linear Rec. 709, vectors are unit length.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
"""Luminance of linear Rec. 709."""


def encode_normal(normal: ArrayLike) -> Array:
    """Octahedral 10-bit codes (0..1022, as floats) of unit vectors; shape (..., 3) to (..., 2).

    0 is a code of its own, so the axes come back exactly. Meyer et al. 2010; Cigolle et al. 2014.
    """
    n = np.asarray(normal, float)
    n = n / np.abs(n).sum(-1, keepdims=True)
    side = np.where(n[..., :2] >= 0, 1.0, -1.0)
    folded = np.where(n[..., 2:] >= 0, n[..., :2], (1 - np.abs(n[..., 1::-1])) * side)
    return np.round(folded * 511) + 511


def decode_normal(code: ArrayLike) -> Array:
    """Unit vectors of octahedral codes 0..1022; shape (..., 2) to (..., 3)."""
    p = (np.asarray(code, float) - 511) / 511
    z = 1 - np.abs(p).sum(-1)
    side = np.where(p >= 0, 1.0, -1.0)
    p = p - side * np.maximum(-z, 0)[..., None]
    n = np.concatenate([p, z[..., None]], -1)
    return n / np.linalg.norm(n, axis=-1, keepdims=True)


# ---- light on surfaces ------------------------------------------------------------------------------------


def smith_lambda(cosine: ArrayLike, alpha: float) -> Array:
    """Smith's auxiliary function of GGX (Heitz 2014, eq. 72)."""
    c2 = np.maximum(np.square(np.asarray(cosine, float)), 1e-12)
    return (np.sqrt(1 + alpha**2 * (1 / c2 - 1)) - 1) / 2


def ggx_specular(
    n_l: ArrayLike, n_v: ArrayLike, n_h: ArrayLike, v_h: ArrayLike, alpha: float, f0: float
) -> Array:
    """GGX microfacet reflection in 1/sr: height-correlated Smith masking, Schlick's Fresnel.

    Walter et al. 2007; Heitz 2014 (masking); Schlick 1994. `alpha` = perceptual roughness squared. Below
    0.02, `f0` stands for hollows that swallow light, at grazing angles too (Lagarde, de Rousiers 2014: 50
    f0 there).
    """
    n_l, n_v, n_h, v_h = (np.asarray(x, float) for x in (n_l, n_v, n_h, v_h))
    d = alpha**2 / (np.pi * (n_h**2 * (alpha**2 - 1) + 1) ** 2)
    g = 1 / (1 + smith_lambda(n_l, alpha) + smith_lambda(n_v, alpha))
    f = f0 + (min(50 * f0, 1) - f0) * (1 - v_h) ** 5
    return d * g * f / (4 * n_l * n_v)


def ggx_albedo(n_v: float, roughness: float, samples: int = 64) -> tuple[float, float]:
    """Directional albedo of GGX as scale and bias on F0: E = f0 * scale + bias (Karis 2013).

    By stratified sampling of visible normals (Heitz 2018) with `samples` squared points.
    """
    alpha = max(roughness**2, 1e-3)
    strata = (np.arange(samples) + 0.5) / samples
    u, w = np.meshgrid(strata, strata)
    view = np.array([np.sqrt(1 - n_v**2), 0.0, n_v])
    stretched = view * [alpha, alpha, 1]
    stretched /= np.linalg.norm(stretched)
    t1 = np.array([0.0, 1.0, 0.0])
    t2 = np.cross(stretched, t1)
    x, y = np.sqrt(u) * np.cos(2 * np.pi * w), np.sqrt(u) * np.sin(2 * np.pi * w)
    s = (1 + stretched[2]) / 2
    y = (1 - s) * np.sqrt(1 - x**2) + s * y
    h = x[..., None] * t1 + y[..., None] * t2
    h = h + np.sqrt(np.maximum(1 - x**2 - y**2, 0))[..., None] * stretched
    h = h * [alpha, alpha, 1]
    h /= np.linalg.norm(h, axis=-1, keepdims=True)
    v_h = h @ view
    n_l = 2 * v_h * h[..., 2] - n_v
    lambda_v = smith_lambda(n_v, alpha)
    weight = np.where(
        n_l > 0, (1 + lambda_v) / (1 + lambda_v + smith_lambda(np.maximum(n_l, 1e-6), alpha)), 0
    )
    fresnel = (1 - np.clip(v_h, 0, 1)) ** 5
    return float((weight * (1 - fresnel)).mean()), float((weight * fresnel).mean())


def eon_diffuse(albedo: ArrayLike, roughness: float, n_l: ArrayLike, n_v: ArrayLike, l_v: ArrayLike) -> Array:
    """Energy-preserving Oren-Nayar reflection in 1/sr.

    Portsmouth, Kutz, Hill 2025, "EON: A Practical Energy-Preserving Rough Diffuse BRDF" (JCGT 14.1): Fujii's
    improved Oren-Nayar plus the light that it loses between the facets, so that a white surface stays white.
    """
    rho = np.asarray(albedo, float)
    n_l, n_v, l_v = (np.asarray(x, float) for x in (n_l, n_v, l_v))
    c1, c2 = 0.5 - 2 / (3 * np.pi), 2 / 3 - 28 / (15 * np.pi)
    s = l_v - n_l * n_v
    s_over_t = np.where(s > 0, s / np.maximum(np.maximum(n_l, n_v), 1e-7), s)
    a = 1 / (1 + c1 * roughness)
    single = rho / np.pi * a * (1 + roughness * s_over_t)
    mean = a * (1 + c2 * roughness)
    tint = rho**2 * mean / (1 - rho * (1 - mean))
    lost_l, lost_v = 1 - eon_albedo(n_l, roughness), 1 - eon_albedo(n_v, roughness)
    return single + tint / np.pi * lost_l * lost_v / max(1 - mean, 1e-7)


def eon_albedo(cosine: ArrayLike, roughness: float) -> Array:
    """Directional albedo of the single-scattering part, the paper's polynomial fit."""
    m = 1 - np.asarray(cosine, float)
    g = m * (0.0571085289 + m * (0.491881867 + m * (-0.332181442 + m * 0.0714429953)))
    return (1 + roughness * g) / (1 + (0.5 - 2 / (3 * np.pi)) * roughness)


# ---- exposure ---------------------------------------------------------------------------------------------

SUN_ILLUMINANCE = (
    (-90, -3.7), (-18, -3.19), (-15, -2.9), (-12, -2.08), (-9, -0.85), (-6, 0.53), (-3, 1.9),
    (-0.8, 2.66), (0, 2.87), (5, 3.68), (10, 4.04), (20, 4.44), (30, 4.67), (40, 4.82), (60, 5.01), (90, 5.1),
)  # fmt: skip
"""Sun's elevation in degrees, log10 of lux on level ground under a clear sky; a first guess, no more."""


def scale_from_ev100(ev100: ArrayLike) -> Array:
    """Picture value per cd/m²: 1 is what saturates a sensor at ISO 100 (ISO 12232; Lagarde, de Rousiers
    2014).
    """
    return 1 / (1.2 * np.exp2(np.asarray(ev100, float)))


def ev100_from_scale(scale: ArrayLike) -> Array:
    """The inverse of `scale_from_ev100`."""
    return -np.log2(1.2 * np.asarray(scale, float))


def exposure_key(luminance: ArrayLike) -> Array:
    """What the metered luminance (cd/m²) is exposed to: 0.18 at 4000 cd/m², less in the dark, so that night
    is night.

    The square root of the key of Krawczyk, Myszkowski, Seidel 2005, "Perceptual Effects in Real-time Tone
    Mapping": 1.03 - 2 / (2 + log10(L + 1)). Their key serves an operator that lifts shadows; AgX does not,
    and the whole of it would sink a moonless night to 5 stops under grey where photographers print it 2 to
    3 stops under.
    """

    def key(x: Array) -> Array:
        return 1.03 - 2 / (2 + np.log10(x + 1))

    return 0.18 * np.sqrt(key(np.asarray(luminance, float)) / key(np.asarray(4000.0)))


def auto_scale(luminance: ArrayLike, compensation: float = 0.0) -> Array:
    """Picture value per cd/m² for a metered luminance; `compensation` in stops."""
    luminance = np.maximum(np.asarray(luminance, float), 1e-6)
    return exposure_key(luminance) / luminance * 2.0**compensation


def guess_luminance(sun_elevation: float) -> float:
    """Mean luminance of a clear day's picture in cd/m², from the sun's elevation in radians: for a first
    frame.
    """
    degrees, lux = zip(*SUN_ILLUMINANCE, strict=True)
    # a grey world: 20 % of the light comes back, the sky itself is about as bright
    return float(10 ** np.interp(np.degrees(sun_elevation), degrees, lux) * 0.2 / np.pi)


# ---- tone ------------------------------------------------------------------------------------------------

AGX_INSET = np.array(
    [
        [0.842479062253094, 0.0784335999999992, 0.0792237451477643],
        [0.0423282422610123, 0.878468636469772, 0.0791661274605434],
        [0.0423756549057051, 0.0784336000000000, 0.879142973793104],
    ]
)
"""Pulls the primaries towards white so that bright colours go to white by themselves (Sobotka, AgX 2022)."""
AGX_INSET /= AGX_INSET.sum(1, keepdims=True)  # the published rows miss 1 by 1e-4; greys shall stay grey

AGX_STOPS_BELOW, AGX_STOPS_ABOVE = 10.0, 6.5
"""Stops under and over middle grey (0.18) that the film holds."""


def agx_curve(x: ArrayLike) -> Array:
    """AgX's sigmoid on log exposure 0..1: slope 2 through (0.606, 0.5), toe power 3, shoulder power 3.25."""
    x = np.asarray(x, float)
    pivot = AGX_STOPS_BELOW / (AGX_STOPS_BELOW + AGX_STOPS_ABOVE)
    d = x - pivot

    def limb(reach: float, power: float) -> Array:
        # y = 1/2 + 2 d (1 + a |d|^p)^(-1/p), with a such that the limb ends at 0 or 1
        a = ((4 * reach) ** power - 1) / reach**power
        return 0.5 + 2 * d * (1 + a * np.abs(d) ** power) ** (-1 / power)

    return np.where(d < 0, limb(pivot, 3.0), limb(1 - pivot, 3.25))


AGX_LOOKS = {"base": (1.0, 1.0), "medium": (1.15, 1.2), "punchy": (1.35, 1.4)}
"""Power and saturation applied to AgX's signal; base and punchy are Sobotka's, medium keeps middle grey
at 0.18.
"""


def agx(colour: ArrayLike, look: str = "base") -> Array:
    """Scene-linear colour (0.18 = middle grey) to display-linear 0..1: Troy Sobotka's AgX."""
    power, saturation = AGX_LOOKS[look]
    inset = np.maximum(np.asarray(colour, float), 0) @ AGX_INSET.T
    stops = np.log2(np.maximum(inset, 1e-10) / 0.18)
    x = np.clip((stops + AGX_STOPS_BELOW) / (AGX_STOPS_BELOW + AGX_STOPS_ABOVE), 0, 1)
    # the curve's result is a display signal of gamma 2.2; look and outset act in that signal, as AgX does
    signal = agx_curve(x) ** power
    grey = (signal @ LUMINANCE)[..., None]
    signal = np.clip((grey + saturation * (signal - grey)) @ np.linalg.inv(AGX_INSET).T, 0, 1)
    return signal**2.2


def neutral(colour: ArrayLike) -> Array:
    """Khronos PBR Neutral (specification of 2024): colours under 0.76 keep hue and saturation, highlights
    roll off.
    """
    c = np.maximum(np.asarray(colour, float), 0)
    start, desaturation = 0.8 - 0.04, 0.15
    low = c.min(-1, keepdims=True)
    c = c - np.where(low < 0.08, low - 6.25 * low**2, 0.04)
    peak = c.max(-1, keepdims=True)
    d = 1 - start
    new = 1 - d**2 / (np.maximum(peak, start) + d - start)
    g = 1 - 1 / (desaturation * (peak - new) + 1)
    rolled = c * new / np.maximum(peak, 1e-9)
    return np.where(peak < start, c, rolled + (new - rolled) * g)


def srgb_encode(linear: ArrayLike) -> Array:
    """IEC 61966-2-1: display-linear 0..1 to the sRGB signal."""
    x = np.asarray(linear, float)
    return np.where(x <= 0.0031308, 12.92 * x, 1.055 * np.maximum(x, 0.0031308) ** (1 / 2.4) - 0.055)


BRADFORD = np.array([[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]])
"""From XYZ to the cones in which eyes adapt (Lam 1985)."""


def white_balance(kelvin: float) -> Array:
    """Matrix (3, 3) by which daylight of `kelvin`, 4000 to 25000, becomes white (1, 1, 1) of its luminance.

    Chromaticity of daylight: CIE 015, equations 3.3 and 3.4; adaptation by Bradford's cones. Nothing changes
    at 6504 K.
    """
    k = 1e3 / kelvin
    cold = (0.237040, 0.24748, 1.9018, -2.0064)
    a, b, c, d = (0.244063, 0.09911, 2.9678, -4.6070) if kelvin <= 7000 else cold
    x = a + b * k + c * k**2 + d * k**3
    y = -3.0 * x**2 + 2.870 * x - 0.275
    light = BRADFORD @ (x / y, 1.0, (1 - x - y) / y)
    white = BRADFORD @ RGB_TO_XYZ.sum(1)
    adapt = np.linalg.inv(BRADFORD) @ np.diag(white / light) @ BRADFORD
    return np.linalg.inv(RGB_TO_XYZ) @ adapt @ RGB_TO_XYZ


TONE_MAPS = {"agx": agx, "neutral": neutral, "none": lambda c: np.clip(c, 0, 1)}


def night_vision(colour: ArrayLike) -> Array:
    """What an eye sees of a luminance in cd/m² (linear Rec. 709): in the dark less colour, and blue for red.

    Rod response of Larson, Rushmeier, Piatko 1997, V = Y (1.33 (1 + (Y + Z) / X) - 1.68), scaled so that
    white keeps its luminance; the blend from 10^-2 to 10^0.6 cd/m² and the bluish white (0.25, 0.25) are of
    Jensen et al. 2000, "Night Rendering". Rods take over 70 % at most, for pictures are made for lit rooms.
    """
    rgb = np.asarray(colour, float)
    x, y, z = np.moveaxis(np.maximum(rgb, 0) @ RGB_TO_XYZ.T, -1, 0)
    rods = y * np.clip(1.33 * (1 + (y + z) / np.maximum(x, 1e-12)) - 1.68, 0, 5) / 2.573
    t = np.clip((np.log10(np.maximum(y, 1e-12)) + 2) / 2.6, 0, 1)
    share = 0.7 * (1 - t * t * (3 - 2 * t))
    return rgb + (rods[..., None] * NIGHT_WHITE - rgb) * share[..., None]


RGB_TO_XYZ = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])
NIGHT_WHITE = np.array([0.7062, 0.9901, 1.9660])
"""Linear Rec. 709 of chromaticity (0.25, 0.25) at luminance 1, less what the gamut lacks."""


# ---- 8 bits, and time ------------------------------------------------------------------------------------


def triangular_noise(x: ArrayLike, y: ArrayLike, frame: int = 0) -> Array:
    """Noise in -1..1 with triangular density at pixel (x, y): Jimenez's interleaved gradient noise, reshaped.

    Triangular noise makes the mean and the variance of the rounded value independent of the value (Lipshitz,
    Wannamaker, Vanderkooy 1992); this pattern leaves little power in low frequencies.
    """
    x, y = (np.asarray(v, float) + 5.588238 * (frame % 64) for v in (x, y))
    u = np.mod(52.9829189 * np.mod(0.06711056 * x + 0.00583715 * y, 1), 1) * 2 - 1
    return np.sign(u) * (1 - np.sqrt(1 - np.abs(u)))


def halton(index: int, base: int) -> float:
    """Radical inverse of `index` >= 1 in `base`."""
    result, fraction = 0.0, 1.0
    while index > 0:
        fraction /= base
        index, digit = divmod(index, base)
        result += digit * fraction
    return result
