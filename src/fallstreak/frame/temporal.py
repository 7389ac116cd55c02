"""Moving pictures: anti-aliasing over time.

    temporal = Temporal(graph, size, fast=False)  # frame.hdr -> frame.resolved, which keeps its history
    temporal.update(reset=first_frame)            # each frame
    jitter = sequence_jitter(index)               # pixels, for the camera of that frame

Reads ``view``, ``frame.hdr``, ``gbuffer.depth``, ``gbuffer.motion``, ``frame.exposure@previous`` and, where
there are clouds, ``clouds.layer``, by whose distances they move. The result of a frame depends on all frames
since the reset, so a sequence must be replayed or restored to go on as before.
"""

from __future__ import annotations

from math import ceil

from fallstreak.gpu import EXPOSURE, FrameGraph, Struct

from .model import halton

TEMPORAL = Struct("TemporalState", [("weight", "f32", "of the new frame in the mean; 1 forgets history")])

STEADY_WEIGHT = 1 / 8
"""Of a new frame once there is history: about 15 frames' worth of samples in the mean.

It is reached 8 frames after a reset, no later than a sequence is warm; frames that go on from a checkpoint
have it too."""

PHASES = 16


def sequence_jitter(index: int) -> tuple[float, float]:
    """Where frame ``index`` samples in the pixel: (x, y) in pixels, -0.5..0.5, Halton's points of 2 and 3."""
    n = index % PHASES + 1
    return halton(n, 2) - 0.5, halton(n, 3) - 0.5


class Temporal:
    """Temporal anti-aliasing of ``picture`` into ``frame.resolved``."""

    def __init__(
        self,
        graph: FrameGraph,
        size: tuple[int, int],
        picture: str = "frame.hdr",
        *,
        fast: bool = False,
        clouds: bool = False,
    ):
        graph.texture("frame.resolved", "rgba16float", size, history=True)
        # Old enough for the steady weight: without a reset, the history was restored from a longer run.
        self._age = ceil(1.0 / STEADY_WEIGHT)
        self._uniform = graph.uniform("frame.temporal", TEMPORAL)
        graph.render(
            "frame.temporal",
            "package::frame::temporal",
            color=["frame.resolved"],
            bind={
                "view": "view",
                "state": "frame.temporal",
                "exposure": "frame.exposure@previous",
                "picture": picture,
                "history": "frame.resolved@previous",
                "depth_buffer": "gbuffer.depth",
                "motion_buffer": "gbuffer.motion",
                "linear": "sampler:linear-clamp",
                "layer": "clouds.layer",
            },
            structs=[TEMPORAL, EXPOSURE],
            flags={"FAST": fast, "CLOUDS": clouds},
        )

    def update(self, *, reset: bool = False) -> None:
        """Prepare the next frame; ``reset`` forgets history. The first frames count alike, then
        `STEADY_WEIGHT`.
        """
        self._age = 0 if reset else self._age + 1
        self._uniform.set(weight=max(1.0 / (self._age + 1), STEADY_WEIGHT))
