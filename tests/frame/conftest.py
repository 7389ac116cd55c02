"""The GPU finds this folder's shaders as modules of the package."""

from __future__ import annotations

import pytest
from shader_probes import find_probes


@pytest.fixture(autouse=True)
def probes(monkeypatch):
    find_probes(monkeypatch, __file__)
