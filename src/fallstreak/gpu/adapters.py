"""Which GPUs this machine has, which one we use, and what it lacks if none will do."""

from __future__ import annotations

import logging
import os
import sys
import tempfile
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from .errors import NoAdapterError
from .native import know_types

LIMITS: dict[str, int] = {
    "max-texture-dimension-1d": 8192,
    "max-texture-dimension-2d": 8192,
    "max-texture-dimension-3d": 2048,
    "max-texture-array-layers": 256,
    "max-bind-groups": 4,
    "max-bindings-per-bind-group": 1000,
    "max-dynamic-uniform-buffers-per-pipeline-layout": 8,
    "max-dynamic-storage-buffers-per-pipeline-layout": 4,
    "max-sampled-textures-per-shader-stage": 16,
    "max-samplers-per-shader-stage": 16,
    "max-storage-buffers-per-shader-stage": 8,
    "max-storage-textures-per-shader-stage": 4,
    "max-uniform-buffers-per-shader-stage": 12,
    "max-uniform-buffer-binding-size": 65536,
    "max-storage-buffer-binding-size": 134217728,
    "max-vertex-buffers": 8,
    "max-buffer-size": 268435456,
    "max-vertex-attributes": 16,
    "max-vertex-buffer-array-stride": 2048,
    "max-inter-stage-shader-variables": 16,
    "max-color-attachments": 8,
    "max-color-attachment-bytes-per-sample": 32,
    "max-compute-workgroup-storage-size": 16384,
    "max-compute-invocations-per-workgroup": 256,
    "max-compute-workgroup-size-x": 256,
    "max-compute-workgroup-size-y": 256,
    "max-compute-workgroup-size-z": 64,
    "max-compute-workgroups-per-dimension": 65535,
}
"""WebGPU's default limits (specification, 3.6.2): asked for, since wgpu hands out the adapter's maxima."""

CAPABILITIES = ("timestamp-query", "float32-filterable", "depth-clip-control")
"""Optional features that anything here may use, always with a fallback."""

_RANK = {"DiscreteGPU": 0, "IntegratedGPU": 1, "VirtualGPU": 2, "Unknown": 3, "CPU": 4}


@dataclass(frozen=True)
class AdapterInfo:
    """One adapter, and whether Fallstreak can run on it.

    Attributes
    ----------
    name, backend, kind, driver : str
        As the driver tells them; `kind` is "DiscreteGPU", "IntegratedGPU", "CPU" (software) or "Unknown".
    capabilities : tuple of str
        Those of `CAPABILITIES` it has.
    lacking : tuple of str
        WebGPU default limits it does not reach, each as a phrase; empty when usable.
    """

    name: str
    backend: str
    kind: str
    driver: str
    capabilities: tuple[str, ...]
    lacking: tuple[str, ...]
    native: Any

    @property
    def usable(self) -> bool:
        """Whether it reaches WebGPU's default limits."""
        return not self.lacking

    def __str__(self) -> str:
        return f"{self.name} ({self.backend}, {self.kind}, {self.driver})"


def _describe(native: Any) -> AdapterInfo:
    info = native.info
    lacking = tuple(
        f"{name} is {native.limits[name]}, {limit} needed"
        for name, limit in LIMITS.items()
        if name in native.limits and native.limits[name] < limit
    )
    return AdapterInfo(
        name=info["device"] or info["description"] or "unnamed adapter",
        backend=info["backend_type"],
        kind=info["adapter_type"],
        driver=info["description"] or info["vendor"],
        capabilities=tuple(c for c in CAPABILITIES if c in native.features),
        lacking=lacking,
        native=native,
    )


@lru_cache(maxsize=1)
def adapters() -> tuple[AdapterInfo, ...]:
    """Every adapter of this machine, best first: usable before not, hardware before software."""
    # Mesa complains on stderr for each adapter when this is unset, as it is in containers and services.
    if sys.platform.startswith("linux") and not os.environ.get("XDG_RUNTIME_DIR"):
        os.environ["XDG_RUNTIME_DIR"] = tempfile.gettempdir()
    import wgpu
    import wgpu.backends.wgpu_native as native
    from wgpu.backends.wgpu_native.extras import set_instance_extras

    assert native
    know_types()
    # A lost device is told by `DeviceLostError`; wgpu's own shout about it would only frighten.
    logging.getLogger("wgpu").addFilter(lambda record: "lost" not in record.getMessage().lower())
    # OpenGL adapters do not reach WebGPU's limits, and looking for them takes most of the start-up time.
    set_instance_extras(backends=["Primary"])
    found = [_describe(a) for a in wgpu.gpu.enumerate_adapters_sync()]
    return tuple(sorted(found, key=lambda a: (not a.usable, _RANK.get(a.kind, 3))))


def choose(wanted: str | None = None) -> tuple[AdapterInfo, str]:
    """The adapter to use, and why, as a phrase.

    Parameters
    ----------
    wanted : str, optional
        Part of a name; without it the environment's FALLSTREAK_ADAPTER, else the best one.

    Raises
    ------
    NoAdapterError
        With the command that would install a software adapter.
    """
    source = "asked for by name"
    if wanted is None and (wanted := os.environ.get("FALLSTREAK_ADAPTER") or None):
        source = "named by FALLSTREAK_ADAPTER"
    everything = adapters()
    usable = [a for a in everything if a.usable]
    if wanted is not None:
        for adapter in usable:
            if wanted.lower() in str(adapter).lower():
                return adapter, source
        names = "; ".join(str(a) for a in usable) or "none"
        raise NoAdapterError(
            f"no usable GPU adapter is called {wanted!r} ({source}); this machine has: {names}"
        )
    if not usable:
        raise NoAdapterError(f"no GPU adapter reaches WebGPU's default limits here; {remedy()}")
    best = usable[0]
    why = (
        "the only usable adapter"
        if len(usable) == 1
        else f"the best of {len(usable)}: hardware before software"
    )
    return best, why


def remedy() -> str:
    """What to do on a machine without an adapter."""
    if sys.platform.startswith("linux"):
        return (
            "install a software one with: sudo apt-get install -y mesa-vulkan-drivers libvulkan1 "
            "(Debian, Ubuntu), or your GPU's Vulkan driver"
        )
    return "install or update your graphics driver"
