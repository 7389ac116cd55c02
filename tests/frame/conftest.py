"""The GPU finds this folder's shaders as modules of the package."""

from __future__ import annotations

import pytest

from fallstreak.gpu import shader

from .probes import HERE


class _WithProbes:
    def __init__(self, package):
        self._package = package

    def __call__(self, path):
        if path == ("probe",):
            file = HERE / "probe.wesl"
            return file.read_text(encoding="utf-8"), file.name
        return self._package(path)

    def names(self):
        return [*self._package.names(), "probe"]


@pytest.fixture(autouse=True)
def probes(monkeypatch):
    monkeypatch.setattr(shader, "_resolve", _WithProbes(shader._resolve))
