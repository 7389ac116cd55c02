"""Kinds of land, where heights come from: each a WESL module and its float64 twin of the same name."""
