"""The benchmark runner: what it writes, how it judges, what a broken benchmark costs the others: nothing."""

import json
import math
from io import StringIO
from pathlib import Path

import pytest
from rich.console import Console

from fallstreak.commands import bench as module
from fallstreak.commands.bench import BenchError, Report, available, bench


@pytest.fixture
def benchmarks(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "bench_good.py").write_text(
        "def run(report):\n"
        "    report.add('speed', 12, 'frames/s', goal='>= 10', how='counted')\n"
        "    report.add('size', 3.5, 'MB', goal='< 3')\n"
        "    report.add('count', 7, '')\n"
        "    report.table('passes', ['name', 'ms'], [['sky', 1.25]])\n"
    )
    (tmp_path / "bench_bad.py").write_text("def run(report):\n    raise RuntimeError('no')\n")
    files = {f.stem.removeprefix("bench_"): f for f in sorted(tmp_path.glob("bench_*.py"))}
    monkeypatch.setattr(module, "available", lambda: files)
    monkeypatch.setattr(module, "adapter", lambda: "none")
    return tmp_path


def test_it_writes_the_list_that_the_issue_describes(benchmarks, tmp_path, capfd):
    file = tmp_path / "deep" / "figures.json"
    assert bench(["good"], file) == 0
    assert json.loads(file.read_text()) == [
        {
            "metric": "speed",
            "value": 12.0,
            "unit": "frames/s",
            "goal": ">= 10",
            "met": True,
            "how": "counted",
        },
        {"metric": "size", "value": 3.5, "unit": "MB", "goal": "< 3", "met": False, "how": ""},
        {"metric": "count", "value": 7.0, "unit": "", "goal": None, "met": None, "how": ""},
    ]
    assert list(file.parent.iterdir()) == [file]
    printed = capfd.readouterr().out
    assert "machine: " in printed and "cores" in printed and "speed: 12 frames/s (goal >= 10: met)" in printed


def test_a_figure_that_cannot_be_measured_is_told_with_its_reason(tmp_path, monkeypatch, capfd):
    (tmp_path / "bench_peer.py").write_text(
        "def run(report):\n    report.missing('ratio', '', 'a peer is not installed', goal='>= 2')\n"
    )
    monkeypatch.setattr(module, "available", lambda: {"peer": tmp_path / "bench_peer.py"})
    monkeypatch.setattr(module, "adapter", lambda: "none")
    assert bench(["peer"], tmp_path / "figures.json") == 0
    (figure,) = json.loads((tmp_path / "figures.json").read_text())
    assert (figure["value"], figure["goal"], figure["met"]) == (None, ">= 2", None)
    assert "not measured, a peer is not installed" in capfd.readouterr().out


def test_a_broken_benchmark_fails_the_run_but_not_the_others(benchmarks, tmp_path, capfd):
    file = tmp_path / "figures.json"
    assert bench([], file) == 1
    assert len(json.loads(file.read_text())) == 3
    assert "RuntimeError: no" in capfd.readouterr().err


def test_an_unknown_name_says_which_there_are(benchmarks):
    with pytest.raises(BenchError, match=r"no benchmark named nonesuch; there are bad, good"):
        bench(["good", "nonesuch"])


def test_figures_must_be_figures_and_goals_comparisons():
    report = Report(Console(file=StringIO()))
    with pytest.raises(ValueError, match="no figure"):
        report.add("speed", math.nan, "")
    with pytest.raises(ValueError, match="not a comparison"):
        report.add("speed", 1, "", goal="fast")


def test_a_checkout_has_its_benchmarks():
    assert {"frame", "memory", "startup", "climb"} <= available().keys()
