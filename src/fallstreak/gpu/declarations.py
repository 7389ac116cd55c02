"""What a frame graph's passes share: resources with names, and what a shader does with each."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from . import resources as res
from .errors import GraphError
from .formats import texel
from .mips import levels
from .resources import BufferDecl, TextureDecl, Uniform
from .schedule import Ref
from .struct import Struct

Size = tuple[int, int] | tuple[int, int, int]


class Declarations:
    """The named textures, buffers and uniforms of a frame graph."""

    def __init__(self):
        self.textures: dict[str, TextureDecl] = {}
        self.buffers: dict[str, BufferDecl] = {}
        self.uniforms: dict[str, Uniform] = {}
        self.sealed = False
        """No more may be declared: the graph is compiled."""

    def mips(self, name: str) -> int:
        """Levels of a resource, 1 for what is no texture."""
        return self.textures[name].mips if name in self.textures else 1

    def _declare(self, name: str) -> None:
        if name in self.textures or name in self.buffers or name in self.uniforms:
            raise GraphError(f"resource {name!r} is declared twice")
        if any(c in name for c in "@:"):
            raise GraphError(f"resource name {name!r} must not contain @ or :")
        if self.sealed:
            raise GraphError(f"resource {name!r} was declared after compile()")

    def texture(
        self,
        name: str,
        format: str,
        size: Size,
        *,
        dimension: str = "2d",
        mips: int = 1,
        clear: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0),
        persistent: bool = False,
        history: bool = False,
    ) -> str:
        """Declare a texture that passes write; returns its name.

        Parameters
        ----------
        size : (width, height) or (width, height, depth or layers)
        dimension : "2d", "2d-array" or "3d"
        clear : tuple of float
            What an attachment is cleared to by the frame's first pass that draws into it.
        persistent : bool
            Contents survive the frame; without it the memory is shared with other transients.
        history : bool
            Keep last frame's contents too, readable as "name@previous".
        """
        self._declare(name)
        w, h, d = (*size, 1)[:3]
        lifetime: res.Lifetime = "history" if history else "persistent" if persistent else "transient"
        self.textures[name] = TextureDecl(name, format, (w, h, d), dimension, mips, clear, lifetime)
        return name

    def texture_data(
        self, name: str, data: np.ndarray, format: str, *, dimension: str | None = None, mips: bool = False
    ) -> str:
        """Declare a texture whose contents Python gives, once or by `upload`.

        Parameters
        ----------
        data : ndarray
            (height, width[, components]) or (depth or layers, height, width[, components]).
        mips : bool
            Make the whole mip chain on the GPU; the format must be 8-bit unorm, 16- or 32-bit float.
        """
        self._declare(name)
        kind, count = texel(format)
        data = np.asarray(data, kind)
        shape = data.shape if count == 1 else data.shape[:-1]
        if (count > 1 and data.shape[-1] != count) or len(shape) not in (2, 3):
            raise GraphError(f"texture {name}: data of shape {data.shape} does not fit {format}")
        dimension = dimension or ("2d" if len(shape) == 2 else "2d-array")
        h, w = shape[-2:]
        d = shape[0] if len(shape) == 3 else 1
        count = levels((w, h, d), dimension) if mips else 1
        decl = TextureDecl(name, format, (w, h, d), dimension, count, (0, 0, 0, 0), "data", data)
        decl.usage |= res.TEXTURE_BINDING
        self.textures[name] = decl
        return name

    def buffer(
        self,
        name: str,
        nbytes: int,
        *,
        usage: Iterable[str] = (),
        persistent: bool = False,
        history: bool = False,
    ) -> str:
        """Declare a storage buffer; `usage` may add "indirect", "index", "vertex"."""
        self._declare(name)
        flags = res.STORAGE | res.COPY_SRC | res.COPY_DST | sum(res.BUFFER_USAGES[u] for u in usage)
        lifetime: res.Lifetime = "history" if history else "persistent" if persistent else "transient"
        self.buffers[name] = BufferDecl(name, nbytes, flags, lifetime)
        return name

    def buffer_data(self, name: str, data: np.ndarray | bytes, *, usage: Iterable[str] = ()) -> str:
        """Declare a storage buffer with fixed contents."""
        self._declare(name)
        raw = data if isinstance(data, bytes) else np.ascontiguousarray(data).tobytes()
        flags = res.STORAGE | res.COPY_SRC | res.COPY_DST | sum(res.BUFFER_USAGES[u] for u in usage)
        self.buffers[name] = BufferDecl(name, len(raw), flags, "data", raw)
        return name

    def uniform(self, name: str, struct: Struct) -> Uniform:
        """Declare a uniform; set its values with `.set(...)` before each `execute`."""
        self._declare(name)
        self.uniforms[name] = Uniform(name, struct)
        return self.uniforms[name]

    def _require(self, who: str, ref: Ref) -> None:
        if ref.name not in self.textures and ref.name not in self.buffers and ref.name not in self.uniforms:
            raise GraphError(f"pass {who!r} uses {ref.name!r}, which is not declared before it")
        decl = self.textures.get(ref.name) or self.buffers.get(ref.name)
        if ref.previous and (decl is None or decl.lifetime != "history"):
            raise GraphError(f"pass {who!r} reads {ref.name}@previous, but {ref.name} keeps no history")

    def _texture_decl(self, who: str, ref: Ref) -> TextureDecl:
        self._require(who, ref)
        if ref.name not in self.textures:
            raise GraphError(f"pass {who!r} draws into {ref.name!r}, which is no texture")
        return self.textures[ref.name]

    def _accesses(
        self, who: str, bindings: Mapping[str, Any], bind: Mapping[str, str]
    ) -> tuple[list[Ref], list[Ref]]:
        """What a pass reads and writes, by what its shader says of each binding."""
        reads: list[Ref] = []
        writes: list[Ref] = []
        for variable, binding in bindings.items():
            if variable not in bind:
                raise GraphError(f"pass {who!r} binds nothing to the shader's {variable!r}")
            target = bind[variable]
            if binding.kind in ("sampler", "comparison_sampler"):
                if not target.startswith("sampler:"):
                    raise GraphError(f"pass {who!r}: {variable!r} wants a sampler, not {target!r}")
                continue
            ref = Ref.parse(target)
            self._require(who, ref)
            if (ref.name in self.uniforms) != (binding.kind == "uniform"):
                raise GraphError(f"pass {who!r}: {variable!r} is a {binding.kind}, {target!r} is not")
            if ref.name in self.textures:
                storage = binding.kind == "storage_texture"
                self.textures[ref.name].usage |= res.STORAGE_BINDING if storage else res.TEXTURE_BINDING
            if binding.access in ("write", "read_write") and binding.kind in ("storage", "storage_texture"):
                if ref.previous:
                    raise GraphError(
                        f"pass {who!r} writes {target!r}; last frame's contents are only to be read"
                    )
                writes.append(ref)
                if binding.access == "read_write":
                    reads.append(ref)
            else:
                reads.append(ref)
        return reads, writes
