"""Numbered files, interruptible and resumable.

What exists, is whole and carries the expected metadata is not rendered again. What is missing is rendered
from the same history as in an uninterrupted run: from the renderer's state if it stands right before, from a
checkpoint, or from the sequence's first frame, in this order of preference. Frames on the way are rendered
but not written. So a resumed sequence has the bytes of an uninterrupted one.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Protocol

from fallstreak.output.atomic import remove_leftovers
from fallstreak.output.checkpoints import Checkpoints, State
from fallstreak.output.layers import FrameLike
from fallstreak.output.metadata import is_whole
from fallstreak.output.naming import FrameNames
from fallstreak.output.save import check_format, file_metadata, save
from fallstreak.output.writer import BackgroundWriter

CHECKPOINT_EVERY = 16  # frames; a resumed sequence replays at most this many less one


class PendingFrame(Protocol):
    """A frame the GPU is working on."""

    def result(self) -> FrameLike: ...


class SequenceRenderer(Protocol):
    """What a sequence needs of a renderer; frames are submitted in ascending order."""

    def submit(self, index: int) -> PendingFrame:
        """Start frame `index` and return at once."""
        ...

    def checkpoint(self) -> State:
        """Everything the frame after the last submitted one depends on."""
        ...

    def restore(self, checkpoint: State) -> None:
        """Be as after the frame whose checkpoint this is."""
        ...


@dataclass(frozen=True)
class Target:
    """One numbered file per frame: the pattern of its names, and what goes in (see `save`)."""

    names: FrameNames
    layers: tuple[str, ...] | None = None
    bits: int = 8

    def __post_init__(self) -> None:
        check_format(self.names.path(0))

    def is_whole(self, index: int, expected: Mapping[str, Any]) -> bool:
        """Whether the file of frame `index` is there, undamaged and as expected."""
        path = self.names.path(index)
        return is_whole(path, file_metadata(expected, path, layers=self.layers, bits=self.bits))

    def save(self, index: int, frame: FrameLike, facts: Mapping[str, Any]) -> Path:
        """Write the file of frame `index`, with these facts in its metadata."""
        return save(frame, self.names.path(index), layers=self.layers, bits=self.bits, facts=facts)


@dataclass
class Progress:
    """How far a sequence is; handed to `on_frame` after every frame."""

    total: int
    found: int = 0
    rendered: int = 0
    replayed: int = 0
    interrupted: bool = False
    seconds: float = 0.0
    first_seconds: float = 0.0
    """When the first frame was finished: it also makes pipelines and tables."""
    last: int | None = field(default=None)
    """The frame just finished."""

    @property
    def done(self) -> int:
        """Files that are there now."""
        return self.found + self.rendered

    @property
    def seconds_per_frame(self) -> float:
        """Of the frames after the first, replayed ones included."""
        frames = self.rendered + self.replayed
        if frames < 2:
            return self.seconds / max(1, frames)
        return (self.seconds - self.first_seconds) / (frames - 1)


def missing_frames(
    targets: Sequence[Target], frames: range, expected: Callable[[int], Mapping[str, Any]]
) -> list[int]:
    """Frames of which at least one file is not there, not whole or not as expected."""

    def complete(index: int) -> bool:
        facts = expected(index)
        return all(target.is_whole(index, facts) for target in targets)

    for target in targets:
        remove_leftovers(target.names.folder, {target.names.path(index).name for index in frames})
    with ThreadPoolExecutor() as pool:  # reading and unpacking release the interpreter lock
        return [index for index, whole in zip(frames, pool.map(complete, frames), strict=True) if not whole]


def render_sequence(
    renderer: SequenceRenderer,
    targets: Sequence[Target],
    frames: range,
    expected: Callable[[int], Mapping[str, Any]],
    *,
    missing: Sequence[int] | None = None,
    on_frame: Callable[[Progress, FrameLike], None] | None = None,
    stop: Callable[[], bool] = lambda: False,
    checkpoint_every: int = CHECKPOINT_EVERY,
) -> Progress:
    """Render what is missing of a sequence.

    Parameters
    ----------
    renderer : SequenceRenderer
        Fresh: its next frame would be the first.
    targets : sequence of Target
        What to write of each frame.
    frames : range
        The sequence. Its first frame has no history.
    expected : callable
        Metadata that the files of a frame will have, as far as known before rendering. The same for every
        run.
    missing : sequence of int, optional
        What `missing_frames` found, if it was asked already.
    on_frame : callable, optional
        Called after every frame with the progress and the frame; also for frames that are not written.
    stop : callable
        Asked before every frame; True ends the sequence after the frames in hand are written.
    checkpoint_every : int
        Frames between two states on disk.

    Returns
    -------
    Progress
        What was done, and whether it was interrupted.

    Raises
    ------
    OutputError
        When a file cannot be written; those before it are whole.
    """
    start = time.perf_counter()
    if missing is None:
        missing = missing_frames(targets, frames, expected)
    progress = Progress(total=len(frames), found=len(frames) - len(missing))
    identity = {**expected(frames.start), "first frame": frames.start}
    checkpoints = Checkpoints(targets[0].names.folder, targets[0].names.title, identity)
    checkpoints.prune()
    wanted = set(missing)
    position: int | None = None  # the frame whose state the renderer holds
    held: tuple[int, PendingFrame] | None = None
    with BackgroundWriter() as writer:

        def finish(index: int, pending: PendingFrame) -> None:
            frame = pending.result()
            if index in wanted:
                facts = expected(index)
                for target in targets:
                    writer.put(lambda target=target: target.save(index, frame, facts))
                progress.rendered += 1
            else:
                progress.replayed += 1
            progress.last, progress.seconds = index, time.perf_counter() - start
            progress.first_seconds = progress.first_seconds or progress.seconds
            if on_frame:
                on_frame(progress, frame)

        for goal in missing:
            if position != goal - 1:
                if held:  # its read-back must not meet a restored state
                    finish(*held)
                    held = None
                position = _start_nearest(renderer, checkpoints, position, goal)
            while position is None or position < goal:
                if stop():
                    progress.interrupted = True
                    break
                index = frames.start if position is None else position + 1
                pending = renderer.submit(index)
                position = index
                if (index - frames.start) % checkpoint_every == checkpoint_every - 1 and index != frames[-1]:
                    _keep(renderer, checkpoints, writer, index)
                # One frame stays in flight: the CPU takes a frame while the GPU works on the next.
                if held:
                    finish(*held)
                held = index, pending
            if progress.interrupted:
                break
        if held:
            finish(*held)
        if progress.interrupted and position is not None:
            _keep(renderer, checkpoints, writer, position)
    if not progress.interrupted:
        checkpoints.remove()
    progress.seconds = time.perf_counter() - start
    return progress


def _keep(renderer: SequenceRenderer, checkpoints: Checkpoints, writer: BackgroundWriter, index: int) -> None:
    state = renderer.checkpoint()
    writer.put(lambda: checkpoints.save(index, state))


def _start_nearest(
    renderer: SequenceRenderer, checkpoints: Checkpoints, position: int | None, goal: int
) -> int | None:
    """Bring the renderer as near before `goal` as a checkpoint allows; returns whose state it then holds."""
    for index in reversed(checkpoints.indices()):
        if index < goal and (position is None or index > position):
            state = checkpoints.load(index)
            if state is not None:
                renderer.restore(state)
                return index
    return position
