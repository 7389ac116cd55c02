"""Stills: many jittered frames become one by their mean, in 32-bit floats.

    mean = Accumulate(graph, size)                # frame.hdr -> frame.accumulation (cd/m²) and frame.resolved
    mean.update(sample)                           # each frame: 0 starts anew
    jitter = still_jitter(sample, samples)        # pixels, for the camera of that sample

``frame.accumulation`` (rgba32float, output it for EXR) is the mean luminance without any exposure in it.
"""

from __future__ import annotations

from fallstreak.gpu import EXPOSURE, FrameGraph, Struct

ACCUMULATION = Struct("Accumulation", [("sample", "u32", "samples already in the mean")])

_PLASTIC = 1.3247179572447460  # its powers spread points best in the plane: Roberts 2018, "R2"


def still_jitter(sample: int, samples: int) -> tuple[float, float]:
    """Where sample number ``sample`` of ``samples`` lies in the pixel: (x, y) in pixels, a tent of radius
    0.8.

    A tent weighs the centre of the pixel most, and lets neighbours share edges, which looks smoother than a
    box; a single sample lies in the middle.
    """
    if samples <= 1:
        return 0.0, 0.0
    u = (0.5 + sample / _PLASTIC) % 1.0, (0.5 + sample / _PLASTIC**2) % 1.0
    x, y = (_tent(v) * 0.8 for v in u)
    return x, y


def _tent(u: float) -> float:
    """Inverse of the tent's distribution on -1..1."""
    return (2 * u) ** 0.5 - 1 if u < 0.5 else 1 - (2 - 2 * u) ** 0.5


class Accumulate:
    """The running mean of ``picture``."""

    def __init__(self, graph: FrameGraph, size: tuple[int, int], picture: str = "frame.hdr"):
        graph.texture("frame.accumulation", "rgba32float", size, history=True)
        graph.texture("frame.resolved", "rgba16float", size)
        self._uniform = graph.uniform("frame.samples", ACCUMULATION)
        graph.fullscreen(
            "frame.accumulate",
            "package::frame::accumulate",
            color=["frame.accumulation", "frame.resolved"],
            bind={
                "accumulation": "frame.samples",
                "picture": picture,
                "before": "frame.accumulation@previous",
                "exposure": "frame.exposure@previous",
            },
            structs=[ACCUMULATION, EXPOSURE],
        )

    def update(self, sample: int) -> None:
        """Say which sample the next frame is; 0 forgets what was before."""
        self._uniform.set(sample=sample)
