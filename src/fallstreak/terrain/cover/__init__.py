"""What lies and grows on the ground, by country: each a WESL module and its float64 twin of the same name."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path


def kind(material: str) -> str:
    """The module of a kind of country (``world.terrain.material``)."""
    return material if (Path(__file__).parent / f"{material}.wesl").is_file() else "plain"


def palette(material: str) -> tuple[str, ...]:
    """The six base materials of a kind of country."""
    return import_module(f"fallstreak.terrain.cover.{kind(material)}").PALETTE
