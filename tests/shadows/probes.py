"""The GPU finds this folder's probes as modules of the package."""

from __future__ import annotations

from pathlib import Path

HERE = Path(__file__).parent


class WithProbes:
    """The package's shaders, and ``package::<name>`` for ``<name>.wesl`` of this folder."""

    def __init__(self, package):
        self._package = package

    def __call__(self, path):
        file = HERE / f"{path[0]}.wesl"
        if len(path) == 1 and file.is_file():
            return file.read_text(encoding="utf-8"), file.name
        return self._package(path)

    def names(self):
        return [*self._package.names(), *(file.stem for file in HERE.glob("*.wesl"))]
