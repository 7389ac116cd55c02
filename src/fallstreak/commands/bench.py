"""``fallstreak bench``: run the benchmarks, print what they measured beside the goals, and write it down.

A benchmark is a file ``bench_NAME.py`` with a function ``run(report)`` that calls `Report.add` for every
figure. The files live in ``benchmarks/`` of a checkout; an installed package carries them as
``fallstreak/_benchmarks``. They are apart from the tests because a figure depends on the machine: a goal that
is missed is printed, not raised.
"""

from __future__ import annotations

import importlib.util
import json
import math
import os
import platform
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from rich.console import Console
from rich.table import Table

from fallstreak.world.errors import UserError

_COMPARISONS: dict[str, Callable[[float, float], bool]] = {
    "<=": lambda value, bound: value <= bound,
    "<": lambda value, bound: value < bound,
    ">=": lambda value, bound: value >= bound,
    ">": lambda value, bound: value > bound,
    "==": lambda value, bound: value == bound,
}


class BenchError(UserError):
    """A benchmark that does not exist or cannot be found, said in one sentence."""


@dataclass(frozen=True)
class Result:
    """One measured figure."""

    metric: str
    value: float | None  # None: could not be measured here
    unit: str
    goal: str | None
    met: bool | None
    how: str


class Report:
    """What the benchmarks write into; prints each figure as it arrives, because some take minutes."""

    def __init__(self, console: Console | None = None) -> None:
        self.results: list[Result] = []
        self._console = console or Console()

    def add(self, metric: str, value: float, unit: str, *, goal: str | None = None, how: str = "") -> Result:
        """Record a figure.

        Parameters
        ----------
        metric
            What was measured, unique over all benchmarks: ``"sky cost per frame"``.
        value, unit
            The figure and its unit; ``""`` where there is none.
        goal
            A comparison with a number, ``"<= 11"`` or ``">= 10"``; None where nothing was promised.
        how
            How it was measured, so that others can: size, quality, repetitions, which statistic.
        """
        value = float(value)
        if not math.isfinite(value):
            raise ValueError(f"{metric} is {value}, which is no figure")
        result = Result(metric, value, unit, goal, None if goal is None else _met(value, goal), how)
        self.results.append(result)
        self._console.print(
            f"  {metric}: {_figure(value)} {unit}{_verdict(result)}", highlight=False, markup=False
        )
        return result

    def missing(self, metric: str, unit: str, why: str, *, goal: str | None = None) -> Result:
        """Record that a figure could not be measured here, and why; whether its goal is met stays unknown."""
        result = Result(metric, None, unit, goal, None, why)
        self.results.append(result)
        self._console.print(f"  {metric}: not measured, {why}", highlight=False, markup=False)
        return result

    def note(self, text: str) -> None:
        """Print an explanation among the figures; it goes into no file."""
        self._console.print(f"  {text}", highlight=False, markup=False, soft_wrap=True)

    def table(self, title: str, columns: Sequence[str], rows: Iterable[Sequence[object]]) -> None:
        """Print a table, such as the cost of every pass; it goes into no file."""
        table = Table(title=title, title_justify="left")
        for index, column in enumerate(columns):
            table.add_column(column, justify="left" if index == 0 else "right")
        for row in rows:
            table.add_row(*(_figure(cell) if isinstance(cell, float) else str(cell) for cell in row))
        self._console.print(table)


def bench(names: Sequence[str] = (), json_file: Path | None = None) -> int:
    """Run the named benchmarks, or all of them, and return the exit status: 1 if one of them broke.

    Parameters
    ----------
    names
        Names as ``available`` gives them; none means all.
    json_file
        Where to write the list of figures, each with metric, value, unit, goal, met and how.

    Raises
    ------
    BenchError
        If there is no benchmark of that name, or none at all.
    """
    found = available()
    if unknown := sorted(set(names) - found.keys()):
        raise BenchError(f"no benchmark named {', '.join(unknown)}; there are {', '.join(found)}")
    console = Console()
    console.print(f"machine: {machine()}", highlight=False, markup=False, soft_wrap=True)
    console.print(f"adapter: {adapter()}", highlight=False, markup=False, soft_wrap=True)
    report: list[Result] = []
    broken = []
    for name in names or found:
        console.print(f"[bold]{name}[/bold]")
        start = time.perf_counter()
        results = _run_apart(found[name])
        if results is None:
            broken.append(name)
        else:
            report.extend(results)
        console.print(f"  ({time.perf_counter() - start:.1f} s)", highlight=False)
    _print_summary(console, report)
    if json_file is not None:
        _write(json_file, report)
        console.print(f"written: {json_file}", highlight=False, markup=False, soft_wrap=True)
    if broken:
        console.print(f"broken: {', '.join(broken)}", style="red")
    return 1 if broken else 0


def available() -> dict[str, Path]:
    """The benchmarks there are, name → file, in alphabetical order.

    Raises
    ------
    BenchError
        If the folder is not there.
    """
    here = Path(__file__).resolve()
    for folder in (here.parents[1] / "_benchmarks", here.parents[3] / "benchmarks"):
        if files := sorted(folder.glob("bench_*.py")):
            return {file.stem.removeprefix("bench_"): file for file in files}
    raise BenchError("the benchmarks are not installed; run this from a checkout of the repository")


def machine() -> str:
    """The machine in words: processor, cores, memory, system, Python."""
    return (
        f"{_processor()}, {os.cpu_count()} cores, {_memory()}, {platform.system()} {platform.release()}, "
        f"Python {platform.python_version()}"
    )


def adapter() -> str:
    """The graphics adapter that will be used, in words."""
    from fallstreak.gpu import Device, NoAdapterError

    try:
        return str(Device.open().adapter)
    except NoAdapterError as error:
        return f"none ({error})"


def _processor() -> str:
    try:
        text = Path("/proc/cpuinfo").read_text(encoding="utf-8")
        if match := re.search(r"model name\s*:\s*(.+)", text):
            return match.group(1).strip()
    except OSError:
        pass
    return platform.processor() or platform.machine()


def _memory() -> str:
    try:
        return f"{os.sysconf('SC_PHYS_PAGES') * os.sysconf('SC_PAGE_SIZE') / 2**30:.0f} GiB"
    except (AttributeError, ValueError, OSError):  # no such thing on this system
        return "memory unknown"


def _run_apart(path: Path) -> list[Result] | None:
    """Run one benchmark in a process of its own, where it finds no other's caches and no other's memory."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "figures.json"
        sys.stdout.flush()
        if subprocess.run([sys.executable, "-m", __name__, str(path), str(file)]).returncode != 0:
            return None
        return [Result(**figure) for figure in json.loads(file.read_text(encoding="utf-8"))]


def _run_here(path: Path, file: Path) -> None:
    report = Report()
    _load(path).run(report)
    _write(file, report.results)


def _load(path: Path):
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None and spec.loader is not None  # a .py file always has both
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def _met(value: float, goal: str) -> bool:
    match = re.fullmatch(r"\s*(<=|>=|==|<|>)\s*([-+0-9.eE]+)\s*", goal)
    if match is None:
        raise ValueError(f"goal {goal!r} is not a comparison with a number, such as '<= 11'")
    return _COMPARISONS[match.group(1)](value, float(match.group(2)))


def _figure(value: float | None) -> str:
    if value is None:
        return "–"
    if value.is_integer() and abs(value) < 1e9:
        return str(int(value))
    return f"{value:.3g}" if abs(value) < 1000 else f"{value:.0f}"


def _verdict(result: Result) -> str:
    if result.goal is None:
        return ""
    return f" (goal {result.goal}: {'met' if result.met else 'MISSED'})"


def _print_summary(console: Console, results: list[Result]) -> None:
    table = Table(title="benchmarks", title_justify="left")
    for column, justify in (
        ("metric", "left"),
        ("value", "right"),
        ("unit", "left"),
        ("goal", "left"),
        ("", "left"),
    ):
        table.add_column(column, justify=justify)  # type: ignore[arg-type]
    for result in results:
        verdict = {None: "", True: "met", False: "[red]missed[/red]"}[result.met]
        if result.value is None:
            verdict = "not measured"
        table.add_row(result.metric, _figure(result.value), result.unit, result.goal or "", verdict)
    console.print(table)


def _write(path: Path, results: list[Result]) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_name(path.name + ".part")
    temporary.write_text(
        json.dumps([asdict(result) for result in results], indent=1) + "\n", encoding="utf-8"
    )
    temporary.replace(path)


if __name__ == "__main__":
    _run_here(Path(sys.argv[1]), Path(sys.argv[2]))
