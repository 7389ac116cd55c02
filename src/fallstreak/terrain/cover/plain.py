"""Grass and rock, until a country has a cover of its own."""

PALETTE = ("grass", "forest_floor", "canopy", "soil", "sandstone", "scree")
