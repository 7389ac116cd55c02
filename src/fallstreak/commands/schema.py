"""``fallstreak schema``: what a scene file may hold, for editors."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter


def schema(
    *,
    markdown: Annotated[bool, Parameter(negative="")] = False,
    output: Annotated[Path | None, Parameter(name=["--output", "-o"], negative="")] = None,
) -> None:
    """Print the JSON schema of scene files: every key with type, unit, range, default and a sentence.

    Parameters
    ----------
    markdown
        Print tables for people instead.
    output
        Write to this file instead of the terminal.
    """
    import json

    from fallstreak import UserError
    from fallstreak import schema as world_schema
    from fallstreak.world.reference import reference

    if markdown:
        text = reference()
    else:
        text = json.dumps(world_schema(), indent=2, ensure_ascii=False) + "\n"
    if output is None:
        print(text, end="")
        return
    try:
        beside = output.with_name(f".{output.name}.{os.getpid()}.part")
        beside.write_text(text, encoding="utf-8")
        os.replace(beside, output)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise UserError(f"{output} cannot be written: {reason}") from None
