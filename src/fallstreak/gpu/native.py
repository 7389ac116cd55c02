"""The C calls that play back a frame, without wgpu-py's checks in between.

Recording one render pass through wgpu-py's public methods takes three times as long: each call builds C
structs anew and looks for errors. A frame records the same passes again and again, so we build their
descriptors once and make the plain calls of webgpu.h. wgpu collects what goes wrong while recording and
tells it when the encoder is finished, which goes through the public method and raises as ever.

This is the only file that knows wgpu-py's insides (`_internal`, `ffi`, `lib`); pyproject.toml pins its
version.
"""

from __future__ import annotations

from functools import lru_cache
from types import SimpleNamespace
from typing import Any


@lru_cache(maxsize=1)
def bindings() -> SimpleNamespace:
    """`ffi` and `lib` of wgpu-native; loaded when the first graph is compiled."""
    from wgpu.backends.wgpu_native._ffi import ffi, lib

    return SimpleNamespace(ffi=ffi, lib=lib)


def know_types() -> None:
    """Let cffi know every type of webgpu.h at once, before wgpu-py asks for them one by one.

    cffi reads all 400 typedefs of the header anew for each type that it is asked for by name, and wgpu-py
    asks for some sixty before the first picture: two seconds. A struct with a member of every type is read
    once, and its members are put where cffi keeps what it has read. Without such a place nothing is lost.
    """
    ffi = bindings().ffi
    known = getattr(ffi, "_parsed_types", None)
    make_array = getattr(getattr(ffi, "_backend", None), "new_array_type", None)
    if not isinstance(known, dict) or make_array is None:
        return
    names = [n for n in ffi.list_types()[0] if not n.startswith("WGPUProc") and not n.endswith("Callback")]
    names += ["char", "uint8_t", "uint32_t", "int32_t", "float", "uintptr_t", "intptr_t"]
    every = ffi.typeof("struct {" + "".join(f"{n} *m{i};" for i, n in enumerate(names)) + "}")
    for name, (_, member) in zip(names, every.fields, strict=True):
        pointer, array = (member.type, False), (make_array(member.type, None), False)
        known.setdefault(name, (member.type.item, False))
        for text, kind in (("*", pointer), (" *", pointer), (" * ", pointer), ("[]", array), (" []", array)):
            known.setdefault(name + text, kind)


def handle(wrapped: Any) -> Any:
    """The C handle behind an object of wgpu-py."""
    return wrapped._internal


class Descriptor:
    """A pass descriptor in C memory, with everything it points to."""

    def __init__(self, kind: str, label: str):
        self.ffi = bindings().ffi
        self.c = self.ffi.new(f"{kind} *")
        self._alive: list[Any] = []
        text = label.encode()
        self.c.label.data = self.keep(self.ffi.new("char[]", text))
        self.c.label.length = len(text)

    def keep(self, memory: Any) -> Any:
        """Hold C memory as long as the descriptor."""
        self._alive.append(memory)
        return memory

    def timestamps(self, writes: dict[str, Any] | None) -> None:
        """Where the pass writes its times."""
        if writes is None:
            return
        stamps = self.keep(self.ffi.new("WGPUPassTimestampWrites *"))
        stamps.querySet = handle(writes["query_set"])
        stamps.beginningOfPassWriteIndex = writes["beginning_of_pass_write_index"]
        stamps.endOfPassWriteIndex = writes["end_of_pass_write_index"]
        self.c.timestampWrites = stamps


def compute_descriptor(label: str) -> Descriptor:
    """Of a compute pass."""
    return Descriptor("WGPUComputePassDescriptor", label)


class RenderDescriptor(Descriptor):
    """Of a render pass; load operations may change from frame to frame.

    Parameters
    ----------
    color : list of (view, clear value)
    depth : (view, clear value or None), optional
        None for a depth that is only read.
    """

    def __init__(self, label: str, color: list[tuple[Any, Any]], depth: tuple[Any, float | None] | None):
        super().__init__("WGPURenderPassDescriptor", label)
        lib = bindings().lib
        self._load, self._clear = lib.WGPULoadOp_Load, lib.WGPULoadOp_Clear
        self.color = self.keep(self.ffi.new("WGPURenderPassColorAttachment[]", len(color)))
        for attachment, (view, clear) in zip(self.color, color, strict=True):
            self.keep(view)
            attachment.view = handle(view)
            attachment.depthSlice = lib.WGPU_DEPTH_SLICE_UNDEFINED
            attachment.storeOp = lib.WGPUStoreOp_Store
            attachment.clearValue.r, attachment.clearValue.g = clear[0], clear[1]
            attachment.clearValue.b, attachment.clearValue.a = clear[2], clear[3]
        self.c.colorAttachmentCount = len(color)
        self.c.colorAttachments = self.color
        if depth is not None:
            view, clear = depth
            self.keep(view)
            self.depth = self.keep(self.ffi.new("WGPURenderPassDepthStencilAttachment *"))
            self.depth.view = handle(view)
            self.depth.depthReadOnly = clear is None
            if clear is not None:
                self.depth.depthStoreOp = lib.WGPUStoreOp_Store
                self.depth.depthClearValue = clear
            self.c.depthStencilAttachment = self.depth

    def load_color(self, index: int, load: bool) -> None:
        """Keep what an attachment holds, or clear it."""
        self.color[index].loadOp = self._load if load else self._clear

    def load_depth(self, load: bool) -> None:
        """The same for the depth, where it is written."""
        self.depth.depthLoadOp = self._load if load else self._clear
