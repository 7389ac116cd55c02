"""One call of ``fallstreak render``, after everything typed has been checked: render, write, tell."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.console import Console

from fallstreak.commands.interrupt import INTERRUPTED, interruptible, terminable
from fallstreak.commands.progress import showing
from fallstreak.commands.stats import print_stats
from fallstreak.output import FrameLike, save, world_digest
from fallstreak.output.naming import FrameNames
from fallstreak.output.sequence import PendingFrame, Progress, Target, missing_frames, render_sequence
from fallstreak.output.stats import Statistics, write_stats
from fallstreak.world import QUALITY, World

if TYPE_CHECKING:
    from fallstreak.frame.renderer import Renderer


@dataclass
class Job:
    """What is to be rendered.

    Attributes
    ----------
    world : World
        The scene with all overrides.
    options : dict
        Of the renderer: size, quality, samples, layers, bits, adapter, show.
    layers : tuple of str, optional
        What goes into .exr and .npz files; by default all.
    stats : Path, optional
        Where the measurements go.
    verbose : bool
        Print the measurements.
    """

    world: World
    options: dict[str, Any]
    layers: tuple[str, ...] | None = None
    stats: Path | None = None
    verbose: bool = False

    def still(self, paths: Sequence[Path]) -> int:
        """Render one picture into one or more files; returns the exit status."""
        from fallstreak.frame.renderer import Renderer

        start = time.perf_counter()
        with terminable():
            with Renderer(self.world, still=True, **self.options) as renderer:
                measured = self._measured(renderer)
                frame = measured.submit(0).result()
            for path in paths:
                save(frame, path, layers=self.layers, bits=self._bits, facts={"scene_hash": self._digest})
        seconds = time.perf_counter() - start
        for path in paths:
            print(f"{path}: {self._describe(frame)}, {seconds:.1f} s")
        self._tell(measured, seconds)
        return 0

    def sequence(self, names: Sequence[FrameNames], frames: range, fps: float) -> int:
        """Render what is missing of a sequence; returns the exit status."""
        from fallstreak.frame.renderer import Renderer

        console = Console(stderr=True)
        targets = [Target(name, self.layers or self.options["layers"] or None, self._bits) for name in names]
        facts = self._facts(frames, fps)
        missing = missing_frames(targets, frames, facts)
        there = len(frames) - len(missing)
        listed = ", ".join(map(str, names))
        if not missing:
            print(f"{listed}: all {len(frames)} frames are there already")
            return 0
        if there:
            console.print(f"{there} of {len(frames)} frames are there already", highlight=False)
        with (
            Renderer(self.world, fps=fps, **self.options) as renderer,
            interruptible() as stop,
            showing(len(frames), there, console) as show,
        ):
            measured = self._measured(renderer)
            progress = render_sequence(
                measured,
                targets,
                frames,
                facts,
                missing=missing,
                stop=stop,
                on_frame=lambda progress, frame: show(progress),
            )
        self._tell(measured, progress.seconds)
        if progress.interrupted:
            console.print(
                f"interrupted: {progress.done} of {len(frames)} frames are there; "
                "the same command goes on from here",
                highlight=False,
                soft_wrap=True,
            )
            return INTERRUPTED
        print(f"{listed}: {len(frames)} frames, {_size(self.options['size'])}, {_speed(progress)}")
        return 0

    @property
    def _bits(self) -> int:
        return self.options["bits"]

    @property
    def _digest(self) -> str:
        return world_digest(self.world)

    def _facts(self, frames: range, fps: float) -> Any:
        """What is known of a frame before it is rendered; decides whether a file found is the one wanted."""
        from fallstreak import __version__
        from fallstreak.gpu.adapters import choose

        fixed = {
            "scene": self.world.name,
            "scene_hash": self._digest,
            "seed": self.world.seed,
            "version": __version__,
            "adapter": choose(self.options["adapter"])[0].name,
            "size": list(self.options["size"]),
            "quality": self.options["quality"],
            "samples": self.options["samples"] or 1,
            "temporal": self.options["samples"] is None and QUALITY[self.options["quality"]].temporal,
            "fps": fps,
            "first": frames.start,  # has no history, and what follows depends on it
        }

        if self.options.get("show"):
            fixed["show"] = self.options["show"]

        def facts(index: int) -> dict[str, Any]:
            return {**fixed, "frame": index, "time": self.world.time_at(index / fps).isoformat()}

        return facts

    def _measured(self, renderer: Renderer) -> Measured:
        facts = {
            "scene": self.world.name,
            "size": list(self.options["size"]),
            "quality": self.options["quality"],
            "samples": renderer.samples,
            "seed": self.world.seed,
        }
        renderer.pass_times = bool(self.stats or self.verbose)
        return Measured(renderer, Statistics(facts) if self.stats or self.verbose else None)

    def _tell(self, measured: Measured, seconds: float) -> None:
        if measured.statistics is None:
            return
        summary = measured.statistics.summary(seconds)
        if self.stats:
            write_stats(self.stats, summary)
        print_stats(summary)

    def _describe(self, frame: FrameLike) -> str:
        facts = frame.metadata
        return f"{_size(facts['size'])}, {facts['time']}, EV {facts['ev100']:.1f}"


class Measured:
    """A renderer whose frames are measured, if `statistics` is given; reading the times waits for the GPU."""

    def __init__(self, renderer: Renderer, statistics: Statistics | None):
        self._renderer = renderer
        self.statistics = statistics
        self.checkpoint = renderer.checkpoint
        self.restore = renderer.restore

    def submit(self, index: int) -> PendingFrame:
        """Start a frame; see `Renderer.submit`."""
        pending = self._renderer.submit(index)
        if self.statistics is not None:
            self.statistics.add(index, self._renderer.stats())
        return pending


def _size(size: Sequence[int]) -> str:
    return "×".join(map(str, size))


def _speed(progress: Progress) -> str:
    return f"{progress.seconds:.1f} s, {1000 * progress.seconds_per_frame:.0f} ms/frame"
