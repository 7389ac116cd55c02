"""How far a sequence is: a bar on a terminal, a line every few seconds in a log."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeRemainingColumn
from rich.progress import Progress as Bar

from fallstreak.output.sequence import Progress

_QUIET_SECONDS = 5.0


@contextmanager
def showing(total: int, found: int, console: Console) -> Iterator[Callable[[Progress], None]]:
    """Give a function to call after every frame.

    Parameters
    ----------
    total, found : int
        Frames of the sequence, and how many of them are there already.
    console : rich Console
        Where to show it; a bar if it is a terminal.
    """
    if not console.is_terminal:
        yield _lines(console)
        return
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("{task.fields[speed]}"),
        TimeRemainingColumn(),
    )
    with Bar(*columns, console=console, transient=True) as bar:
        task = bar.add_task("rendering", total=total, completed=found, speed="")

        def update(progress: Progress) -> None:
            what = "rendering" if progress.rendered else "catching up"
            bar.update(task, completed=progress.done, description=what, speed=_speed(progress))

        yield update


def _lines(console: Console) -> Callable[[Progress], None]:
    last = time.monotonic()

    def update(progress: Progress) -> None:
        nonlocal last
        now = time.monotonic()
        if now - last < _QUIET_SECONDS:
            return
        last = now
        seconds = (progress.total - progress.done) * progress.seconds_per_frame
        console.print(
            f"{progress.done} of {progress.total} frames, {_speed(progress)}, {_duration(seconds)} left",
            highlight=False,
            soft_wrap=True,
        )

    return update


def _speed(progress: Progress) -> str:
    return f"{1000 * progress.seconds_per_frame:.0f} ms/frame"


def _duration(seconds: float) -> str:
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    if hours:
        return f"{hours} h {minutes} min"
    return f"{minutes} min {rest} s" if minutes else f"{rest} s"
