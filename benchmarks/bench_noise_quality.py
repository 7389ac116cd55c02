"""The quality of one octave of every kind: spectrum, directions, extrema, correlations, repetition."""

import numpy as np

from fallstreak import noise
from fallstreak.noise import quality

#: energy below .25 cycles/cell, axis, 110, 111, extrema on the lattice, from the project's reference values
PUBLISHED = {
    "improved": ("1.1 %", "1.13", "0.98", "0.95", "0 %"),
    "table": ("11.3 %", "0.48", "1.14", "1.66", "100 %"),
    "perlin": ("1.0 %", "1.09", "0.93", "0.93", "0 %"),
    "simplex": ("0.1 %", "1.02", "1.01", "1.01", "2 %"),
}
KINDS = ("improved", "table", "perlin", "simplex", "value", "cellular_f1", "cellular_f2", "cellular_f2f1")
SIZE, PER_CELL, VOLUMES = 256, 8, 3
LAGS = tuple(2**k for k in range(2, 13))


def run(report):
    rows = []
    for kind in KINDS:
        # the journal's and Perlin's tables: every seed sees another part of the one field there is
        found = quality.measure([_noise(kind, seed) for seed in range(VOLUMES)], SIZE, PER_CELL)
        seeds = quality.correlation_of_seeds([_noise(kind, seed) for seed in range(64)])
        lags = quality.correlation_at_lags(_noise(kind), LAGS)
        rows.append(_row(kind, found, seeds, lags))
        if kind in PUBLISHED:
            rows.append(("  reference", *PUBLISHED[kind], "", ""))
        _goals(report, kind, found, seeds, lags)
    report.table(
        f"one octave, {VOLUMES} volumes of {SIZE}³, {PER_CELL} a cell; |r| of 64 seeds, at lags 4…4096",
        ("kind", "< .25", "axis", "110", "111", "beads", "seeds", "lags"),
        rows,
    )
    report.note("< .25: energy below a quarter of a cycle per cell; beads: extrema on lattice points")


def _noise(kind, seed=0):
    return lambda points: noise.sample(points, kind, seed=seed)


def _row(kind, found, seeds, lags):
    return (
        kind,
        f"{100 * found.low_energy:.2f} %",
        f"{found.axis:.2f}",
        f"{found.diagonal:.2f}",
        f"{found.body_diagonal:.2f}",
        f"{100 * found.lattice_extrema:.1f} %",
        f"{seeds:.4f}",
        f"{max(lags.values()):.4f}",
    )


def _goals(report, kind, found, seeds, lags):
    gradient = kind in ("perlin", "simplex")
    how = f"{VOLUMES} volumes of {SIZE}³, {PER_CELL} samples a cell"
    report.add(
        f"noise quality, {kind}: energy below .25 cycles/cell",
        100 * found.low_energy,
        "%",
        goal="<= 1.5" if gradient else None,
        how=how,
    )
    ratios = np.array([found.axis, found.diagonal, found.body_diagonal])
    worst = float(ratios[np.argmax(np.abs(np.log(ratios)))])
    report.add(
        f"noise quality, {kind}: power of the direction furthest from the mean",
        worst,
        "",
        goal=None if not gradient else f"{'>=' if worst < 1 else '<='} {_bound(kind, worst)}",
        how=how,
    )
    report.add(
        f"noise quality, {kind}: extrema on the lattice",
        100 * found.lattice_extrema,
        "%",
        goal="<= 3" if gradient else None,
        how=how,
    )
    hashed = kind not in ("improved", "table")
    how = f"largest of 2016 pairs, {2**19} cells"
    report.add(
        f"noise quality, {kind}: |r| of 64 seeds", seeds, "", goal="<= 0.01" if hashed else None, how=how
    )
    how = "largest along axes and diagonals at 4, 8 … 4096 cells (256 among them)"
    worst = max(lags.values())
    report.add(f"noise quality, {kind}: |r| at lags", worst, "", goal="<= 0.01" if hashed else None, how=how)


def _bound(kind, worst):
    low, high = (0.97, 1.03) if kind == "simplex" else (0.9, 1.15)
    return low if worst < 1 else high
