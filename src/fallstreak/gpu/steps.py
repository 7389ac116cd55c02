"""Passes ready to run: everything a frame needs was made beforehand, recording only plays it back."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .compiled import Compiled

_BLENDS: dict[str, dict[str, dict[str, str]]] = {
    "add": {
        "color": {"src_factor": "one", "dst_factor": "one", "operation": "add"},
        "alpha": {"src_factor": "one", "dst_factor": "one", "operation": "add"},
    },
    "over": {
        "color": {"src_factor": "one", "dst_factor": "one-minus-src-alpha", "operation": "add"},
        "alpha": {"src_factor": "one", "dst_factor": "one-minus-src-alpha", "operation": "add"},
    },
    "multiply": {
        "color": {"src_factor": "dst", "dst_factor": "zero", "operation": "add"},
        "alpha": {"src_factor": "dst-alpha", "dst_factor": "zero", "operation": "add"},
    },
}


class Step:
    """One pass of the compiled frame."""

    is_timed = True

    def __init__(self, name: str):
        self.name = name
        self.cpu_ms = 0.0
        self.writes: set[tuple[str, int]] = set()
        """(resource, mip) that it writes."""
        self._timestamps: dict[str, Any] | None = None

    def timed(self, timestamps: dict[str, Any] | None) -> None:
        """Take the timestamp queries of this pass."""
        self._timestamps = timestamps

    def record(self, encoder: Any, parity: int, written: set[tuple[str, int]]) -> int:
        """Record into the frame's encoder; returns the number of WebGPU calls.

        Parameters
        ----------
        parity : 0 or 1
            Which of a history's two places is this frame's.
        written : set
            (resource, mip) that passes of this frame have written; grows by this one's.
        """
        calls = self._record_into(encoder, parity, written)
        written |= self.writes
        return calls

    def _record_into(self, encoder: Any, parity: int, written: set[tuple[str, int]]) -> int:
        raise NotImplementedError


class ComputeStep(Step):
    """A dispatch."""

    def __init__(self, name: str, pipeline: Any, groups: list[Any], count: Any, indirect: Any):
        super().__init__(name)
        self._pipeline, self._groups, self._count, self._indirect = pipeline, groups, count, indirect

    def _record_into(self, encoder: Any, parity: int, written: set[tuple[str, int]]) -> int:
        work = encoder.begin_compute_pass(label=self.name, timestamp_writes=self._timestamps)
        work.set_pipeline(self._pipeline)
        group = self._groups[parity % len(self._groups)]
        if group is not None:
            work.set_bind_group(0, group)
        if self._indirect is not None:
            work.dispatch_workgroups_indirect(self._indirect, 0)
        else:
            count: Any = self._count() if callable(self._count) else self._count
            work.dispatch_workgroups(*count)
        work.end()
        return 5


class RenderStep(Step):
    """A draw."""

    def __init__(
        self,
        name: str,
        pipeline: Any,
        groups: list[Any],
        descriptors: list[dict[str, Any]],
        color: list[tuple[str, int]],
        depth: tuple[str, int] | None,
        vertices: Any,
        instances: Any,
        indirect: Any,
        index: Any,
        indices: int,
    ):
        super().__init__(name)
        self._pipeline, self._groups, self._descriptors = pipeline, groups, descriptors
        self._color, self._depth = color, depth
        self._vertices, self._instances = vertices, instances
        self._indirect, self._index, self._indices = indirect, index, indices

    def _record_into(self, encoder: Any, parity: int, written: set[tuple[str, int]]) -> int:
        descriptor = self._descriptors[parity % len(self._descriptors)]
        # The first pass that really runs clears: which one that is may change from frame to frame.
        for key, attachment in zip(self._color, descriptor["color_attachments"], strict=True):
            attachment["load_op"] = "load" if key in written else "clear"
        if self._depth in self.writes:
            load = "load" if self._depth in written else "clear"
            descriptor["depth_stencil_attachment"]["depth_load_op"] = load
        draw = encoder.begin_render_pass(label=self.name, timestamp_writes=self._timestamps, **descriptor)
        draw.set_pipeline(self._pipeline)
        group = self._groups[parity % len(self._groups)]
        if group is not None:
            draw.set_bind_group(0, group)
        calls = 5
        if self._index is not None:
            draw.set_index_buffer(self._index, "uint32")
            calls += 1
        instances = self._instances() if callable(self._instances) else self._instances
        if self._indirect is not None and self._index is not None:
            draw.draw_indexed_indirect(self._indirect, 0)
        elif self._indirect is not None:
            draw.draw_indirect(self._indirect, 0)
        elif self._index is not None:
            draw.draw_indexed(self._indices, instances)
        else:
            draw.draw(self._vertices() if callable(self._vertices) else self._vertices, instances)
        draw.end()
        return calls


class Context:
    """What a self-recording pass gets."""

    def __init__(self, compiled: Compiled, parity: int):
        self._compiled, self.parity = compiled, parity
        self.encoder: Any = None
        self.timestamps: dict[str, Any] | None = None

    def resource(self, name: str) -> Any:
        """The wgpu texture or buffer behind a name ("x" or "x@previous")."""
        base, _, version = name.partition("@")
        return self._compiled.physical[base].at(self.parity, version == "previous")


class CustomStep(Step):
    """A pass that records its own commands."""

    is_timed = False

    def __init__(self, name: str, record: Callable[[Context], None], context: Callable[[int], Context]):
        super().__init__(name)
        self._record, self._contexts = record, [context(0), context(1)]

    def _record_into(self, encoder: Any, parity: int, written: set[tuple[str, int]]) -> int:
        context = self._contexts[parity]
        context.encoder, context.timestamps = encoder, self._timestamps
        self._record(context)
        return 1


@dataclass
class RenderSpec:
    """Everything a render pipeline is made from."""

    name: str
    native: Any
    vertex_native: Any
    vertex: str
    fragment: str | None
    color_formats: list[str]
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
