"""Noise on the CPU and its WESL twin: the same integers, the same values to rounding.

`gradient` is Perlin's gradient noise on a hashed lattice in two dimensions (value and derivatives), with fBm;
the WESL module adds a three-dimensional kind for patterns on whole planets. Limits: one kind, no periodic
variants.
"""
