"""How much light the film takes: a metered, adapting exposure or a fixed one.

    add_exposure_buffer(graph)                          # first: every pass that writes light reads it
    exposure = Exposure(graph, world.film, size)        # the two passes that fill it
    graph.compile()
    exposure.begin(sun_elevation)                       # once, after compile: what the first frame starts
    from exposure.update(delta=seconds, instant=still)       # each frame, before execute

The meter counts log2 luminance of ``frame.resolved`` into a histogram (integers, so every run counts the
same), weights the centre, leaves out the darkest and the brightest share, and exposes the mean to a key
that falls in the dark (`model.exposure_key`). Systems multiply what they write into ``frame.hdr`` by the
exposure of the frame before. Cost: one sample per 16 pixels and a workgroup that walks 256 bins three times.
"""

from __future__ import annotations

from math import exp
from typing import TYPE_CHECKING

import numpy as np

from fallstreak.gpu import EXPOSURE, FrameGraph, Struct

from . import model

if TYPE_CHECKING:
    from fallstreak.world import Film

METER = Struct(
    "Meter",
    [
        ("low", "f32", "share of the dark left out"),
        ("high", "f32", "share under which light counts"),
        ("depth", "f32", "stops under the lights beyond which darkness does not count"),
        ("compensation", "f32", "stops, positive brightens"),
        ("fixed_scale", "f32", "picture value per cd/m², 0: metered"),
        ("to_light", "f32", "part of the way to a darker exposure gone in this frame, 0..1"),
        ("to_dark", "f32", "the same to a brighter exposure"),
        ("dimmest", "f32", "cd/m², metered luminance is at least this"),
        ("brightest", "f32", "cd/m², and at most this"),
    ],
)

BINS, LOWEST, HIGHEST = 256, -20.0, 30.0
"""The histogram: bins, and log2 of the luminance in cd/m² of the first and the last."""

SECONDS_TO_LIGHT, SECONDS_TO_DARK = 0.4, 1.6
"""Time constants of the adaptation: eyes and cameras close faster than they open."""


def add_exposure_buffer(graph: FrameGraph) -> None:
    """Declare ``frame.exposure``, whose last frame's value scales what is written into ``frame.hdr``."""
    graph.buffer("frame.exposure", EXPOSURE.size, history=True)


class Exposure:
    """Metering and adaptation of one graph.

    Parameters
    ----------
    graph : FrameGraph
        In which ``picture`` and ``frame.exposure`` are declared.
    film : Film
        The world's; its exposure, ev100 and compensation count.
    size : (int, int)
        Of the picture that is metered.
    picture : str
        The texture that is metered.
    """

    def __init__(self, graph: FrameGraph, film: Film, size: tuple[int, int], picture: str = "frame.resolved"):
        self._graph = graph
        self._film = film
        graph.buffer("frame.histogram", 4 * BINS, persistent=True)
        self._meter = graph.uniform("frame.meter", METER)
        self._meter.set(low=0.10, high=0.97, depth=9.0, dimmest=1e-5, brightest=1e6)
        self.update(0.0, instant=True)
        # small pictures have no samples to spare
        stride = 4 if size[0] * size[1] > 100_000 else 2
        settings = {
            "structs": [EXPOSURE, METER],
            "constants": {"BINS": BINS, "LOWEST": LOWEST, "HIGHEST": HIGHEST, "STRIDE": stride},
        }
        bind = {
            "meter": "frame.meter",
            "picture": picture,
            "linear": "sampler:linear-clamp",
            "previous": "frame.exposure@previous",
            "histogram": "frame.histogram",
            "exposure": "frame.exposure",
        }
        groups = (-(-size[0] // (16 * stride)), -(-size[1] // (16 * stride)), 1)
        shader = "package::frame::exposure"
        graph.compute("frame.meter", shader, entry="measure", bind=bind, groups=groups, **settings)
        graph.compute("frame.exposure", shader, entry="settle", bind=bind, groups=(1, 1, 1), **settings)

    def begin(self, sun_elevation: float) -> None:
        """Give the first frame an exposure to start from: the fixed one, or a guess by the sun's
        elevation (rad).
        """
        scale = self.fixed_scale or float(
            model.auto_scale(model.guess_luminance(sun_elevation), self._film.compensation)
        )
        ev100 = float(model.ev100_from_scale(scale))
        data = EXPOSURE.pack(scale=scale, ev100=ev100, luminance=0.0, pre_scale=scale)
        self._graph.restore({"frame.exposure": np.frombuffer(data, np.uint8)})

    @property
    def fixed_scale(self) -> float:
        """Picture value per cd/m² of a fixed exposure; 0 for a metered one."""
        if self._film.exposure != "fixed":
            return 0.0
        return float(model.scale_from_ev100(self._film.ev100 - self._film.compensation))

    def update(self, delta: float, *, instant: bool = False) -> None:
        """Set the meter for a frame ``delta`` seconds after the last; ``instant`` adapts at once (stills,
        files).
        """
        self._meter.set(
            compensation=self._film.compensation,
            fixed_scale=self.fixed_scale,
            to_light=1.0 if instant else 1.0 - exp(-delta / SECONDS_TO_LIGHT),
            to_dark=1.0 if instant else 1.0 - exp(-delta / SECONDS_TO_DARK),
        )
