"""Three wavelengths against nineteen, few samples against many, the lux of dusk: the float64 model alone."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np

from fallstreak.sky import model, spectrum, tables
from fallstreak.sky.air import Air
from fallstreak.world import World

MANY = np.arange(380.0, 741.0, 20.0)
FEW = {
    "680, 550, 440 nm": spectrum.GIVEN,
    "600, 545, 455 nm": np.array([600.0, 545.0, 455.0]),
    "625, 540, 448 nm": spectrum.BANDS,
}
SUNS = (60.0, 30.0, 10.0, 2.0, 0.0, -3.0, -6.0, -9.0)
DUSK, USNO = (-0.8, -3.0, -6.0, -9.0, -12.0), (460, 56, 3.4, 0.15, 0.008)
EYE, ORBIT = 1.7, 400e3


def run(report):
    chunks = np.array_split(np.concatenate([MANY, *FEW.values()]), 7)
    with ThreadPoolExecutor() as pool:  # numpy lets others run, and wavelengths know nothing of each other
        dusks = [pool.submit(_dusk, top) for top in (100e3, 60e3)]
        skies, discs = (np.concatenate(part, -1) for part in zip(*pool.map(_skies, chunks), strict=True))
    _wavelengths(report, skies, discs)
    _lux(report, *(dusk.result() for dusk in dusks))
    _samples(report)


def _skies(wavelengths):
    """Spectral radiance over irradiance of 15 directions for every sun; transmittance of the sun at 2°."""
    air = _air(wavelengths)
    multiple = _multiple(air)
    mu = np.sin(np.radians([2.0, 10.0, 30.0, 60.0, 85.0]))[:, None]
    sun, cos_azimuth = np.sin(np.radians(SUNS))[:, None, None], np.array([1.0, 0.0, -1.0])
    nu = mu * sun + np.sqrt((1 - mu**2) * (1 - sun**2)) * cos_azimuth
    skies = [
        model.radiance(air, EYE, mu, s, n, steps=80, multiple=multiple)[0]
        for s, n in zip(sun, nu, strict=True)
    ]
    return np.array(skies), model.transmittance(air, EYE, np.sin(np.radians(2.0)))


def _wavelengths(report, skies, discs):
    """Rec. 709 of three wavelengths, each times its factor, beside that of `MANY`."""
    count, rows = len(MANY), []
    sky, disc = _rec709(skies[..., :count]), _rec709(discs[:count])
    for index, (name, bands) in enumerate(FEW.items()):
        part = slice(count + 3 * index, count + 3 * index + 3)
        sunlight = spectrum.solar_irradiance(bands) * spectrum.luminance_factors(0.0, bands)
        skylight = spectrum.solar_irradiance(bands) * spectrum.luminance_factors(-3.0, bands)
        off = (skies[..., part] * skylight - sky) / (sky @ spectrum.LUMINANCE)[..., None]
        off_disc = (discs[part] * sunlight - disc) / (disc @ spectrum.LUMINANCE)
        error = np.sqrt(np.mean(off**2))
        rows.append((name, f"{error:.2f}", ", ".join(f"{v:+.2f}" for v in off_disc)))
        how = f"{len(MANY)} wavelengths, {off[..., 0].size} directions, sun from 60° to -9°, rms of channels"
        report.add(f"spectrum: error of {name} over luminance", error, "", how=how)
    report.table(
        "three wavelengths", ("wavelengths", "rms over all skies", "sun's disc at 2°: r, g, b"), rows
    )


def _dusk(top):
    """Lux on level ground by the sky for every sun of `DUSK`, with air up to `top`."""
    air = replace(_air(spectrum.BANDS), top_height=top)
    multiple = _multiple(air, rows=32)
    nodes, weights = np.polynomial.legendre.leggauss(10)
    up, weights = 0.5 + 0.5 * nodes[:, None], 0.5 * weights[:, None, None]
    cos_azimuth = np.cos(np.pi * (np.arange(8) + 0.5) / 8)
    found = []
    for elevation in np.radians(DUSK):
        nu = up * np.sin(elevation) + np.sqrt(1 - up**2) * np.cos(elevation) * cos_azimuth
        light = model.radiance(air, EYE, up, np.sin(elevation), nu, steps=60, multiple=multiple)[0]
        found.append(2 * np.pi * np.sum(light * up[..., None] * weights, (0, 1)) / 8)
    factors = spectrum.solar_irradiance(spectrum.BANDS) * spectrum.luminance_factors(-3.0)
    return np.array(found) @ (factors * spectrum.LUMINANCE)


def _lux(report, lux, low):
    rows = [
        (f"{elevation:g}°", f"{ours:.2g}", theirs, f"{share:.2f}")
        for elevation, ours, theirs, share in zip(DUSK, lux, USNO, low / lux, strict=True)
    ]
    columns = ("sun", "the model, lux", "USNO Circular 171, lux", "with 60 km of air, times")
    report.table("dusk on level ground", columns, rows)
    for elevation, ours in zip(DUSK, lux, strict=True):
        how = "float64 model at 625, 540 and 448 nm, 80 directions, default air"
        report.add(f"spectrum: level ground, sun at {elevation:g}°", ours, "lx", how=how)


def _samples(report):
    """Samples along a ray of the view table against 300 of them."""
    air = _air(spectrum.BANDS)
    multiple = _multiple(air)
    horizon = np.degrees(np.arcsin(model.cos_horizon(air, ORBIT)))
    for name, height, steps, low, high, suns in (
        ("the ground", EYE, 15, -20.0, 90.0, (60.0, 30.0, 10.0, 3.0)),
        ("the ground in twilight", EYE, 20, -20.0, 90.0, (0.0, -2.0, -4.0)),
        ("400 km", ORBIT, 30, horizon - 20.0, horizon + 1.5, (60.0, 30.0, 10.0, 0.0)),
    ):
        mu = np.sin(np.radians(np.linspace(low, high, 60)))
        sun, azimuth = np.sin(np.radians(suns))[:, None, None], np.array([[1.0], [-1.0]])
        nu = mu * sun + np.sqrt((1 - mu**2) * (1 - sun**2)) * azimuth
        few, many = (
            model.radiance(air, height, mu, sun, nu, steps=n, multiple=multiple)[0] @ spectrum.LUMINANCE
            for n in (steps, 300)
        )
        off = 100 * np.abs(few / np.maximum(many, 1e-12) - 1)[many > 1e-12]
        how = (
            f"luminance against 300 samples, float64, {off.size} rays, sun from {suns[0]:g}° to {suns[-1]:g}°"
        )
        report.add(f"spectrum: {steps} samples from {name}, rms", np.sqrt(np.mean(off**2)), "%", how=how)
        report.add(f"spectrum: {steps} samples from {name}, worst", off.max(), "%", how=how)


def _air(wavelengths):
    """The default air with coefficients at any wavelengths (nm): Rayleigh, grey haze, ozone by shape."""
    wavelengths, sky, count = np.asarray(wavelengths, float), World().sky, len(wavelengths)
    gas = sky.rayleigh_scattering[1] * (spectrum.GIVEN[1] / wavelengths) ** 4
    return replace(
        Air.of(World()),
        rayleigh_scattering=tuple(gas),
        mie_scattering=(sky.mie_scattering[1],) * count,
        mie_extinction=(sky.mie_extinction[1],) * count,
        mie_forward=(sky.mie_g[1],) * count,
        mie_wide=(0.0,) * count,
        mie_forward_share=(1.0,) * count,
        ozone_absorption=tuple(spectrum.ozone_at_bands(sky.ozone_absorption, wavelengths)),
        ground_albedo=(0.3,) * count,
    )


def _multiple(air, rows=16):
    """All higher orders from a table of fourth roots, as the GPU holds them."""
    u, v = np.meshgrid(np.linspace(0.0, 1.0, 32), np.linspace(0.0, 1.0, rows))
    place = tables.place_from_multiscattering(air, u, v)
    table = model.multiple_scattering(air, *place, directions=32, steps=16)

    def look_up(altitude, mu_sun):
        return tables.bilinear(table**0.25, *tables.multiscattering_from_place(air, altitude, mu_sun)) ** 4

    return look_up


def _rec709(radiance):
    """Rec. 709 (cd/m², lux) of spectra over the sun's at `MANY`."""
    bar = spectrum.rec709_matching(MANY) * spectrum.solar_irradiance(MANY)
    return spectrum.MAX_LUMINOUS_EFFICACY * (MANY[1] - MANY[0]) * radiance @ bar.T
