"""The table of pass times, from a stats file or right after rendering.

``python -m fallstreak.commands.stats FILE.json`` prints it again.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table

from fallstreak.output.errors import OutputError

_SHARE = 0.01  # of the frame; cheaper passes share one row


def print_stats(summary: Mapping[str, Any], console: Console | None = None) -> None:
    """Print what `fallstreak.output.stats.Statistics.summary` gives as a table, the dearest pass first."""
    console = console or Console()
    console.print(_title(summary), highlight=False, markup=False, soft_wrap=True)
    table = Table()
    table.add_column("pass")
    for column in ("GPU ms", "CPU ms"):
        table.add_column(column, justify="right")
    key = "gpu_ms" if summary.get("gpu_ms") is not None else "cpu_ms"
    passes = sorted(summary["passes"], key=lambda entry: -(entry[key] or 0.0))
    limit = _SHARE * sum(entry[key] or 0.0 for entry in passes)
    small = [entry for entry in passes if (entry[key] or 0.0) < limit]
    for entry in passes:
        if entry not in small:
            table.add_row(entry["name"], _ms(entry["gpu_ms"]), _ms(entry["cpu_ms"]))
    if small:
        gpu, cpu = (_sum(small, name) for name in ("gpu_ms", "cpu_ms"))
        table.add_row(f"{len(small)} smaller ones", _ms(gpu), _ms(cpu))
    table.add_section()
    table.add_row("frame", _ms(summary["gpu_ms"]), _ms(summary["cpu_ms"]))
    console.print(table)
    memory = ", ".join(
        f"{summary[key] / 2**20:.1f} MiB of {what}"
        for key, what in (("texture_bytes", "textures"), ("buffer_bytes", "buffers"))
        if summary.get(key) is not None
    )
    console.print(f"{summary['adapter']}: {memory}", highlight=False, markup=False, soft_wrap=True)


def read_stats(path: str | Path) -> dict[str, Any]:
    """A stats file's contents; an `OutputError` if it is not one."""
    try:
        summary = json.loads(Path(path).read_text(encoding="utf-8"))
        if isinstance(summary, dict) and {"passes", "gpu_ms", "cpu_ms", "adapter"} <= summary.keys():
            return summary
    except OSError as error:
        raise OutputError(f"cannot read {path}: {(error.strerror or str(error)).lower()}") from error
    except ValueError:
        pass
    raise OutputError(f"{path} is not a stats file of `fallstreak render --stats`")


def _title(summary: Mapping[str, Any]) -> str:
    frames, size = summary.get("frames", 1), summary.get("size", ())
    parts = [str(summary.get("scene", "")), "×".join(map(str, size)), summary.get("quality", "")]
    if frames > 1:
        parts.append(f"median of {frames} frames")
    if summary.get("samples", 1) > 1:
        parts.append(f"times of one of {summary['samples']} samples")
    return ", ".join(part for part in parts if part)


def _sum(entries: list[dict[str, Any]], key: str) -> float | None:
    known = [entry[key] for entry in entries if entry[key] is not None]
    return sum(known) if known else None


def _ms(value: float | None) -> str:
    return "–" if value is None else f"{value:.2f}"


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("usage: python -m fallstreak.commands.stats FILE.json")
    try:
        print_stats(read_stats(sys.argv[1]))
    except OutputError as error:
        sys.exit(str(error))
