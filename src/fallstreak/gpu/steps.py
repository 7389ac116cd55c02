"""Passes ready to run: everything a frame needs was made beforehand, recording only plays it back."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from .native import Descriptor, RenderDescriptor, bindings, compute_descriptor, handle

if TYPE_CHECKING:
    from .compiled import Compiled


class Tape:
    """A frame as it is recorded: its encoder, and the compute or render pass under way in it.

    Dispatches that follow each other share one compute pass, draws into the same targets one render pass:
    beginning and ending one costs about as much as three draws.

    Parameters
    ----------
    encoder : wgpu encoder
    apart : bool
        Every step gets a pass of its own, since only whole passes can be timed.

    Attributes
    ----------
    calls : int
        WebGPU calls so far.
    written : set of (resource, mip)
        What steps of this frame have written.
    """

    def __init__(self, encoder: Any, apart: bool):
        self.encoder = encoder
        self.calls = 0
        self.written: set[tuple[str, int]] = set()
        self._lib = bindings().lib
        self._handle = handle(encoder)
        self._apart = apart
        self._work: Any = None
        self._targets: object = None
        self._owner: Step | None = None

    def compute(self, step: Step, descriptor: Descriptor) -> Any:
        """The compute pass to record a step into."""
        if self._targets is not COMPUTE:
            self.close()
            self._work = self._lib.wgpuCommandEncoderBeginComputePass(self._handle, descriptor.c)
            self._open(step, COMPUTE)
        else:
            self._share(step)
        return self._work

    def render(self, step: Step, descriptor: Descriptor, targets: object) -> Any:
        """The render pass to record a step into; `targets` as of `RenderStep`."""
        if targets is None or self._targets is not targets:
            self.close()
            self._work = self._lib.wgpuCommandEncoderBeginRenderPass(self._handle, descriptor.c)
            self._open(step, targets)
        else:
            self._share(step)
        return self._work

    def _open(self, step: Step, targets: object) -> None:
        self._owner, self._targets, step.shares = step, None if self._apart else targets, False
        step.opens = True
        self._end = (
            (self._lib.wgpuComputePassEncoderEnd, self._lib.wgpuComputePassEncoderRelease)
            if targets is COMPUTE
            else (self._lib.wgpuRenderPassEncoderEnd, self._lib.wgpuRenderPassEncoderRelease)
        )
        self.calls += 1

    def _share(self, step: Step) -> None:
        assert self._owner is not None
        self._owner.shares = step.shares = True
        step.opens = False

    def close(self) -> None:
        """End the pass under way, if there is one."""
        if self._work is not None:
            for call in self._end:
                call(self._work)
            self._work = self._targets = None
            self.calls += 1


COMPUTE = object()
"""What stands for the targets of a compute pass: any dispatch may follow any other."""


class Step:
    """One pass of the compiled frame."""

    is_timed = True

    def __init__(self, name: str):
        self.name = name
        self.cpu_ms = 0.0
        self.shares = False
        """Whether it shared a compute or render pass with others in the last frame it ran in."""
        self.opens = True
        """Whether that pass began with it: then it holds the time of all of them."""
        self.writes: set[tuple[str, int]] = set()
        """(resource, mip) that it writes."""

    def timed(self, timestamps: dict[str, Any] | None) -> None:
        """Take the timestamp queries of this pass."""

    def record(self, tape: Tape, parity: int) -> None:
        """Record into the frame.

        Parameters
        ----------
        tape : Tape
        parity : 0 or 1
            Which of a history's two places is this frame's.
        """
        self._record_into(tape, parity)
        tape.written |= self.writes

    def _record_into(self, tape: Tape, parity: int) -> None:
        raise NotImplementedError


class ComputeStep(Step):
    """A dispatch."""

    def __init__(self, name: str, pipeline: Any, groups: list[Any], count: Any, indirect: Any):
        super().__init__(name)
        self._pipeline, self._groups, self._count, self._indirect = pipeline, groups, count, indirect
        self._descriptor = compute_descriptor(name)

    def timed(self, timestamps: dict[str, Any] | None) -> None:
        self._descriptor.timestamps(timestamps)

    def _record_into(self, tape: Tape, parity: int) -> None:
        lib, ffi = bindings().lib, bindings().ffi
        work = tape.compute(self, self._descriptor)
        lib.wgpuComputePassEncoderSetPipeline(work, handle(self._pipeline))
        group = self._groups[parity % len(self._groups)]
        if group is not None:
            lib.wgpuComputePassEncoderSetBindGroup(work, 0, handle(group), 0, ffi.NULL)
        if self._indirect is not None:
            lib.wgpuComputePassEncoderDispatchWorkgroupsIndirect(work, handle(self._indirect), 0)
        else:
            count: Any = self._count() if callable(self._count) else self._count
            lib.wgpuComputePassEncoderDispatchWorkgroups(work, *count)
        tape.calls += 3


class RenderStep(Step):
    """A draw.

    `targets` is one object for all steps that draw into the same ones; None for a step that writes something
    else too, and therefore needs a render pass of its own.
    """

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
        targets: object = None,
    ):
        super().__init__(name)
        self._pipeline, self._groups, self._descriptors = pipeline, groups, descriptors
        self._color, self._depth, self._targets = color, depth, targets
        self._vertices, self._instances = vertices, instances
        self._indirect, self._index, self._indices = indirect, index, indices
        self._indirect_offset = indirect_offset

    def timed(self, timestamps: dict[str, Any] | None) -> None:
        for descriptor in self._descriptors:
            descriptor.timestamps(timestamps)

    def _record_into(self, tape: Tape, parity: int) -> None:
        lib, ffi = bindings().lib, bindings().ffi
        descriptor = self._descriptors[parity % len(self._descriptors)]
        # The first pass that really runs clears: which one that is may change from frame to frame.
        for i, key in enumerate(self._color):
            descriptor.load_color(i, key in tape.written)
        if self._depth in self.writes:
            descriptor.load_depth(self._depth in tape.written)
        draw = tape.render(self, descriptor, self._targets)
        lib.wgpuRenderPassEncoderSetPipeline(draw, handle(self._pipeline))
        group = self._groups[parity % len(self._groups)]
        if group is not None:
            lib.wgpuRenderPassEncoderSetBindGroup(draw, 0, handle(group), 0, ffi.NULL)
        tape.calls += 3
        if self._index is not None:
            size = lib.WGPU_WHOLE_SIZE
            lib.wgpuRenderPassEncoderSetIndexBuffer(
                draw, handle(self._index), lib.WGPUIndexFormat_Uint32, 0, size
            )
            tape.calls += 1
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

    def _record_into(self, tape: Tape, parity: int) -> None:
        tape.close()
        context = self._contexts[parity]
        context.encoder = tape.encoder
        self._record(context)
        tape.calls += 1
