"""The G-buffer: four colour attachments of 28 bytes, and depth.

    add_gbuffer(graph, (width, height))       # once, before any system draws into it

Systems that draw surfaces import ``package::gpu::gbuffer`` and return ``encode_gbuffer(surface, motion)``
from a render pass with ``color=COLOR`` and ``depth=DEPTH``. The meaning of every channel is written in that
module.
"""

DEPTH = "gbuffer.depth"

#: attachment name -> (format, bytes it costs of the 32 that WebGPU grants per sample); the order is @location
ATTACHMENTS = {
    "gbuffer.albedo": ("rgba8unorm", 8),
    "gbuffer.normal": ("rgb10a2unorm", 8),
    "gbuffer.surface": ("rgba8unorm", 8),
    "gbuffer.motion": ("rg16float", 4),
}
COLOR = tuple(ATTACHMENTS)


def add_gbuffer(graph, size):
    """Declare the G-buffer of ``size`` = (width, height) pixels: all zero, depth 0 = infinitely far
    (reverse Z).
    """
    for name, (format, _) in ATTACHMENTS.items():
        graph.texture(name, format, size)
    graph.texture(DEPTH, "depth32float", size)
