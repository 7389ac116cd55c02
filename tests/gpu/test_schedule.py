"""Order, culling and lifetimes of a frame: pure Python."""

from __future__ import annotations

import pytest

from fallstreak.gpu import GraphError
from fallstreak.gpu.schedule import PassDecl, Ref, alias, schedule


def declare(name, reads=(), writes=(), order=0.0):
    return PassDecl(
        name, [Ref.parse(r) for r in reads], [Ref.parse(w) for w in writes], lambda _: None, order
    )


def names(passes, outputs, mips=lambda _: 1):
    return [p.name for p in schedule(passes, outputs, mips).passes]


def test_readers_follow_writers_whatever_the_insertion_order():
    passes = [
        declare("tone", ["hdr"], ["ldr"]),
        declare("light", ["depth"], ["hdr"]),
        declare("land", [], ["depth"]),
    ]
    assert names(passes, ["ldr"]) == ["land", "light", "tone"]


def test_modifiers_run_by_order_then_insertion_before_readers():
    passes = [
        declare("stars", ["hdr"], ["hdr"], order=20),
        declare("sky", ["hdr"], ["hdr"], order=10),
        declare("bloom", ["hdr"], ["glow"]),
        declare("light", [], ["hdr"]),
        declare("planets", ["hdr"], ["hdr"], order=20),
    ]
    assert names(passes, ["glow"]) == ["light", "sky", "stars", "planets", "bloom"]


def test_passes_nobody_reads_are_culled_and_named():
    passes = [declare("a", [], ["x"]), declare("b", ["x"], ["y"]), declare("debug", ["x"], ["z"])]
    plan = schedule(passes, ["y"], lambda _: 1)
    assert [p.name for p in plan.passes] == ["a", "b"]
    assert plan.culled == ["debug"]


def test_previous_orders_nothing_but_keeps_its_writer_alive():
    passes = [declare("meter", ["hdr"], ["exposure"]), declare("light", ["exposure@previous"], ["hdr"])]
    assert names(passes, ["hdr"]) == ["light", "meter"]


def test_mip_levels_are_ordered_apart():
    passes = [
        declare("down2", ["pyramid:mip1"], ["pyramid:mip2"]),
        declare("down1", ["pyramid:mip0"], ["pyramid:mip1"]),
        declare("whole", ["pyramid"], ["out"]),
        declare("base", [], ["pyramid:mip0"]),
    ]
    assert names(passes, ["out"], lambda n: 3 if n == "pyramid" else 1) == ["base", "down1", "down2", "whole"]


def test_a_circle_is_named():
    passes = [declare("a", ["y"], ["x"]), declare("b", ["x"], ["y"])]
    with pytest.raises(GraphError, match=r"circle: a, b"):
        schedule(passes, ["y"], lambda _: 1)


def test_transients_share_memory_only_when_apart_and_alike():
    lifetimes = {"a": (0, 1), "b": (2, 3), "c": (1, 2), "d": (2, 4)}
    slots = alias(lifetimes, lambda n: "big" if n == "d" else "small")
    assert slots["a"] == slots["b"]
    assert slots["a"] != slots["c"]
    assert slots["d"] not in (slots["a"], slots["c"])


@pytest.mark.parametrize("text", ["x@next", "x:level2", "x:mip", "x:mip1:foo"])
def test_bad_references_are_refused(text):
    with pytest.raises(GraphError):
        Ref.parse(text)
