"""What a picture or a sequence cost, as a file other programs can read.

Times are medians over the frames, because the first frame of a process also makes tables and warms caches;
`per_frame` has every frame. GPU times are null where the adapter has no timestamp queries.
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from statistics import median
from typing import Any

from fallstreak.output.atomic import replacing


class Statistics:
    """Collects the `stats` of frames, one after the other.

    Parameters
    ----------
    facts : mapping
        What is the same for all of them: version, scene, size, quality, samples, ...
    """

    def __init__(self, facts: Mapping[str, Any]):
        self._facts = dict(facts)
        self._frames: list[dict[str, Any]] = []
        self._passes: dict[str, tuple[list[float], list[float]]] = {}
        self._last: Mapping[str, Any] = {}

    def add(self, index: int, stats: Mapping[str, Any]) -> None:
        """Take the stats of a frame: `gpu_ms`, `cpu_ms`, `passes` (name, gpu_ms, cpu_ms), bytes."""
        self._last = stats
        self._frames.append(
            {"frame": index, **{key: _rounded(stats.get(key)) for key in ("gpu_ms", "cpu_ms")}}
        )
        for entry in stats.get("passes", ()):
            gpu, cpu = self._passes.setdefault(entry["name"], ([], []))
            _append(gpu, entry.get("gpu_ms"))
            _append(cpu, entry.get("cpu_ms"))

    def summary(self, seconds: float | None = None) -> dict[str, Any]:
        """Everything collected, as plain JSON values.

        Parameters
        ----------
        seconds : float, optional
            Wall-clock time of the whole run.
        """
        last = self._last
        return {
            **self._facts,
            "adapter": last.get("adapter"),
            "frames": len(self._frames),
            "seconds": None if seconds is None else round(seconds, 3),
            "gpu_ms": _median([f["gpu_ms"] for f in self._frames]),
            "cpu_ms": _median([f["cpu_ms"] for f in self._frames]),
            "passes": [
                {"name": name, "gpu_ms": _median(gpu), "cpu_ms": _median(cpu)}
                for name, (gpu, cpu) in self._passes.items()
            ],
            "texture_bytes": last.get("texture_bytes"),
            "buffer_bytes": last.get("buffer_bytes"),
            "calls": last.get("calls"),
            "per_frame": self._frames,
        }


def write_stats(path: str | os.PathLike, summary: Mapping[str, Any]) -> None:
    """Write a summary as JSON; an `OutputError` when the place cannot be written."""
    text = json.dumps(summary, indent=1, ensure_ascii=False, allow_nan=False) + "\n"
    with replacing(path) as beside:
        beside.write_text(text, encoding="utf-8")


def _append(values: list[float], value: float | None) -> None:
    if value is not None:
        values.append(float(value))


def _median(values: Sequence[float | None]) -> float | None:
    known = [value for value in values if value is not None]
    return _rounded(median(known)) if known else None


def _rounded(milliseconds: float | None) -> float | None:
    return None if milliseconds is None else round(milliseconds, 4)
