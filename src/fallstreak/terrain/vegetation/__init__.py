"""Trees, shrubs and rocks."""

from .passes import Vegetation

__all__ = ["Vegetation"]
