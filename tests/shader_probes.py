"""The GPU finds the shaders beside a test as modules of the package."""

from __future__ import annotations

from pathlib import Path

from fallstreak.gpu import shader


class _WithProbes:
    """The package's shaders, and ``package::<name>`` for ``<name>.wesl`` of a folder."""

    def __init__(self, package, folder: Path):
        self._package, self._folder = package, folder

    def __call__(self, path):
        file = self._folder / f"{path[0]}.wesl"
        if len(path) == 1 and file.is_file():
            return file.read_text(encoding="utf-8"), file.name
        return self._package(path)

    def names(self):
        return [*self._package.names(), *(file.stem for file in self._folder.glob("*.wesl"))]


def find_probes(monkeypatch, test_file: str) -> None:
    """Until the monkeypatch is undone, probes beside ``__file__`` are modules."""
    monkeypatch.setattr(shader, "_resolve", _WithProbes(shader._resolve, Path(test_file).parent))
