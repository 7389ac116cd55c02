"""Noise: speed beside other libraries in the same process, on one core and on all, and on the GPU.

1024² points of a tilted plane, 12 octaves, 3-D, float32. Peers are installed as docs/noise.md says; one that
is missing is told in its row. Times come in turns, so that whatever else the machine does hits all alike.
"""

import json
import os
import subprocess
import sys
from pathlib import Path
from statistics import median

import numpy as np

from fallstreak.commands.bench import Result

sys.path.insert(0, str(Path(__file__).parent))  # the files beside this one

import noise_bound
import noise_journal
import noise_peers as peers
from noise_peers import OCTAVES, SEED, SIDE, SLOW_SAMPLE, Times, race, race_apart

EVALUATIONS = SIDE * SIDE * OCTAVES
ROUNDS = 31
STRONG = ("pyfastnoisesimd", "FastNoise2")
HASWELL = {
    "NUMBA_CPU_NAME": "haswell",
    "NUMBA_CPU_FEATURES": "+avx,+avx2,+fma,+f16c,+bmi,+bmi2,+lzcnt,+movbe",
}
HOW = f"{SIDE}² points of a tilted plane, {OCTAVES} octaves, 3-D, float32"


def run(report):
    report.note(f"peers: {', '.join(peers.describe())}")
    found = _one_thread(report)
    _bound(report, found)
    _weaker(report, found)
    _plain(report)
    _avx2(report)
    _journal(report, found)
    _all_cores(report)
    _first_call(report)
    _gpu(report)


def _one_thread(report):
    """One process, one thread, the vectors that the machine has."""
    rounds = {f"fallstreak {kind}": ROUNDS for kind in _kinds()}
    rounds |= {f"fallstreak perlin {form}": ROUNDS for form in ("rows", "double")}
    rounds |= {f"{peer} {kind}": ROUNDS for peer in STRONG for kind in ("perlin", "simplex", "value")}
    rounds |= {"pyfastnoiselite perlin": 21, "noise perlin": 7, "opensimplex simplex": 7}
    rounds |= {"numpy perlin": 3, "numpy perlin pieces": 3, "vnoise perlin": 3, "perlin-noise perlin": 5}
    rounds["clock"] = ROUNDS
    rounds |= {f"journal {step}": 7 for step in noise_journal.STEPS}
    found = race(rounds)
    _table(report, "one thread", found)
    for kind, goal in (("perlin", ">= 1.05"), ("simplex", ">= 1.0")):
        for peer in STRONG:
            _ratio(report, f"{kind} over {peer}", found, f"{peer} {kind}", f"fallstreak {kind}", goal)
    return found


def _bound(report, found):
    """What share of the speed that its instructions allow the loop reaches."""
    counted = noise_bound.of_perlin()
    metric, goal = "noise: perlin, share of its issue bound", ">= 75"
    if not counted:
        report.missing(metric, "%", "the loop has no 512-bit vectors here", goal=goal)
        return
    report.note(
        f"vector instructions for 16 samples: {', '.join(f'{n} {i}' for i, n in counted.most_common())}"
    )
    ours, clock = found["fallstreak perlin"], found["clock"]
    slots = noise_bound.issues(counted)
    least = slots / noise_bound.PORTS / noise_bound.LANES  # cycles
    # the best of both: a round that others disturbed, on this core or its twin, says nothing about the loop
    share, middle = (
        100 * least * EVALUATIONS * c / (noise_bound.CYCLES * o)
        for o, c in ((ours.least, clock.least), (ours.median, clock.median))
    )
    hertz = noise_bound.CYCLES / clock.least
    how = f"{slots} issues in the machine code of the loop for {noise_bound.LANES} samples, "
    how += f"{noise_bound.PORTS} a cycle: {least:.2f} cycles each, {1e9 * least / hertz:.2f} ns at "
    how += f"{hertz / 1e9:.2f} GHz, measured in turns with the loop; minima of {len(ours.seconds)} rounds, "
    how += f"by medians {middle:.1f} %"
    report.add(metric, share, "%", goal=goal, how=how)


def _weaker(report, found):
    for name, goal in (
        ("pyfastnoiselite perlin", ">= 10"),
        ("noise perlin", ">= 20"),
        ("opensimplex simplex", ">= 25"),
        ("numpy perlin", ">= 100"),
        ("numpy perlin pieces", None),
        ("vnoise perlin", None),
        ("perlin-noise perlin", None),
    ):
        library, kind, *form = name.split()
        metric = f"{kind} over {' in '.join([library, *form])}"
        _ratio(report, metric, found, name, f"fallstreak {kind}", goal)


def _plain(report):
    """Without explicit vectors: loops that LLVM vectorises, as on processors that nobody wrote code for."""
    rounds = {"fallstreak perlin": ROUNDS} | {f"{peer} perlin": ROUNDS for peer in STRONG}
    found = race_apart(rounds, {"FALLSTREAK_NOISE_WIDTH": "1"})
    _table(report, "one thread, plain Numba (FALLSTREAK_NOISE_WIDTH=1)", found)
    for peer in STRONG:
        metric = f"plain perlin over {peer}"
        _ratio(report, metric, found, f"{peer} perlin", "fallstreak perlin", ">= 0.85", "plain Numba")


def _avx2(report):
    """As on a machine without AVX-512; the peers are held to AVX2 too."""
    names = ("fallstreak", *STRONG)
    rounds = {f"{name} {kind}": ROUNDS for name in names for kind in ("perlin", "simplex")}
    found = race_apart(rounds, HASWELL | {peers.AVX2: "1"})
    _table(report, "one thread, AVX2 only (all of them)", found)
    for kind in ("perlin", "simplex"):
        for peer in STRONG:
            metric = f"{kind} with AVX2 over {peer}"
            _ratio(report, metric, found, f"{peer} {kind}", f"fallstreak {kind}", ">= 1.0", "AVX2 only")


def _journal(report, found):
    steps = [found[f"journal {step}"].median * 1e3 for step in noise_journal.STEPS]
    rows = []
    for index, step in enumerate(noise_journal.STEPS):
        share, theirs = steps[index] / steps[0], noise_journal.PUBLISHED[step]
        rows.append((step, theirs, f"{theirs / 7270:.2f}", steps[index], f"{share:.2f}"))
    columns = ("step", "2007, ms", "of the first", "here, ms", "of the first")
    report.table("the journal's three steps, one sample after the other", columns, rows)
    report.note(f"7270 : 3324 : 1027 in 2007, here {' : '.join(f'{s:.0f}' for s in steps)}")
    ours, best = "fallstreak perlin", "the table in its best form, vectorised"
    _ratio(report, "perlin over the journal's table", found, "fallstreak table", ours, ">= 3.5", best)
    _ratio(report, "perlin over the journal's table as written", found, "journal table", ours)


def _all_cores(report):
    names = ("fallstreak perlin all", "pyfastnoisesimd perlin all")
    found = race(dict.fromkeys(names, 4 * ROUNDS))
    _table(report, f"{os.cpu_count()} cores", found)
    ours, theirs = (found[name] for name in names)
    metric, goal = "noise: perlin over pyfastnoisesimd, all cores", ">= 1.2"
    if isinstance(theirs, str):
        report.missing(metric, "times", theirs, goal=goal)
        return
    ratios = [b / a for a, b in zip(ours.seconds, theirs.seconds, strict=True)]
    how = f"{HOW}, {os.cpu_count()} cores, median of {len(ratios)} paired ratios"
    report.add(metric, median(ratios), "times", goal=goal, how=how)


def _first_call(report):
    """A new process, after this one has left the compiled code in the cache."""
    code = """
import json, time
import numpy as np
import numba
from numba.core.dispatcher import Dispatcher
compiled, compile_ = [], Dispatcher.compile
Dispatcher.compile = lambda self, signature: compiled.append(str(self)) or compile_(self, signature)
start = time.perf_counter()
import fallstreak.noise as noise
imported, count = time.perf_counter(), len(compiled)
noise.fbm(np.zeros((1000, 3), np.float32), 12)
print(json.dumps([imported - start, count, time.perf_counter() - imported]))
"""
    runs = []
    for _ in range(6):
        result = subprocess.run([sys.executable, "-c", code], stdout=subprocess.PIPE, check=True, text=True)
        runs.append(json.loads(result.stdout))
    how = "median of 5 new processes, numpy and numba imported before"
    seconds, counts, calls = (list(column) for column in zip(*runs[1:], strict=True))
    report.add("noise: functions compiled by the import", max(counts), "", goal="== 0", how=how)
    report.add("noise: import", median(seconds), "s", how=how)
    report.add("noise: first call after a cached build", median(calls), "s", goal="< 0.3", how=how)


def _gpu(report):
    """Every kind on the adapter that Fallstreak would use, and how far it is from the CPU."""
    from fallstreak import noise
    from fallstreak.gpu import Device, NoAdapterError
    from fallstreak.noise.bake import Layer, curl, sample, throughput

    try:
        device = Device.open()
    except NoAdapterError as error:
        report.missing("noise: evaluations a second on the GPU", "1/s", str(error))
        return
    points = np.random.default_rng(3).uniform(-1e4, 1e4, (1 << 16, 3))
    for kind in (*_kinds(), "curl"):
        flows = kind == "curl"
        layer = Layer("perlin" if flows else kind, octaves=4, frequency=1.0, seed=SEED)
        seconds = throughput(
            device, layer.kind, octaves=OCTAVES, count=SIDE * SIDE, what="flow" if flows else "points"
        )
        speed, unit = EVALUATIONS / min(seconds) / 1e6, "million evaluations a second"
        how = f"{HOW}, {device.adapter}, best of {len(seconds)}, without transfers"
        report.add(f"noise: {kind} on the GPU", speed, unit, how=how)
        if flows:
            there, here = curl(device, points, layer), noise.curl(points, octaves=4, seed=SEED)
        else:
            there, here = sample(device, points, layer), noise.fbm(points, 4, kind=kind, seed=SEED)
        how = f"{len(points)} random points within 10 000 cells, 4 octaves, {device.adapter}"
        report.add(f"noise: {kind}, GPU from CPU", np.abs(there - here).max(), "at most", how=how)


def _kinds():
    from fallstreak.noise.kinds import KINDS

    return [name for name, kind in KINDS.items() if 3 in kind.dimensions]


def _ratio(report, metric, found, theirs, ours, goal=None, more=""):
    """Their time over ours, medians; the ratio of the minima stands beside it."""
    a, b = found[theirs], found[ours]
    for times in (a, b):
        if isinstance(times, str):
            report.missing(f"noise: {metric}", "times", times, goal=goal)
            return
    scale = SIDE**2 / SLOW_SAMPLE if theirs.startswith("perlin-noise") else 1.0
    how = f"{HOW}, one thread, {f'{more}, ' if more else ''}ratio of the medians of {len(a.seconds)} and "
    how += f"{len(b.seconds)} interleaved rounds; of the minima {scale * a.least / b.least:.3g}"
    if scale > 1:
        how += f"; their time from {SLOW_SAMPLE} of the points"
    report.add(f"noise: {metric}", scale * a.median / b.median, "times", goal=goal, how=how)


def _table(report, title, found: dict[str, Times | str]):
    rows = []
    for name, times in sorted(found.items(), key=_seconds):
        if name == "clock":
            continue
        if isinstance(times, str):
            rows.append((name, times, "", "", ""))
            continue
        scale = SIDE**2 / SLOW_SAMPLE if name.startswith("perlin-noise") else 1.0
        ms, least = 1e3 * scale * times.median, 1e3 * scale * times.least
        rows.append((name, f"{ms:.1f}", f"{least:.1f}", f"{1e6 * ms / EVALUATIONS:.2f}", len(times.seconds)))
    columns = ("", "median, ms", "least, ms", "ns per evaluation", "rounds")
    report.table(f"{HOW}, {title}", columns, rows)
    for name, times in found.items():
        if isinstance(times, Times) and name != "clock":
            scale = SIDE**2 / SLOW_SAMPLE if name.startswith("perlin-noise") else 1.0
            how = f"{HOW}, median of {len(times.seconds)} interleaved rounds, "
            how += f"least {1e3 * scale * times.least:.1f}"
            metric = f"noise: {name}, {title.partition(' (')[0]}"
            report.results.append(Result(metric, 1e3 * scale * times.median, "ms", None, None, how))


def _seconds(item):
    name, times = item
    if isinstance(times, str):
        return float("inf")
    return times.median * (SIDE**2 / SLOW_SAMPLE if name.startswith("perlin-noise") else 1.0)
