"""What can go wrong between us and the GPU, as exceptions of our own.

Nothing above this room ever sees a wgpu exception: `translated` turns each into one of these, and a lost
device into `DeviceLostError`, which the renderer answers by rebuilding everything.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager


class GpuError(RuntimeError):
    """Something the GPU layer could not do; the message is one sentence."""


class NoAdapterError(GpuError):
    """No usable adapter on this machine; the message tells how to get one."""


class DeviceLostError(GpuError):
    """The GPU went away (driver reset, `destroy`); all of its memory is gone."""


class ShaderError(GpuError):
    """A shader does not link or validate; the message names the .wesl file and line."""


class GraphError(GpuError):
    """A frame graph that contradicts itself: unknown names, cycles, unfit bindings."""


@contextmanager
def translated(what: str) -> Iterator[None]:
    """Turn wgpu's exceptions inside the block into ours; `what` says what was being done."""
    import wgpu

    try:
        yield
    except wgpu.GPUError as error:
        raise translate(error, what) from error
    except RuntimeError as error:
        if isinstance(error, GpuError):
            raise
        raise translate(error, what) from error


def translate(error: Exception, what: str) -> GpuError:
    """One of our exceptions for one of wgpu's.

    wgpu 0.32 has no exception of its own for a lost device: it can only be told by its words, which differ
    by the call that noticed it.
    """
    text = str(error)
    lowered = text.lower()
    if (
        "device is lost" in lowered
        or "device lost" in lowered
        or ("destroyed" in lowered and "device" in lowered)
    ):
        return DeviceLostError(f"the GPU device was lost while {what}")
    if "out of memory" in lowered or "out-of-memory" in lowered:
        return GpuError(f"the GPU is out of memory while {what}")
    return GpuError(f"the GPU refused while {what}: {text.strip()}")
