"""The GPU: the only room that imports wgpu.

Device at WebGPU's default limits, frame graph, WESL shaders, structs that Python and WGSL share, read-back,
timing, errors. Everything above meets the GPU through the names below.
"""

from __future__ import annotations

from .adapters import CAPABILITIES, LIMITS, AdapterInfo, adapters, choose, remedy
from .device import Device
from .errors import DeviceLostError, GpuError, GraphError, NoAdapterError, ShaderError
from .exposure import EXPOSURE
from .graph import FrameGraph
from .readback import Pending
from .resources import Uniform
from .steps import Context
from .struct import Struct
from .view import VIEW

__all__ = [
    "CAPABILITIES",
    "EXPOSURE",
    "LIMITS",
    "VIEW",
    "AdapterInfo",
    "Context",
    "Device",
    "DeviceLostError",
    "FrameGraph",
    "GpuError",
    "GraphError",
    "NoAdapterError",
    "Pending",
    "ShaderError",
    "Struct",
    "Uniform",
    "adapters",
    "choose",
    "remedy",
]
