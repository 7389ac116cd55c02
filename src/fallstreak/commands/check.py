"""``fallstreak check``: are these scenes valid?"""

from __future__ import annotations

import sys
from typing import Annotated

from cyclopts import Parameter


def check(
    *scenes: Annotated[str, Parameter(name="SCENE")],
    overrides: Annotated[tuple[str, ...], Parameter(name="--set", negative="", show_default=False)] = (),
) -> int:
    """Say of each scene "ok", or in one sentence what is wrong with it; exit status 2 if any is wrong.

    Elevation files and models are read too.

    Parameters
    ----------
    scenes
        Scene files (.toml) or names of shipped scenes.
    overrides
        An override, KEY=VALUE, to be checked along with the scenes; may be given several times.
    """
    from fallstreak import UserError, load
    from fallstreak.models.poses import PlacedModels
    from fallstreak.terrain.elevation import read_elevation
    from fallstreak.terrain.model import elevation_paths

    if not scenes:
        raise UserError("nothing to check: name a scene file, such as fallstreak check my-scene.toml")
    bad = 0
    for scene in scenes:
        try:
            world = load(scene, overrides)
            if world.terrain.source == "file":
                # Building the ground takes seconds; whether its file can be read is known at once.
                try:
                    read_elevation(elevation_paths(world.terrain))
                except UserError as error:
                    raise UserError(f"{scene}: {error}") from None
            try:
                PlacedModels(world)
            except UserError as error:
                raise UserError(f"{scene}: {error}") from None
        except UserError as error:
            bad += 1
            print("".join(c if c.isprintable() else "·" for c in str(error)), file=sys.stderr)
        else:
            print(f"ok {scene}")
    return 2 if bad else 0
