"""``fallstreak render``: a scene becomes a picture, arrays or a numbered sequence."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter

from fallstreak.commands import arguments as check
from fallstreak.commands.job import Job
from fallstreak.output.layers import LAYERS
from fallstreak.world import load


def _repeated(*names: str) -> Parameter:
    return Parameter(name=names, negative="", show_default=False)


def render(
    scene: Annotated[str, Parameter(name="SCENE")],
    /,
    *,
    output: Annotated[tuple[Path, ...], _repeated("-o", "--output")] = (),
    size: str = "1280x720",
    time: str | None = None,
    camera: str | None = None,
    frames: str | None = None,
    fps: float = 24.0,
    set: Annotated[tuple[str, ...], _repeated("--set")] = (),
    layers: str | None = None,
    quality: Literal["low", "medium", "high", "ultra"] = "high",
    samples: int | None = None,
    seed: int | None = None,
    bits: int | None = None,
    show: Literal["materials"] | None = None,
    stats: Path | None = None,
    adapter: str | None = None,
    verbose: Annotated[bool, Parameter(name=["-v", "--verbose"], negative="", show_default=False)] = False,
) -> int:
    """Render a scene to a picture, to arrays or to a sequence.

    A sequence is numbered: dawn.0000.png, or where #### stands in the name. Ctrl-C stops it after the frame
    in hand; the same command goes on from there, and its files are byte for byte those of an uninterrupted
    run.

    Parameters
    ----------
    scene
        A shipped scene's name (fallstreak scenes lists them) or a .toml file.
    output
        A file: .png, .exr (float layers, cd/m²) or .npz; repeatable. [default: SCENE.png]
    size
        Width x height in pixels, 16 to 8192 each.
    time
        Start, ISO 8601 with zone: 2025-10-18T18:28-04:00.
    camera
        A camera standing still: height=2000,heading=250,pitch=-5; also east, north, above, roll, fov.
    frames
        FIRST:END, a sequence without END itself: 0:240. Stopped, the same command goes on.
    fps
        Frames per second of a sequence.
    set
        Any key of the scene, KEY=VALUE: sky.turbidity=4; repeatable.
    layers
        What goes into .exr and .npz: hdr,depth,normal,albedo,motion,clouds. [default: all]
    quality
        How much work to spend on a frame.
    samples
        Jittered pictures averaged into each frame. [default: by quality]
    seed
        Of everything random.
    bits
        Of a .png, 8 or 16 per channel. [default: 8]
    show
        A view into the picture instead: materials paints the six base materials of the ground in six colours.
    stats
        Also write adapter, times per pass and frame, and memory to this JSON file.
    adapter
        Part of a graphics adapter's name (fallstreak doctor lists them).
    verbose
        Print the times of all passes.
    """
    width_height = check.parse_size(size)
    numbers = check.parse_frames(frames) if frames is not None else None
    check.check_number("--fps", fps, 1e-3, 1e4)
    if samples is not None:
        check.check_number("--samples", samples, 1, 65536)
    if bits not in (None, 8, 16):
        raise check.UsageError(f"--bits {bits} is not allowed: it must be 8 or 16")
    chosen = check.parse_layers(layers) if layers is not None else None
    overrides = list(set)
    overrides += check.camera_overrides(camera) if camera is not None else []
    overrides += [f"time={time}"] if time is not None else []
    overrides += [f"seed={seed}"] if seed is not None else []
    world = load(scene, overrides)
    paths = output or (Path(f"{Path(scene).stem}.png"),)
    check.check_outputs(paths, sequence=numbers is not None)
    check.check_layers_fit(chosen, paths)
    check.check_bits_fit(bits, paths)
    if stats is not None:
        check.check_file(stats, "--stats")
    job = Job(
        world,
        {
            "size": width_height,
            "quality": quality,
            "samples": samples,
            "layers": _rendered_layers(chosen, paths),
            "bits": bits or 8,
            "adapter": adapter,
            "show": show,
        },
        layers=chosen,
        stats=stats,
        verbose=verbose,
    )
    if numbers is None:
        return job.still(paths)
    return job.sequence(check.sequence_names(paths), numbers, fps)


def _rendered_layers(chosen: tuple[str, ...] | None, paths: Sequence[Path]) -> tuple[str, ...]:
    """What has to be brought back from the GPU: for a PNG the picture is enough."""
    if all(path.suffix.lower() == ".png" for path in paths):
        return ()
    return tuple(LAYERS) if chosen is None else chosen
