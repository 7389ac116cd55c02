#!/usr/bin/env python3
"""Bake the textures of cloud sprites: writes src/fallstreak/clouds/sprites/data/textures.png.

The same as ``fallstreak clouds bake``, which can also write elsewhere and looks at cloud models.
"""

from __future__ import annotations

from fallstreak.clouds.sprites.bake import write
from fallstreak.clouds.sprites.textures import SHEET
from fallstreak.output.atomic import replacing

if __name__ == "__main__":
    SHEET.parent.mkdir(exist_ok=True)
    with replacing(SHEET) as beside:
        size = write(beside)
    print(f"{size / 1024:.0f} KiB in {SHEET.name}")
