"""Build the shipped models: src/fallstreak/models/data/glider.glb and ship.glb.

    python script/build_models.py [glider] [ship]

Shapes and paint are computed here; nothing is drawn by hand and nothing is random but by a seed.
"""

from __future__ import annotations

import sys
from importlib import import_module
from pathlib import Path

DATA = Path(__file__).parents[1] / "src" / "fallstreak" / "models" / "data"


def main(names: list[str]) -> None:
    """Build the named models, or all."""
    DATA.mkdir(exist_ok=True)
    for name in names or ["glider", "ship"]:
        glb = import_module(f"model_{name}").build()
        path = DATA / f"{name}.glb"
        glb.save(path)
        counts = [glb.tree["accessors"][p["indices"]]["count"] for p in glb.tree["meshes"][0]["primitives"]]
        print(f"{path.name}: {sum(counts) // 3:,} triangles, {path.stat().st_size / 1e3:,.0f} kB")


if __name__ == "__main__":
    main(sys.argv[1:])
