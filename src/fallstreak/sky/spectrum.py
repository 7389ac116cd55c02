"""From wavelengths to what the eye sees: the sun's spectrum, Rec. 709 luminance, and where to compute.

Airs are *given* at 680, 550 and 440 nm (`GIVEN`), those of Bruneton 2017, and *computed* at 625, 540
and 448 nm (`BANDS`), which stand for red, green and blue: over clear and hazy skies with the sun from 60° to
-9° their radiances, each times one factor, come closest to the Rec. 709 luminance of a full spectral
computation (error of a channel over luminance: 0.07, rms of 120 directions). 680, 550 and 440 nm miss
the middle of the ozone's absorption at 600 nm; they leave 0.54 and turn every dusk purple. The same three
serve the setting sun, whose red at 680 nm would come out too strong. `fallstreak bench spectrum` prints it.

A sunlit spectrum S(λ) scattered by air goes as S(λ) (λ₀/λ)³ about each wavelength (between Rayleigh's fourth
power and aerosol's none), so that radiance at λ₀ becomes Rec. 709 luminance by a factor integrated once
(Bruneton 2017, "Luminance"). Light that was not scattered keeps the sun's spectrum, and has its own factor.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

GIVEN = np.array([680.0, 550.0, 440.0])
"""nm, at which worlds give their coefficients."""

BANDS = np.array([625.0, 540.0, 448.0])
"""nm, at which the sky is computed: they stand for red, green and blue."""

MAX_LUMINOUS_EFFICACY = 683.0
"""lm/W at 555 nm."""

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
"""Luminance of the Rec. 709 primaries."""

# Extraterrestrial solar irradiance, W m⁻² nm⁻¹, means over 10 nm about 360, 370 ... 830 nm, of the reference
# spectrum ASTM G173-03 (Gueymard 2004).
_GRID = np.arange(360.0, 831.0, 10.0)
_SOLAR = np.array([
    0.9767, 1.1505, 1.0870, 1.0590, 1.5041, 1.7069, 1.7399, 1.5636, 1.8264, 1.9906, 2.0412, 1.9994,
    2.0403, 1.8922, 1.9195, 1.9246, 1.8192, 1.8738, 1.8652, 1.8669, 1.8332, 1.8366, 1.8366, 1.7783,
    1.7669, 1.7285, 1.6856, 1.6586, 1.6299, 1.5828, 1.5147, 1.5315, 1.4913, 1.4624, 1.4228, 1.3933,
    1.3509, 1.3270, 1.2900, 1.2780, 1.2565, 1.2137, 1.1967, 1.1650, 1.1367, 1.1148, 1.0817, 1.0594,
])  # fmt: skip

# Absorption of ozone about 360, 370 ... 830 nm over that at 550 nm (Serdyuchenko et al. 2014, at 233 K).
_OZONE = np.array([
    0.003, 0.001, 0.001, 0.002, 0.004, 0.008, 0.016, 0.024, 0.045, 0.066, 0.105, 0.141,
    0.221, 0.258, 0.423, 0.458, 0.611, 0.787, 0.883, 1.000, 1.219, 1.335, 1.257, 1.343,
    1.434, 1.230, 1.069, 0.919, 0.761, 0.639, 0.529, 0.421, 0.345, 0.269, 0.213, 0.188,
    0.146, 0.119, 0.121, 0.092, 0.070, 0.080, 0.072, 0.046, 0.042, 0.059, 0.040, 0.020,
])  # fmt: skip

# IEC 61966-2-1: XYZ to linear Rec. 709.
_REC709_FROM_XYZ = np.array(
    [[3.2406, -1.5372, -0.4986], [-0.9689, 1.8758, 0.0415], [0.0557, -0.2040, 1.0570]]
)


def colour_matching(wavelength: np.ndarray) -> np.ndarray:
    """CIE 1931 x̄, ȳ, z̄ at wavelengths in nm, shape (3, n), fit by Wyman, Sloan and Shirley (JCGT 2013)."""

    def lobe(peak: float, left: float, right: float) -> np.ndarray:
        return np.exp(-0.5 * ((wavelength - peak) * np.where(wavelength < peak, left, right)) ** 2)

    x = (
        0.362 * lobe(442.0, 0.0624, 0.0374)
        + 1.056 * lobe(599.8, 0.0264, 0.0323)
        - 0.065 * lobe(501.1, 0.0490, 0.0382)
    )
    y = 0.821 * lobe(568.8, 0.0213, 0.0247) + 0.286 * lobe(530.9, 0.0613, 0.0322)
    z = 1.217 * lobe(437.0, 0.0845, 0.0278) + 0.681 * lobe(459.0, 0.0385, 0.0725)
    return np.stack([x, y, z])


def solar_irradiance(wavelength: np.ndarray) -> np.ndarray:
    """Spectral irradiance of the sun at 1 au above the air, W m⁻² nm⁻¹, at wavelengths in nm."""
    return np.interp(wavelength, _GRID, _SOLAR)


def at_bands(coefficients: Sequence[float]) -> np.ndarray:
    """Scattering or extinction at `BANDS` from that at `GIVEN`: lines of logarithms, exact for power laws."""
    values = np.asarray(coefficients, float)[::-1]
    if np.any(values <= 0.0):
        return np.interp(BANDS, GIVEN[::-1], values)
    return np.exp(np.interp(np.log(BANDS), np.log(GIVEN[::-1]), np.log(values)))


def ozone_at_bands(coefficients: Sequence[float], bands: np.ndarray = BANDS) -> np.ndarray:
    """Absorption at `bands` (nm) from that at `GIVEN`, by the shape of ozone's Chappuis band."""
    share = np.asarray(coefficients, float) / np.interp(GIVEN, _GRID, _OZONE)
    return np.interp(bands, GIVEN[::-1], share[::-1]) * np.interp(bands, _GRID, _OZONE)


def rec709_matching(wavelength: np.ndarray) -> np.ndarray:
    """Linear Rec. 709 red, green and blue of light at wavelengths in nm, shape (3, n)."""
    return _REC709_FROM_XYZ @ colour_matching(wavelength)


def luminance_factors(power: float, bands: np.ndarray = BANDS) -> np.ndarray:
    """Rec. 709 luminance (cd/m²) per spectral radiance (W m⁻² sr⁻¹ nm⁻¹) at three wavelengths.

    Parameters
    ----------
    power : float
        The spectrum is taken as the sun's times (λ / λ₀)^power: 0 for sunlight, -3 for skylight.
    bands : ndarray
        λ₀ for red, green and blue, nm.
    """
    grid = np.arange(360.0, 831.0, 1.0)
    shape = solar_irradiance(grid) / solar_irradiance(bands)[:, None]
    relative = shape * (grid / bands[:, None]) ** power
    return MAX_LUMINOUS_EFFICACY * np.sum(rec709_matching(grid) * relative, axis=1)


SUN_ILLUMINANCE = luminance_factors(0.0) * solar_irradiance(BANDS)
"""Rec. 709 illuminance of the sun at 1 au above the air, lux: luminance 133 klx.

The older figure of 128 klx (IES) stands for a weaker solar spectrum; the sun's magnitude gives 126 klx.
"""

SKY_RESPONSE = luminance_factors(-3.0) / luminance_factors(0.0)
"""Luminance of skylight over that of sunlight for the same three spectral radiances."""
