"""A frame graph ready to run: memory, pipelines, bind groups, and the playing back of a frame."""

from __future__ import annotations

import time
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from . import resources as res
from .errors import GraphError, translated
from .mips import MipMaker
from .native import RenderDescriptor
from .readback import Pending, Readback
from .resources import BufferDecl, Physical, TextureDecl, view_of
from .schedule import Ref, Schedule, alias, leading, makers
from .steps import Step, Tape
from .timing import Timing

if TYPE_CHECKING:
    from .graph import FrameGraph


class Compiled:
    """What `FrameGraph.compile` makes.

    Parameters
    ----------
    graph : FrameGraph
        The declarations.
    plan : Schedule
        Order and lifetimes.
    """

    def __init__(self, graph: FrameGraph, plan: Schedule):
        self.device = graph.device
        self.textures, self.buffers, self.uniforms = graph.textures, graph.buffers, graph.uniforms
        self.plan = plan
        self._outputs = graph.outputs
        self.physical: dict[str, Physical] = {}
        self._readback = Readback(self.device)
        self._targets: dict[object, object] = {}
        self._frame = 0
        self._ms = {"record": 0.0, "submit": 0.0}
        self._calls = 0
        self._allocate()
        self.timing = Timing(self.device, len(plan.passes))
        self._steps: list[Step] = [p.build(self) for p in plan.passes]
        for position, step in enumerate(self._steps):
            step.timed(self.timing.writes(position))
            step.writes = {(ref.name, ref.mip or 0) for ref in plan.passes[position].writes}
        self._when = [p.when for p in plan.passes]
        # What lasts is made before it is read for the first time, whatever its pass says of that frame.
        self._unmade = makers(plan, graph.outputs, graph.mips, self._lasts)
        self._ran = [False] * len(plan.passes)
        self._leading: dict[str, set[int]] = {}

    def _lasts(self, name: str) -> bool:
        decl = self.textures.get(name) or self.buffers.get(name)
        return decl is not None and decl.lifetime == "persistent"

    # ---- memory ----------------------------------------------------------------------------------------

    def _allocate(self) -> None:
        plan = self.plan
        used = set(plan.first)
        shared: dict[str, tuple[int, int]] = {}
        for name, decl in [*self.textures.items(), *self.buffers.items()]:
            if name not in used:
                continue
            if decl.lifetime == "transient":
                end = len(plan.passes) if name in self._outputs else plan.last[name]
                shared[name] = (plan.first[name], end)
            else:
                copies = 2 if decl.lifetime == "history" else 1
                self.physical[name] = Physical([self._make(decl) for _ in range(copies)])
        declared = {**self.textures, **self.buffers}
        slots = alias(shared, lambda n: declared[n].kind())
        by_slot: dict[int, list[str]] = {}
        for name, slot in slots.items():
            by_slot.setdefault(slot, []).append(name)
        for names in by_slot.values():
            first = declared[names[0]]
            for other in names[1:]:
                first.usage |= declared[other].usage
            made = self._make(first)
            for name in names:
                self.physical[name] = Physical([made])
        end = 0
        for uniform in self.uniforms.values():
            uniform.offset = end
            end += -(-uniform.struct.size // 256) * 256
        if end:
            usage = res.UNIFORM | res.STORAGE | res.COPY_DST  # storage: see Shaders
            self._uniform_buffer = self.device.buffer("uniforms", end, usage)
            self._uniform_bytes = bytearray(end)
            for name in self.uniforms:
                self.physical[name] = Physical([self._uniform_buffer])

    def _make(self, decl: TextureDecl | BufferDecl) -> Any:
        if isinstance(decl, BufferDecl):
            made = self.device.buffer(decl.name, decl.size, decl.usage)
            if decl.data:
                self.device.queue.write_buffer(made, 0, decl.data + b"\0" * (-len(decl.data) % 4))
            return made
        made = res.allocate_texture(self.device, decl)
        if decl.data is not None and decl.mips > 1:
            MipMaker.of(self.device).make(made, decl.format, decl.size, decl.mips, decl.dimension)
        return made

    def bind_groups(
        self, who: str, pipeline: Any, bindings: Mapping[str, Any], bind: Mapping[str, str]
    ) -> list[Any]:
        """The bind group of a pass, once, or twice if it touches a history."""
        if not bindings:
            return [None]
        if any(b.group != 0 for b in bindings.values()):
            raise GraphError(f"pass {who!r}: all bindings belong into group 0")
        layout = pipeline.get_bind_group_layout(0)
        refs = {v: Ref.parse(bind[v]) for v, b in bindings.items() if "sampler" not in b.kind}
        variants = 2 if any(len(self.physical[r.name].objects) == 2 for r in refs.values()) else 1
        groups = []
        for parity in range(variants):
            entries = []
            for variable, b in bindings.items():
                if "sampler" in b.kind:
                    resource: Any = self.device.sampler(bind[variable].removeprefix("sampler:"))
                else:
                    resource = self._bindable(refs[variable], b, parity)
                entries.append({"binding": b.binding, "resource": resource})
            with translated(f"binding the resources of {who}"):
                groups.append(self.device.native.create_bind_group(label=who, layout=layout, entries=entries))
        return groups

    def _bindable(self, ref: Ref, binding: Any, parity: int) -> Any:
        if ref.name in self.uniforms:
            uniform = self.uniforms[ref.name]
            buffer = self.physical[ref.name].at(0)
            return {"buffer": buffer, "offset": uniform.offset, "size": uniform.struct.size}
        physical = self.physical[ref.name]
        if ref.name in self.buffers:
            return {"buffer": physical.at(parity, ref.previous)}
        shape = "2d"
        for text, dimension in (("_3d", "3d"), ("_cube", "cube"), ("_2d_array", "2d-array")):
            if text in binding.type:
                shape = dimension
        return view_of(
            physical, self.textures[ref.name], ref, parity, shape, binding.kind == "storage_texture"
        )

    def attachments(
        self, who: str, color: list[Ref], depth: Ref | None, depth_write: bool
    ) -> list[RenderDescriptor]:
        """Render pass descriptors, one or two by parity; `RenderStep` sets their load operations."""

        def view(ref: Ref, parity: int) -> Any:
            return view_of(self.physical[ref.name], self.textures[ref.name], ref, parity, "2d", True)

        refs = [*color, *([depth] if depth else [])]
        variants = 2 if any(len(self.physical[r.name].objects) == 2 for r in refs) else 1
        descriptors = []
        for parity in range(variants):
            targets = [(view(ref, parity), self.textures[ref.name].clear) for ref in color]
            buffer = None
            if depth:
                buffer = (view(depth, parity), self.textures[depth.name].clear[0] if depth_write else None)
            descriptors.append(RenderDescriptor(who, targets, buffer))
        return descriptors

    def targets(self, color: list[Ref], depth: Ref | None, writes: list[Ref]) -> object:
        """One and the same object for all passes that may share a render pass; None for one that may not."""
        if any(ref not in color and ref != depth for ref in writes):
            return None
        key = (*color, None, depth, depth in writes)
        return self._targets.setdefault(key, key)

    # ---- running ---------------------------------------------------------------------------------------

    def execute(self, read: Iterable[str] = (), *, apart: bool = False) -> dict[str, Pending]:
        """Record and submit one frame; see `FrameGraph.execute`."""
        begin = time.perf_counter()
        with translated("rendering a frame"):
            calls = self._upload_uniforms()
            encoder = self.device.native.create_command_encoder(label="frame")
            parity = self._frame & 1
            self._ran = self._chosen()
            tape = self._record(encoder, self._ran, parity, apart)
            self.timing.resolve(encoder)
            pending = {name: self._copy_of(name, parity) for name in read}
            copies = self._readback.record(encoder, pending.values())
            commands = encoder.finish()
            recorded = time.perf_counter()
            self.device.queue.submit([commands])
            for copy in copies:
                copy.begin()
        self._ms = {"record": (recorded - begin) * 1e3, "submit": (time.perf_counter() - recorded) * 1e3}
        self._calls = calls + tape.calls + 4
        self._frame += 1
        for uniform in self.uniforms.values():
            uniform.changed = False
        return pending

    def make(self, name: str) -> None:
        """Run what leads to a resource, ahead of the next frame; see `FrameGraph.make`."""
        if name not in self._leading:
            self._leading[name] = leading(self.plan, name)
        with translated(f"making {name}"):
            self._upload_uniforms()
            encoder = self.device.native.create_command_encoder(label=name)
            self._record(encoder, self._chosen(self._leading[name]), self._frame & 1, False)
            self.device.queue.submit([encoder.finish()])

    def _record(self, encoder: Any, runs: list[bool], parity: int, apart: bool) -> Tape:
        tape = Tape(encoder, apart)
        for step, run in zip(self._steps, runs, strict=True):
            if not run:
                step.cpu_ms = 0.0
                continue
            started = time.perf_counter()
            step.record(tape, parity)
            step.cpu_ms = (time.perf_counter() - started) * 1e3
        tape.close()
        return tape

    def _chosen(self, among: set[int] | None = None) -> list[bool]:
        """Which passes run in this frame, of all or of those at these positions."""
        whens = enumerate(self._when)
        runs = [(among is None or i in among) and (when is None or bool(when())) for i, when in whens]
        # Readers come later, and may themselves have to run only because somebody reads them.
        for position, readers in reversed(self._unmade.items()):
            if among is None or position in among:
                runs[position] |= readers is None or any(runs[reader] for reader in readers)
        self._unmade = {p: readers for p, readers in self._unmade.items() if not runs[p]}
        return runs

    def _upload_uniforms(self) -> int:
        dirty = [u for u in self.uniforms.values() if u.changed]
        if not dirty:
            return 0
        for u in dirty:
            data = u.take()
            self._uniform_bytes[u.offset : u.offset + len(data)] = data
        low = min(u.offset for u in dirty)
        high = max(u.offset + u.struct.size for u in dirty)
        self.device.queue.write_buffer(self._uniform_buffer, low, bytes(self._uniform_bytes[low:high]))
        return 1

    def upload(self, name: str, data: np.ndarray) -> None:
        """Overwrite a texture or the start of a buffer, from the next frame on; see `FrameGraph.upload`."""
        if name in self.textures:
            self._overwrite(self.textures[name], data)
            return
        size = self.buffers[name].size
        if data.nbytes > size:
            raise GraphError(f"{data.nbytes:,} bytes do not fit into {name!r} of {size:,}")
        if name in self.physical and data.nbytes:
            with translated(f"writing {name}"):
                self.device.queue.write_buffer(self.physical[name].at(0), 0, np.ascontiguousarray(data))

    def _overwrite(self, decl: TextureDecl, data: np.ndarray) -> None:
        if decl.data is None or data.nbytes != decl.data.nbytes:
            raise GraphError(f"{data.nbytes:,} bytes do not fill {decl.name!r}")
        if decl.name in self.physical:
            with translated(f"writing {decl.name}"):
                res.upload_texture(self.device, self.physical[decl.name].at(0), data, decl.size)

    # ---- looking in ------------------------------------------------------------------------------------

    def read_async(self, name: str, mip: int = 0) -> Pending:
        """Start reading a resource as the last frame left it; see `Readback`."""
        return self._readback.now(self._copy_of(name, (self._frame - 1) & 1, mip))

    def _copy_of(self, name: str, parity: int, mip: int = 0) -> Pending:
        ref = Ref.parse(name)
        physical = self.physical.get(ref.name)
        if physical is None:
            raise GraphError(f"{name!r} is not part of the frame, so it cannot be read")
        source = physical.at(parity, ref.previous)
        if ref.name in self.textures:
            decl = self.textures[ref.name]
            w, h, d = decl.size
            depth = max(1, d >> mip) if decl.dimension == "3d" else d
            return self._readback.texture(
                source, decl.format, (max(1, w >> mip), max(1, h >> mip), depth), mip
            )
        return self._readback.buffer(source, self.buffers[ref.name].size)

    @property
    def histories(self) -> list[str]:
        """Names of the resources that remember the frame before."""
        return [name for name, p in self.physical.items() if len(p.objects) == 2]

    def restore(self, state: Mapping[str, np.ndarray]) -> None:
        """Make the next frame see these as its `@previous`."""
        with translated("restoring a history"):
            for name, value in state.items():
                if name not in self.physical or len(self.physical[name].objects) != 2:
                    raise GraphError(f"checkpoint has {name!r}, which is no history of this frame")
                target = self.physical[name].at(self._frame & 1, previous=True)
                if name in self.textures:
                    res.upload_texture(self.device, target, value, self.textures[name].size)
                else:
                    self.device.queue.write_buffer(target, 0, np.ascontiguousarray(value))

    def stats(self) -> dict[str, Any]:
        """Times of the last frame per pass, bytes of memory, WebGPU calls; waits for the GPU."""
        gpu = self.timing.milliseconds()
        passes, total = [], 0.0
        for i, step in enumerate(self._steps):
            ran, ms = self._ran[i], None
            if gpu is not None:
                ms = float(gpu[i]) if ran and step.is_timed else 0.0
                total += ms if step.opens else 0.0
                ms = None if ran and step.shares else ms
            passes.append({"name": step.name, "ran": ran, "gpu_ms": ms, "cpu_ms": step.cpu_ms})
        return {
            "adapter": str(self.device.adapter),
            "passes": passes,
            "culled": list(self.plan.culled),
            "gpu_ms": None if gpu is None else total,
            "cpu_ms": self._ms["record"] + self._ms["submit"],
            "record_ms": self._ms["record"],
            "submit_ms": self._ms["submit"],
            "calls": self._calls,
            "texture_bytes": self.device.texture_bytes,
            "buffer_bytes": self.device.buffer_bytes,
        }
