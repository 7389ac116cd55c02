#!/usr/bin/env python3
"""Write the tables of docs/noise.md from measured figures.

    fallstreak bench noise noise_quality --json figures.json --fastnoise2 libFastNoise.so
    python script/noise_tables.py figures.json

A table stands between `<!-- speed -->` and `<!-- end -->`, and so on.
"""

from __future__ import annotations

import json
import re
import sys
from pathlib import Path

PAGE = Path(__file__).parents[1] / "docs" / "noise.md"
PEERS = ("FastNoise2", "pyfastnoisesimd")
WIDTHS = ("one thread", "one thread, AVX2 only", "one thread, plain Numba")


def main(file: str) -> None:
    figures = {figure["metric"]: figure for figure in json.loads(Path(file).read_text(encoding="utf-8"))}
    page = PAGE.read_text(encoding="utf-8")
    for name, make in (("speed", speed), ("goals", goals), ("gpu", gpu), ("quality", quality)):
        table = "\n".join(f"| {' | '.join(row)} |" for row in make(figures))
        page = re.sub(
            rf"(<!-- {name} -->\n).*?(<!-- end -->)", rf"\g<1>\n{table}\n\n\g<2>", page, flags=re.DOTALL
        )
    PAGE.write_text(page, encoding="utf-8")


def speed(figures):
    """Milliseconds of everybody, the fastest first: median and least of the rounds."""
    yield "", *(f"{way}, ms" for way in ("best vectors", "AVX2 only", "plain Numba")), "ns per evaluation"
    yield "---", "--:", "--:", "--:", "--:"
    found = {}
    for metric, figure in figures.items():
        match = re.fullmatch(r"noise: (\S+ \S+(?: \w+)?), (one thread.*)", metric)
        if match and figure["unit"] == "ms":
            least = float(re.search(r"least ([\d.]+)", figure["how"])[1])
            found.setdefault(match[1], {})[match[2]] = figure["value"], least
    for name, times in found.items():
        if not name.startswith("fallstreak"):
            times.pop(WIDTHS[2], None)  # theirs are as always, beside our plain loops
    for name, times in sorted(found.items(), key=lambda item: item[1].get(WIDTHS[0], (1e30,))):
        if WIDTHS[0] in times:
            yield (
                f"**{name}**" if name.startswith("fallstreak") else name,
                *(f"{_ms(times[w][0])} ({_ms(times[w][1])})" if w in times else "" for w in WIDTHS),
                f"{times[WIDTHS[0]][0] * 1e6 / (12 * 1024**2):,.2f}",
            )


def _ms(value: float) -> str:
    return f"{value:.1f}" if value < 1000 else f"{value:,.0f}"


def goals(figures):
    yield "", "measured", "goal", ""
    yield "---", "--:", "--:", "---"
    for metric, figure in figures.items():
        if metric.startswith("noise: ") and figure["goal"]:
            value = "–" if figure["value"] is None else f"{figure['value']:.3g} {figure['unit']}"
            verdict = {True: "met", False: "missed", None: "not measured"}[figure["met"]]
            goal = figure["goal"].replace(">=", "≥").replace("<=", "≤").replace("== ", "")
            yield metric.removeprefix("noise: "), value.strip(), goal, verdict


def gpu(figures):
    yield "", "million evaluations a second", "largest difference from the CPU"
    yield "---", "--:", "--:"
    for metric, figure in figures.items():
        if match := re.fullmatch(r"noise: (.+) on the GPU", metric):
            difference = figures.get(f"noise: {match[1]}, GPU from CPU")
            yield match[1], f"{figure['value']:,.0f}", f"{difference['value']:.1e}" if difference else ""


def quality(figures):
    what = (
        ("energy below .25 cycles/cell", "energy below ¼ cycle a cell", "{:.2g} %"),
        ("power of the direction furthest from the mean", "direction furthest from the mean", "{:.2f}"),
        ("extrema on the lattice", "extrema on the lattice", "{:.0f} %"),
        ("|r| of 64 seeds", "largest \\|r\\| of 64 seeds", "{:.4f}"),
        ("|r| at lags", "largest \\|r\\| at lags to 4096", "{:.4f}"),
    )
    yield "", *(heading for _, heading, _ in what)
    yield "---", *("--:" for _ in what)
    kinds = [
        match[1]
        for metric in figures
        if (match := re.fullmatch(r"noise quality, (\w+): energy below .25 cycles/cell", metric))
    ]
    for kind in kinds:
        yield kind, *(form.format(figures[f"noise quality, {kind}: {key}"]["value"]) for key, _, form in what)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
