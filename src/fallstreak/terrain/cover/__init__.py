"""What lies and grows on the ground, by country: each a WESL module and its float64 twin of the same name."""

from __future__ import annotations

from importlib import import_module


def palette(material: str) -> tuple[str, ...]:
    """The six base materials of a kind of country."""
    return import_module(f"fallstreak.terrain.cover.{material}").PALETTE
