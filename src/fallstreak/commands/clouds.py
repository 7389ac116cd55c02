"""``fallstreak clouds bake``: textures of sprites from noise, and cloud models of one's own."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from fallstreak.commands import arguments as check
from fallstreak.commands.arguments import UsageError

if TYPE_CHECKING:
    from fallstreak.clouds.shapes import CloudModel


def bake(
    *models: Annotated[str, Parameter(name="MODEL")],
    output: Annotated[Path | None, Parameter(name=["-o", "--output"], negative="")] = None,
) -> int:
    """Bake the sprites' textures, or look at cloud models.

    Parameters
    ----------
    models
        Cloud models, .toml files or names of shipped ones. Without any, the sheet of textures is baked.
    output
        A .png: of the models from the south, the west and above, or of the sheet. [default: no picture of
        models; the sheet is compared with the package's own]
    """
    if output is not None:
        check.check_file(output, "-o", "clouds.png")
        if output.suffix.lower() != ".png":
            raise UsageError(f"-o {output} is not a PNG: give a name that ends in .png, such as clouds.png")
    return _models(models, output) if models else _sheet(output)


def _sheet(output: Path | None) -> int:
    """The textures into a file; without one, whether they are the package's own."""
    from fallstreak.clouds.sprites.bake import write
    from fallstreak.clouds.sprites.textures import SHEET
    from fallstreak.output.atomic import replacing

    if output is not None:
        with replacing(output) as beside:
            size = write(beside)
        _table(output)
        print(f"{output}: 16 textures, {size / 1024:.0f} KiB")
        return 0
    new = _baked()
    told = f"{SHEET.name}: 16 textures, {len(new) / 1024:.0f} KiB"
    if SHEET.is_file() and new == SHEET.read_bytes():
        _table(SHEET)
        print(f"{told}, byte for byte the package's own")
        return 0
    if not os.access(SHEET.parent, os.W_OK):
        raise UsageError(f"{SHEET} differs and cannot be written: give a file of your own by -o")
    with replacing(SHEET) as beside:
        beside.write_bytes(new)
    _table(SHEET)
    print(f"{told}, written anew")
    return 0


def _table(sheet: Path) -> None:
    """Print what is in a sheet."""
    from fallstreak.clouds.sprites.bake import listed

    print("texture  kind    mean opacity   bytes")
    for number, kind, opacity, size in listed(sheet):
        print(f"{number:7d}  {kind:6s}  {opacity:12.3f}  {size:6,d}")


def _baked() -> bytes:
    """The sheet's file."""
    import tempfile

    from fallstreak.clouds.sprites.bake import write

    with tempfile.TemporaryDirectory() as folder:
        made = Path(folder) / "textures.png"
        write(made)
        return made.read_bytes()


def _models(names: tuple[str, ...], output: Path | None) -> int:
    from fallstreak.clouds.shapes import load

    loaded = load(names)
    for model in loaded:
        print(describe(model))
    if output is not None:
        from fallstreak.clouds.shapes.portrait import portrait
        from fallstreak.output.png import write_png

        write_png(output, portrait(loaded))
        print(f"{output}: from the south, from the west and from above; light from the southwest")
    return 0


def describe(model: CloudModel) -> str:
    """A model in one line."""
    culled = f" ({model.culled} culled: crowded or inside another box)" if model.culled else ""
    boxes = "1 box" if len(model.boxes) == 1 else f"{len(model.boxes)} boxes"
    return (
        f"{model.name}: {model.title}; {boxes}, {len(model.sprites)} sprites{culled}, "
        f"{2.0 * model.radius:.0f} m wide, {model.height:.0f} m high"
    )
