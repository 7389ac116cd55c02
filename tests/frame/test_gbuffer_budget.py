"""The G-buffer keeps to the 28 bytes that DESIGN budgets, at the costs the WebGPU specification gives
each format.
"""

from fallstreak.frame import gbuffer

# WebGPU, "26.1.1 Texture format capabilities": render target pixel byte cost, and its alignment
COST = {"rgba8unorm": (8, 1), "rgb10a2unorm": (8, 4), "rg16float": (4, 2), "rgba16float": (8, 2)}


def test_colour_attachments_cost_28_bytes():
    total = 0
    for format, claimed in gbuffer.ATTACHMENTS.values():
        cost, alignment = COST[format]
        assert cost == claimed
        total = -(-total // alignment) * alignment + cost
    assert total == 28
