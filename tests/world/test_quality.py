"""Quality presets are plain data that somebody reads."""

from __future__ import annotations

from dataclasses import fields
from pathlib import Path

import pytest

import fallstreak as fs

PACKAGE = Path(fs.__file__).parent


def test_presets_know_their_names():
    assert list(fs.QUALITY) == ["low", "medium", "high", "ultra"]
    assert all(quality.name == name for name, quality in fs.QUALITY.items())


@pytest.mark.parametrize("name", [f.name for f in fields(fs.Quality) if f.name != "name"])
def test_every_field_is_read(name):
    """A number that nobody reads promises what it does not keep."""
    readers = [p for p in PACKAGE.rglob("*.py") if p.name != "quality.py"]
    assert any(f"quality.{name}" in path.read_text(encoding="utf-8") for path in readers)
