"""The frame graph: passes with declared reads and writes, over resources with names.

Systems declare what they make and what they need and never meet each other; the graph finds the order, drops
what nobody reads, lets transient textures share memory, keeps histories, times every pass. After `compile`,
a frame costs Python a few calls a pass and makes no objects of its own but the encoder.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from . import resources as res
from .compiled import Compiled
from .declarations import Declarations
from .device import Device
from .errors import GraphError
from .pipelines import ComputeSpec, RenderSpec
from .readback import Pending
from .schedule import PassDecl, Ref, Schedule, schedule
from .steps import ComputeStep, Context, CustomStep, RenderStep, Step
from .struct import Struct

Groups = tuple[int, int, int] | Callable[[], tuple[int, int, int]] | str


class FrameGraph(Declarations):
    """A frame as a graph of passes.

    Parameters
    ----------
    device : Device
        Where it will run.

    Examples
    --------
    >>> graph = FrameGraph(device)                                              # doctest: +SKIP
    >>> graph.texture("sky.transmittance", "rgba16float", (256, 64), persistent=True)   # doctest: +SKIP
    >>> graph.compute("sky.transmittance", "package::sky::transmittance",               # doctest: +SKIP
    ...               bind={"air": "sky.air", "output": "sky.transmittance"}, groups=(32, 8, 1))
    """

    def __init__(self, device: Device):
        super().__init__()
        self.device = device
        self._passes: list[PassDecl] = []
        self.outputs: list[str] = []
        self._compiled: Compiled | None = None
        self.pass_times = False
        """Record every pass on its own, so that `stats` knows the time of each; else passes that can, share
        one of the GPU's, which is a little cheaper. Pictures are the same."""
        self.shader_requests: list[dict[str, Any]] = []
        """Every (module, entries, flags, constants, structs) asked for; tests validate each."""

    def output(self, *names: str) -> None:
        """Say that somebody outside reads these; everything that leads to them is kept."""
        self.outputs.extend(names)

    # ---- passes ----------------------------------------------------------------------------------------

    def compute(
        self,
        name: str,
        shader: str,
        *,
        bind: Mapping[str, str],
        groups: Groups,
        entry: str = "main",
        flags: Mapping[str, bool] | None = None,
        constants: Mapping[str, Any] | None = None,
        structs: Sequence[Struct] = (),
        when: Callable[[], bool] | None = None,
        order: float = 0.0,
    ) -> None:
        """Add a compute pass.

        Parameters
        ----------
        bind : mapping
            Shader variable -> resource name or "sampler:…"; the shader says whether it reads or writes.
        groups : tuple, callable or str
            Workgroups; a callable is asked every frame; a string names an indirect buffer.
        when : callable, optional
            Asked every frame; False skips the pass. What alone makes a persistent resource runs all the same
            before anybody reads that for the first time; of passes that take turns to make one, one must say
            yes.
        """
        native, linked = self._shader(shader, [entry], flags, constants, structs)
        reads, writes = self._accesses(name, linked.bindings, bind)
        if isinstance(groups, str):
            reads.append(Ref.parse(groups))

        spec = ComputeSpec(name, native, entry)

        def build(made: Compiled) -> Step:
            pipeline = made.device.pipelines.of(spec)
            indirect = None
            fixed = groups
            if isinstance(groups, str):
                indirect, fixed = made.physical[groups].at(0), None
            return ComputeStep(
                name, pipeline, made.bind_groups(name, pipeline, linked.bindings, bind), fixed, indirect
            )

        self._add(PassDecl(name, reads, writes, build, order, when, spec))

    def render(
        self,
        name: str,
        shader: str,
        *,
        color: Sequence[str] = (),
        depth: str | None = None,
        bind: Mapping[str, str] | None = None,
        vertex: str = "vertex_main",
        fragment: str | None = "fragment_main",
        vertex_module: str | None = None,
        depth_compare: str = "greater",
        depth_write: bool = True,
        depth_in_turn: bool = False,
        in_turn: Sequence[str] = (),
        blend: str | None = None,
        topology: str = "triangle-list",
        cull: str = "none",
        vertices: int | Callable[[], int] = 3,
        instances: int | Callable[[], int] = 1,
        indirect: str | None = None,
        indirect_offset: int = 0,
        index: str | None = None,
        indices: int = 0,
        flags: Mapping[str, bool] | None = None,
        constants: Mapping[str, Any] | None = None,
        structs: Sequence[Struct] = (),
        when: Callable[[], bool] | None = None,
        order: float = 0.0,
    ) -> None:
        """Add a render pass of one draw.

        Parameters
        ----------
        color, depth : names
            Attachments. The first pass of a frame that writes one clears it, later ones load.
        depth_write : bool
            Without it the depth is only tested, and may be bound as a texture at the same time.
        depth_in_turn : bool
            A depth that is only tested is tested in this pass's turn among those that write it, not after all
            of them, and may not be bound.
        in_turn : names
            What of these is bound is what those made that come before this pass among the writers; else a
            pass reads what all of them made.
        blend : None, "add", "over" or "under" (premultiplied alpha, far to near or near to far), "multiply"
        indirect : str, optional
            Buffer with the draw's arguments from byte `indirect_offset` on; with `index` of an indexed draw.
        index, indices
            Index buffer (uint32) and, without `indirect`, number of indices.
        vertex_module : str, optional
            Module of the vertex stage when it is not `shader`; it must bind nothing.
        """
        bind = dict(bind or {})
        entries = ([] if vertex_module else [vertex]) + ([fragment] if fragment else [])
        native, linked = self._shader(shader, entries, flags, constants, structs)
        vertex_native = native
        if vertex_module:
            vertex_native, _ = self._shader(vertex_module, [vertex], None, None, ())
        reads, writes = self._accesses(name, linked.bindings, bind)
        color_refs = [Ref.parse(c) for c in color]
        writes.extend(color_refs)
        writes.extend(Ref.parse(text) for text in in_turn)
        depth_ref = Ref.parse(depth) if depth else None
        for ref in [*color_refs, *([depth_ref] if depth_ref else [])]:
            self._texture_decl(name, ref).usage |= res.RENDER_ATTACHMENT
        among_writers = depth_write or depth_in_turn
        if depth_ref:
            (writes if among_writers else reads).append(depth_ref)
        for extra in (indirect, index):
            if extra:
                reads.append(Ref.parse(extra))

        spec = RenderSpec(
            name=name,
            native=native,
            vertex_native=vertex_native,
            vertex=vertex,
            fragment=fragment,
            color_formats=tuple(self.textures[r.name].format for r in color_refs),
            depth_format=self.textures[depth_ref.name].format if depth_ref else None,
            depth_compare=depth_compare,
            depth_write=depth_write,
            blend=blend,
            topology=topology,
            cull=cull,
        )

        def build(made: Compiled) -> Step:
            pipeline = made.device.pipelines.of(spec)
            return RenderStep(
                name,
                pipeline,
                made.bind_groups(name, pipeline, linked.bindings, bind),
                made.attachments(name, color_refs, depth_ref, among_writers),
                [(r.name, r.mip or 0) for r in color_refs],
                (depth_ref.name, depth_ref.mip or 0) if depth_ref else None,
                vertices,
                instances,
                made.physical[indirect].at(0) if indirect else None,
                made.physical[index].at(0) if index else None,
                indices,
                indirect_offset,
                made.targets(color_refs, depth_ref, writes),
            )

        self._add(PassDecl(name, reads, writes, build, order, when, spec))

    def fullscreen(self, name: str, shader: str, *, color: Sequence[str], **options: Any) -> None:
        """Add a pass that draws one triangle over the picture at depth 0; options as for `render`."""
        options.setdefault("depth_write", False)
        self.render(name, shader, color=color, vertex_module="package::gpu::fullscreen", **options)

    def add_pass(
        self,
        name: str,
        *,
        reads: Sequence[str] = (),
        writes: Sequence[str] = (),
        record: Callable[[Context], None],
        when: Callable[[], bool] | None = None,
        order: float = 0.0,
    ) -> None:
        """Add a pass that records its own commands; the general form of the others.

        `record` gets a `Context` with the command encoder and the physical resources.
        """
        for text in (*reads, *writes):
            self._require(name, Ref.parse(text))

        def build(made: Compiled) -> Step:
            return CustomStep(name, record, lambda parity: Context(made, parity))

        self._add(
            PassDecl(name, [Ref.parse(r) for r in reads], [Ref.parse(w) for w in writes], build, order, when)
        )

    def clear(self, name: str, *, order: float = -1.0) -> None:
        """Zero a buffer at the start of its life in each frame."""
        self.add_pass(
            f"{name}.clear",
            writes=[name],
            record=lambda ctx: ctx.encoder.clear_buffer(ctx.resource(name)),
            order=order,
        )

    def _add(self, declared: PassDecl) -> None:
        if self.sealed:
            raise GraphError(f"pass {declared.name!r} was added after compile()")
        if any(p.name == declared.name for p in self._passes):
            raise GraphError(f"pass {declared.name!r} is declared twice")
        self._passes.append(declared)
        if declared.pipeline is not None:
            self.device.pipelines.start(declared.pipeline)

    def _shader(
        self, module: str, entries: list[str], flags: Any, constants: Any, structs: Sequence[Struct]
    ) -> Any:
        request = {"module": module, "entries": tuple(entries), "flags": dict(flags or {})}
        self.shader_requests.append(request)
        return self.device.shaders.get(module, entries, flags=flags, constants=constants, structs=structs)

    # ---- compiling and running -------------------------------------------------------------------------

    def compile(self) -> None:
        """Find the order, allocate memory, make pipelines and bind groups.

        Raises
        ------
        GraphError
            For circles, outputs nobody writes, transient resources written only sometimes or never.
        """

        plan = schedule(self._passes, self.outputs, self.mips)
        self._validate(plan)
        self._compiled = Compiled(self, plan)
        self.device.pipelines.rest()
        self.sealed = True

    def _validate(self, plan: Schedule) -> None:
        written = {ref.name for p in plan.passes for ref in p.writes}
        for name in self.outputs:
            if name not in written:
                raise GraphError(f"output {name!r} is written by no pass")
        for p in plan.passes:
            for ref in p.reads:
                decl = self.textures.get(ref.name) or self.buffers.get(ref.name)
                if decl is not None and decl.lifetime != "data" and ref.name not in written:
                    raise GraphError(f"pass {p.name!r} reads {ref.name!r}, which no pass writes")
            if p.when is not None:
                self._check_sometimes(plan, p)

    def _check_sometimes(self, plan: Schedule, p: PassDecl) -> None:
        """A pass that is skipped in some frames may share its resource with others, or keep what it made."""
        for ref in p.writes:
            decl = self.textures.get(ref.name) or self.buffers.get(ref.name)
            alone = all(q is p for q in plan.passes for r in q.writes if r.name == ref.name)
            if decl is not None and decl.lifetime != "persistent" and alone:
                raise GraphError(f"pass {p.name!r} runs only sometimes: declare {ref.name!r} persistent")

    @property
    def compiled(self) -> Compiled:
        """The graph ready to run.

        Raises
        ------
        GraphError
            Before `compile`.
        """
        if self._compiled is None:
            raise GraphError("the frame graph must be compiled first")
        return self._compiled

    def execute(self, read: Iterable[str] = ()) -> dict[str, Pending]:
        """Record and submit one frame.

        Parameters
        ----------
        read : iterable of str
            Resources to bring back as this frame leaves them, without waiting.

        Returns
        -------
        dict
            Name -> `Pending`, whose `.result()` waits.

        Raises
        ------
        DeviceLostError
            When the GPU has gone away; nothing of the graph can be used afterwards.
        """
        return self.compiled.execute(read, apart=self.pass_times)

    def make(self, name: str) -> None:
        """Run what leads to a resource once more, ahead of the next frame and with the uniforms as they are.

        For what a frame makes several of, one after the other by the same passes: all but the last are made
        so, the last one by the frame itself.

        Parameters
        ----------
        name : str
            A persistent resource.
        """
        self.compiled.make(name)

    def upload(self, name: str, data: np.ndarray) -> None:
        """Overwrite a `texture_data`, or the start of a `buffer_data`, from the next frame on."""
        self.compiled.upload(name, data)

    def read_async(self, name: str, mip: int = 0) -> Pending:
        """Start reading a resource as the last frame left it; `.result()` waits for it."""
        return self.compiled.read_async(name, mip)

    def read(self, name: str, mip: int = 0) -> np.ndarray:
        """Read a resource and wait for it. Transients other than outputs may have been overwritten."""
        return self.compiled.read_async(name, mip).result()

    @property
    def histories(self) -> list[str]:
        """Names of the resources that remember the frame before: what `restore` needs."""
        return self.compiled.histories

    def checkpoint(self) -> dict[str, np.ndarray]:
        """All histories as the last frame left them, for `restore`."""
        return {name: self.read(name) for name in self.histories}

    def restore(self, state: Mapping[str, np.ndarray]) -> None:
        """Make the next frame see these as its `@previous`."""
        self.compiled.restore(state)

    def stats(self) -> dict[str, Any]:
        """Times of the last frame per pass, bytes of memory, WebGPU calls; waits for the GPU.

        Without `pass_times`, `gpu_ms` of passes that were recorded together is None; the frame's is whole.
        """
        return self.compiled.stats()
