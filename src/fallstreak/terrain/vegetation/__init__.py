"""Trees, shrubs and rocks."""

from .passes import Vegetation, tree_radius

__all__ = ["Vegetation", "tree_radius"]
