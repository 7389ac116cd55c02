"""Clouds of sprites, with a ring of pictures for the far ones."""

from .passes import Sprites

__all__ = ["Sprites"]
