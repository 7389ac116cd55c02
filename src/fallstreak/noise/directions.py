"""The gradients of the lattice, as numbers.

2-D: 8 directions at odd multiples of 22.5 degrees, ``(±√2, ±(2 − √2))`` and swapped: bit 0 of the index is
the sign of x, bit 1 that of y, bit 2 swaps the lengths. 3-D: Perlin's 12 edges with four repeated, in the
order of his `grad` (2002). 4-D: the 32 edges ``(0, ±1, ±1, ±1)``, times 2/3: bits 0 and 1 say which axis is
0 (x, y, z, w), bits 2 and 3 are the signs of the first two of the others, and bit 4 negates all three. Each
keeps the noise in about -1..1 (largest possible values 1.012, 1.036 and 1.023).
"""

from __future__ import annotations

import math

LONG, SHORT = math.sqrt(2.0), 2.0 - math.sqrt(2.0)
FOUR_SCALE = 2.0 / 3.0

GRADIENTS2 = tuple(
    (x * (-1) ** (i & 1), y * (-1) ** (i >> 1 & 1))
    for i in range(8)
    for x, y in ((SHORT, LONG) if i & 4 else (LONG, SHORT),)
)


def _edge3(i: int) -> tuple[int, int, int]:
    first, second = (-1) ** (i & 1), (-1) ** (i >> 1 & 1)
    u = 0 if i < 8 else 1
    v = 1 if i < 4 else 0 if i in (12, 14) else 2
    edge = [0, 0, 0]
    edge[u], edge[v] = first, second
    return tuple(edge)  # type: ignore[return-value]


def _edge4(i: int) -> tuple[int, int, int, int]:
    signs = [(-1) ** (i >> 2 & 1), (-1) ** (i >> 3 & 1), 1]
    negate = (-1) ** (i >> 4 & 1)
    return tuple(0 if axis == i & 3 else negate * signs.pop(0) for axis in range(4))  # type: ignore[return-value]


EDGES3 = tuple(_edge3(i) for i in range(16))
EDGES4 = tuple(_edge4(i) for i in range(32))
