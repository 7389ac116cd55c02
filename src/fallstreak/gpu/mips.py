"""Mip chains: each level drawn from the one above by a linear sampler, which averages 2 x 2 texels."""

from __future__ import annotations

import itertools
from typing import Any, ClassVar
from weakref import WeakKeyDictionary

from .device import Device
from .errors import translated


class MipMaker:
    """Makes mip chains on one device; pipelines are kept per format."""

    _makers: ClassVar[WeakKeyDictionary[Device, MipMaker]] = WeakKeyDictionary()

    def __init__(self, device: Device):
        # The maker is stored under its device, so it must not hold the device itself.
        self._native, self._queue = device.native, device.queue
        self._sampler = device.sampler("linear-clamp")
        self._fragment, _ = device.shaders.get("package::gpu::mips", ["fragment_main"])
        self._vertex, _ = device.shaders.get("package::gpu::fullscreen", ["vertex_main"])
        self._pipelines: dict[str, Any] = {}

    @classmethod
    def of(cls, device: Device) -> MipMaker:
        """The device's maker."""
        if device not in cls._makers:
            cls._makers[device] = cls(device)
        return cls._makers[device]

    def make(self, texture: Any, fmt: str, size: tuple[int, int, int], mips: int) -> None:
        """Fill levels 1 and up of every layer of a 2-D (array) texture."""
        with translated("making mips"):
            if fmt not in self._pipelines:
                self._pipelines[fmt] = self._native.create_render_pipeline(
                    label=f"mips {fmt}",
                    layout="auto",
                    vertex={"module": self._vertex, "entry_point": "vertex_main", "buffers": []},
                    primitive={"topology": "triangle-list"},
                    fragment={
                        "module": self._fragment,
                        "entry_point": "fragment_main",
                        "targets": [{"format": fmt}],
                    },
                )
            pipeline = self._pipelines[fmt]
            layout = pipeline.get_bind_group_layout(0)
            encoder = self._native.create_command_encoder(label="mips")
            for layer in range(size[2]):
                views = [
                    texture.create_view(
                        dimension="2d",
                        base_mip_level=level,
                        mip_level_count=1,
                        base_array_layer=layer,
                        array_layer_count=1,
                    )
                    for level in range(mips)
                ]
                for above, level in itertools.pairwise(views):
                    group = self._native.create_bind_group(
                        layout=layout,
                        entries=[
                            {"binding": 0, "resource": above},
                            {"binding": 1, "resource": self._sampler},
                        ],
                    )
                    draw = encoder.begin_render_pass(
                        color_attachments=[{"view": level, "load_op": "clear", "store_op": "store"}]
                    )
                    draw.set_pipeline(pipeline)
                    draw.set_bind_group(0, group)
                    draw.draw(3)
                    draw.end()
            self._queue.submit([encoder.finish()])
