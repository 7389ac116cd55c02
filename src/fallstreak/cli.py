"""The command line: what can be typed, and how errors are told.

Commands are imported when they are called, so that ``fallstreak --help`` is quick. What a person can mend is
one sentence on stderr and exit status 2; what the machine lacks (no adapter, GPU lost) is one sentence and
status 1.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

from cyclopts import App, CycloptsError, Parameter

from . import __version__
from .world.errors import UserError

app = App(
    name="fallstreak",
    version=__version__,
    help="Skies, weather and worlds, rendered in real time: a scene file becomes a picture.",
    help_format="plaintext",
    help_epilogue="""\
Examples:
    fallstreak render jacksboro -o evening.png
    fallstreak render jacksboro -o noon.png --time 2025-10-18T13:00-04:00
    fallstreak render jacksboro -o haze.png --set sky.turbidity=6
    fallstreak scenes
    fallstreak check my-scene.toml

A scene of your own begins with two lines: extends = "jacksboro", and a key to
change. fallstreak COMMAND --help tells more.
""",
)


def _later(name: str, summary: str, examples: str) -> None:
    """Register ``commands/NAME.py``'s function NAME without importing it."""
    summary = "\n\n".join(" ".join(paragraph.split()) for paragraph in summary.split("\n\n"))
    lines = "".join(f"    fallstreak {name} {line.strip()}\n" for line in examples.strip().splitlines())
    epilogue = f"Examples:\n{lines}" if lines else ""
    app.command(f"fallstreak.commands.{name}:{name}", name=name, help=summary, help_epilogue=epilogue)


_later(
    "render",
    """Render a scene to a picture, to arrays or to a sequence.

    A sequence is numbered: dawn.0000.png, or where #### stands in the name. Ctrl-C stops it after the frame
    in hand; the same command goes on from there, and its files are byte for byte those of an uninterrupted
    run.""",
    """jacksboro -o evening.png
    jacksboro -o evening.exr --size 1920x1080 --quality ultra
    jacksboro -o frame.png --frames 0:240 --fps 24
    my-scene.toml --set film.exposure=fixed --set film.ev100=12""",
)
_later("scenes", "List the shipped scenes: what is to be seen, where and when.", "")
_later(
    "check",
    "Say of each scene ok, or in one sentence what is wrong with it (exit 2).",
    """my-scene.toml
    scenes/*.toml
    jacksboro --set sky.turbidity=4""",
)
_later(
    "schema",
    "Print the JSON schema of scene files, from which editors complete and check.",
    "-o scene.schema.json   (then begin scenes by #:schema ./scene.schema.json)",
)
_later(
    "noise",
    "Draw noise: a plane through it, as a PNG, from black at the lowest to white at the highest.",
    """-o perlin.png
    -o cells.png --kind cellular_f1 --frequency 12
    -o clouds.png --octaves 8 --frequency 4 --seed 7
    -o mountains.png --fractal ridged --octaves 9 --frequency 3 --colors land
    -o marble.png --warp 1.5 --octaves 6 --frequency 3
    -o tile.png --period 8 --octaves 5   (copies fit together)
    -o far.png --at 1e7,0,0.5   (ten million cells from the origin)""",
)
clouds = App(
    name="clouds", help="Bake the textures of cloud sprites, look at cloud models.", help_epilogue=""
)
clouds.command(
    "fallstreak.commands.clouds:bake",
    name="bake",
    help="Bake the sprites' textures from noise, or look at cloud models of your own.",
    help_epilogue="""Examples:
    fallstreak clouds bake
    fallstreak clouds bake my-cloud.toml -o my-cloud.png
    fallstreak clouds bake cumulus_congestus_a cumulonimbus -o towers.png
""",
)
app.command(clouds)
_later("doctor", "List graphics adapters, and say which one is used and why.", "")


@app.command(help_epilogue="Examples:\n    fallstreak bench\n    fallstreak bench sky --json figures.json\n")
def bench(
    *names: str,
    json: Annotated[Path | None, Parameter(name="--json", negative="")] = None,
    fastnoise2: Annotated[Path | None, Parameter(name="--fastnoise2", negative="")] = None,
) -> int:
    """Measure speed and accuracy, and print the figures beside their goals.

    Parameters
    ----------
    names
        Which benchmarks; all when none is named.
    json
        Also write the figures to this file, as a list of {metric, value, unit, goal, met, how}.
    fastnoise2
        FastNoise2's shared library, where you have built it: bench noise measures beside it.
    """
    from .commands.bench import BenchError
    from .commands.bench import bench as run

    if fastnoise2 is not None:
        if not fastnoise2.is_file():
            raise UserError(f"--fastnoise2 {fastnoise2}: there is no such file")
        os.environ["FALLSTREAK_FASTNOISE2"] = str(fastnoise2.absolute())
    try:
        return run(names, json)
    except BenchError as error:
        raise UserError(str(error)) from None


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command line and return its exit status."""
    try:
        result = app(arguments, exit_on_error=False, print_error=False, result_action="return_value")
        sys.stdout.flush()
        return result if isinstance(result, int) else 0
    except UserError as error:
        return _tell(str(error), 2)
    except CycloptsError as error:
        command = " ".join(["fallstreak", *(error.command_chain or ())])
        return _tell(f"{' '.join(str(error).split())} (see {command} --help)", 2)
    except KeyboardInterrupt:
        return _tell("interrupted", 130)
    except BrokenPipeError:
        # Whoever read our output has gone (| head); Python would complain once more when it closes stdout.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 141
    except Exception as error:
        gpu = sys.modules.get("fallstreak.gpu.errors")
        if gpu and isinstance(error, gpu.GpuError):
            return _tell(str(error), 1)
        raise


def _tell(message: str, status: int) -> int:
    # A file's name or value may hold control codes, which a terminal would obey.
    print("fallstreak: " + "".join(c if c.isprintable() else "·" for c in message), file=sys.stderr)
    return status


if __name__ == "__main__":
    sys.exit(main())
