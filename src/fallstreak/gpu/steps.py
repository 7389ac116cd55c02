"""Passes ready to run: everything a frame needs was made beforehand, recording only plays it back."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from .native import RenderDescriptor, bindings, compute_descriptor, handle

if TYPE_CHECKING:
    from .compiled import Compiled


class Step:
    """One pass of the compiled frame."""

    is_timed = True

    def __init__(self, name: str):
        self.name = name
        self.cpu_ms = 0.0
        self.writes: set[tuple[str, int]] = set()
        """(resource, mip) that it writes."""

    def timed(self, timestamps: dict[str, Any] | None) -> None:
        """Take the timestamp queries of this pass."""

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
        self._descriptor = compute_descriptor(name)

    def timed(self, timestamps: dict[str, Any] | None) -> None:
        self._descriptor.timestamps(timestamps)

    def _record_into(self, encoder: Any, parity: int, written: set[tuple[str, int]]) -> int:
        lib, ffi = bindings().lib, bindings().ffi
        work = lib.wgpuCommandEncoderBeginComputePass(handle(encoder), self._descriptor.c)
        lib.wgpuComputePassEncoderSetPipeline(work, handle(self._pipeline))
        group = self._groups[parity % len(self._groups)]
        if group is not None:
            lib.wgpuComputePassEncoderSetBindGroup(work, 0, handle(group), 0, ffi.NULL)
        if self._indirect is not None:
            lib.wgpuComputePassEncoderDispatchWorkgroupsIndirect(work, handle(self._indirect), 0)
        else:
            count: Any = self._count() if callable(self._count) else self._count
            lib.wgpuComputePassEncoderDispatchWorkgroups(work, *count)
        lib.wgpuComputePassEncoderEnd(work)
        lib.wgpuComputePassEncoderRelease(work)
        return 5


class RenderStep(Step):
    """A draw."""

    def __init__(
        self,
        name: str,
        pipeline: Any,
        groups: list[Any],
        descriptors: list[RenderDescriptor],
        color: list[tuple[str, int]],
        depth: tuple[str, int] | None,
        vertices: Any,
        instances: Any,
        indirect: Any,
        index: Any,
        indices: int,
        indirect_offset: int = 0,
    ):
        super().__init__(name)
        self._pipeline, self._groups, self._descriptors = pipeline, groups, descriptors
        self._color, self._depth = color, depth
        self._vertices, self._instances = vertices, instances
        self._indirect, self._index, self._indices = indirect, index, indices
        self._indirect_offset = indirect_offset

    def timed(self, timestamps: dict[str, Any] | None) -> None:
        for descriptor in self._descriptors:
            descriptor.timestamps(timestamps)

    def _record_into(self, encoder: Any, parity: int, written: set[tuple[str, int]]) -> int:
        lib, ffi = bindings().lib, bindings().ffi
        descriptor = self._descriptors[parity % len(self._descriptors)]
        # The first pass that really runs clears: which one that is may change from frame to frame.
        for i, key in enumerate(self._color):
            descriptor.load_color(i, key in written)
        if self._depth in self.writes:
            descriptor.load_depth(self._depth in written)
        draw = lib.wgpuCommandEncoderBeginRenderPass(handle(encoder), descriptor.c)
        lib.wgpuRenderPassEncoderSetPipeline(draw, handle(self._pipeline))
        group = self._groups[parity % len(self._groups)]
        if group is not None:
            lib.wgpuRenderPassEncoderSetBindGroup(draw, 0, handle(group), 0, ffi.NULL)
        calls = 5
        if self._index is not None:
            size = lib.WGPU_WHOLE_SIZE
            lib.wgpuRenderPassEncoderSetIndexBuffer(
                draw, handle(self._index), lib.WGPUIndexFormat_Uint32, 0, size
            )
            calls += 1
        instances: Any = self._instances() if callable(self._instances) else self._instances
        if self._indirect is not None and self._index is not None:
            lib.wgpuRenderPassEncoderDrawIndexedIndirect(draw, handle(self._indirect), self._indirect_offset)
        elif self._indirect is not None:
            lib.wgpuRenderPassEncoderDrawIndirect(draw, handle(self._indirect), self._indirect_offset)
        elif self._index is not None:
            lib.wgpuRenderPassEncoderDrawIndexed(draw, self._indices, instances, 0, 0, 0)
        else:
            vertices: Any = self._vertices() if callable(self._vertices) else self._vertices
            lib.wgpuRenderPassEncoderDraw(draw, vertices, instances, 0, 0)
        lib.wgpuRenderPassEncoderEnd(draw)
        lib.wgpuRenderPassEncoderRelease(draw)
        return calls


class Context:
    """What a self-recording pass gets."""

    def __init__(self, compiled: Compiled, parity: int):
        self._compiled, self.parity = compiled, parity
        self.encoder: Any = None

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
        context.encoder = encoder
        self._record(context)
        return 1
