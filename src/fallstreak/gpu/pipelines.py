"""Pipelines, made side by side: a driver compiles each on one core, and lets several threads in.

Passes that differ only in what they bind share one pipeline, whose shader the driver then compiles once.
"""

from __future__ import annotations

import os
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, field
from typing import Any

from .errors import translated

_THREADS = min(os.cpu_count() or 1, 8)

_BLENDS: dict[str, dict[str, dict[str, str]]] = {
    "add": {
        "color": {"src_factor": "one", "dst_factor": "one", "operation": "add"},
        "alpha": {"src_factor": "one", "dst_factor": "one", "operation": "add"},
    },
    "over": {
        "color": {"src_factor": "one", "dst_factor": "one-minus-src-alpha", "operation": "add"},
        "alpha": {"src_factor": "one", "dst_factor": "one-minus-src-alpha", "operation": "add"},
    },
    "under": {
        "color": {"src_factor": "one-minus-dst-alpha", "dst_factor": "one", "operation": "add"},
        "alpha": {"src_factor": "one-minus-dst-alpha", "dst_factor": "one", "operation": "add"},
    },
    "multiply": {
        "color": {"src_factor": "dst", "dst_factor": "zero", "operation": "add"},
        "alpha": {"src_factor": "dst-alpha", "dst_factor": "zero", "operation": "add"},
    },
}


@dataclass(frozen=True)
class ComputeSpec:
    """Everything a compute pipeline is made from."""

    name: str = field(compare=False)
    native: Any
    entry: str

    def pipeline(self, device: Any) -> Any:
        """Make it."""
        compute = {"module": self.native, "entry_point": self.entry}
        return device.create_compute_pipeline(label=self.name, layout="auto", compute=compute)


@dataclass(frozen=True)
class RenderSpec:
    """Everything a render pipeline is made from."""

    name: str = field(compare=False)
    native: Any
    vertex_native: Any
    vertex: str
    fragment: str | None
    color_formats: tuple[str, ...]
    depth_format: str | None
    depth_compare: str
    depth_write: bool
    blend: str | None
    topology: str
    cull: str

    def pipeline(self, device: Any) -> Any:
        """Make it."""
        targets = []
        for fmt in self.color_formats:
            target: dict[str, Any] = {"format": fmt}
            if self.blend is not None:
                if self.blend not in _BLENDS:
                    raise ValueError(
                        f"pass {self.name}: blend {self.blend!r} is unknown; use {', '.join(_BLENDS)}"
                    )
                target["blend"] = _BLENDS[self.blend]
            targets.append(target)
        options: dict[str, Any] = {}
        if self.fragment:
            options["fragment"] = {"module": self.native, "entry_point": self.fragment, "targets": targets}
        if self.depth_format:
            options["depth_stencil"] = {
                "format": self.depth_format,
                "depth_write_enabled": self.depth_write,
                "depth_compare": self.depth_compare,
            }
        return device.create_render_pipeline(
            label=self.name,
            layout="auto",
            vertex={"module": self.vertex_native, "entry_point": self.vertex, "buffers": []},
            primitive={"topology": self.topology, "cull_mode": self.cull},
            **options,
        )


Spec = ComputeSpec | RenderSpec


class Pipelines:
    """The pipelines of a device, kept as long as it lives.

    Parameters
    ----------
    native : wgpu device
    """

    def __init__(self, native: Any):
        self._native = native
        self._pool: ThreadPoolExecutor | None = None
        self._made: dict[Spec, Future[Any]] = {}

    def start(self, spec: Spec) -> None:
        """Have one made while the caller goes on; equal ones are made once."""
        if spec not in self._made:
            self._pool = self._pool or ThreadPoolExecutor(_THREADS, "pipelines")
            self._made[spec] = self._pool.submit(spec.pipeline, self._native)

    def of(self, spec: Spec) -> Any:
        """Wait for one that was started.

        Raises
        ------
        GpuError
            When the driver refuses it.
        """
        with translated(f"making the pipeline of {spec.name}"):
            return self._made[spec].result()

    def rest(self) -> None:
        """Let the threads go until there is more to start."""
        if self._pool is not None:
            self._pool.shutdown(wait=False)
            self._pool = None
