"""The device: limits, capabilities, resources with their bytes counted, pipelines by name.

Everything made here is counted, so that `texture_bytes` and `buffer_bytes` are what the GPU holds.
"""

from __future__ import annotations

import weakref
from typing import Any

from .adapters import CAPABILITIES, LIMITS, AdapterInfo, choose
from .errors import GpuError, translated
from .formats import texel_bytes
from .pipelines import Pipelines
from .shader import Shaders

_SAMPLERS = {
    "linear-clamp": ("linear", "clamp-to-edge", "clamp-to-edge"),
    "linear-repeat": ("linear", "repeat", "repeat"),
    "nearest-clamp": ("nearest", "clamp-to-edge", "clamp-to-edge"),
    "linear-repeat-clamp": ("linear", "repeat", "clamp-to-edge"),
}


class Device:
    """A GPU device at WebGPU's default limits.

    Attributes
    ----------
    adapter : AdapterInfo
        What it runs on.
    why : str
        Why this adapter was chosen.
    capabilities : frozenset of str
        Optional features in use ("timestamp-query", "float32-filterable", "depth-clip-control").
    limits : dict
        The limits that were asked for.
    """

    def __init__(self, native: Any, adapter: AdapterInfo, why: str):
        self.native = native
        self.queue = native.queue
        self.adapter = adapter
        self.why = why
        self.limits = dict(LIMITS)
        self.capabilities = frozenset(c for c in CAPABILITIES if c in native.features)
        self.pipelines = Pipelines(native)
        self.shaders = Shaders(native, software=adapter.kind == "CPU")
        self.texture_bytes = 0
        self.buffer_bytes = 0
        self._samplers: dict[str, Any] = {}

    @classmethod
    def open(cls, adapter: str | None = None, *, capabilities: tuple[str, ...] = CAPABILITIES) -> Device:
        """Open the best adapter, or the one whose name contains `adapter`.

        Parameters
        ----------
        adapter : str, optional
            Part of an adapter's name; default the environment's FALLSTREAK_ADAPTER, else the best there is.
        capabilities : tuple of str
            Optional features to use where the adapter has them; fewer for testing the fallbacks.

        Raises
        ------
        NoAdapterError
            When there is none; the message tells how to install one.
        """
        info, why = choose(adapter)
        wanted = [c for c in capabilities if c in info.capabilities]
        with translated("opening the device"):
            native = info.native.request_device_sync(
                required_features=wanted, required_limits=_limits(info.kind == "CPU")
            )
        return cls(native, info, why)

    def destroy(self) -> None:
        """Give the GPU's memory back at once; using the device afterwards raises `DeviceLostError`."""
        self.native.destroy()

    def sampler(self, name: str) -> Any:
        """One of the shared samplers, by its name in `_SAMPLERS`."""
        if name not in self._samplers:
            if name not in _SAMPLERS:
                raise GpuError(f"sampler {name!r} is unknown; there are {', '.join(_SAMPLERS)}")
            how, u, v = _SAMPLERS[name]
            self._samplers[name] = self.native.create_sampler(
                mag_filter=how,
                min_filter=how,
                mipmap_filter=how,
                address_mode_u=u,
                address_mode_v=v,
                address_mode_w=v,
            )
        return self._samplers[name]

    def buffer(self, label: str, size: int, usage: int) -> Any:
        """A zeroed buffer of `size` bytes (rounded up to 4)."""
        size = max(16, -(-size // 4) * 4)
        if size > self.limits["max-buffer-size"]:
            raise GpuError(
                f"buffer {label} of {size} bytes exceeds WebGPU's {self.limits['max-buffer-size']}"
            )
        with translated(f"making buffer {label}"):
            made = self.native.create_buffer(label=label, size=size, usage=usage)
        self._count("buffer_bytes", made, size)
        return made

    def texture(
        self,
        label: str,
        fmt: str,
        size: tuple[int, int, int],
        usage: int,
        *,
        dimension: str = "2d",
        mips: int = 1,
    ) -> Any:
        """A texture; `size` is (width, height, depth or layers)."""
        limit = self.limits["max-texture-dimension-3d" if dimension == "3d" else "max-texture-dimension-2d"]
        if min(size) < 1 or max(size[:2]) > limit:
            raise GpuError(f"texture {label} of {size} is outside WebGPU's 1 to {limit}")
        with translated(f"making texture {label}"):
            made = self.native.create_texture(
                label=label,
                size=size,
                format=fmt,
                usage=usage,
                dimension="3d" if dimension == "3d" else "2d",
                mip_level_count=mips,
            )
        texels = 0
        w, h, d = size
        for level in range(mips):
            depth = max(1, d >> level) if dimension == "3d" else d
            texels += max(1, w >> level) * max(1, h >> level) * depth
        self._count("texture_bytes", made, texels * texel_bytes(fmt))
        return made

    def _count(self, counter: str, resource: Any, size: int) -> None:
        setattr(self, counter, getattr(self, counter) + size)
        weakref.finalize(resource, _forget, weakref.ref(self), counter, size)


def _forget(device: weakref.ref[Device], counter: str, size: int) -> None:
    if (alive := device()) is not None:
        setattr(alive, counter, getattr(alive, counter) - size)


def _limits(software: bool) -> dict[str, int]:
    """What is asked for; to a software adapter uniforms are storage buffers, too (shader.py)."""
    storage, uniform = ("max-storage-buffers-per-shader-stage", "max-uniform-buffers-per-shader-stage")
    return {**LIMITS, storage: LIMITS[storage] + LIMITS[uniform]} if software else dict(LIMITS)
