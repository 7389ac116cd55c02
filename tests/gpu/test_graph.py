"""The frame graph on a device: histories, read-back, sometimes-passes, loss, limits, timing."""

from __future__ import annotations

import numpy as np
import pytest

from fallstreak.gpu import VIEW, Device, DeviceLostError, FrameGraph, GraphError, ShaderError

MODULE = "package::gpu::selftest"


def counter(device: Device, **options) -> FrameGraph:
    """A frame that adds one to what it was."""
    graph = FrameGraph(device)
    graph.texture("count", "r32float", (20, 10), history=True)
    graph.compute(
        "count",
        MODULE,
        entry="count",
        bind={"before": "count@previous", "after": "count"},
        groups=(3, 2, 1),
        **options,
    )
    graph.output("count")
    graph.compile()
    return graph


def test_a_history_remembers(device):
    graph = counter(device)
    for _ in range(5):
        graph.execute()
    np.testing.assert_array_equal(graph.read("count"), np.full((10, 20), 5, np.float32))
    np.testing.assert_array_equal(graph.read("count@previous"), np.full((10, 20), 4, np.float32))


def test_a_checkpoint_brings_a_history_back(device):
    first = counter(device)
    for _ in range(3):
        first.execute()
    state = first.checkpoint()
    again = counter(device)
    again.restore(state)
    again.execute()
    assert again.read("count").max() == 4
    with pytest.raises(GraphError, match="no history"):
        again.restore({"other": state["count"]})


def test_a_lost_device_is_told_and_a_new_one_goes_on():
    lost = Device.open()
    graph = counter(lost)
    graph.execute()
    state = graph.checkpoint()
    lost.destroy()
    with pytest.raises(DeviceLostError):
        graph.execute()
        graph.read("count")
    again = counter(Device.open())
    again.restore(state)
    again.execute()
    assert again.read("count").min() == 2


def test_reading_back_keeps_rows_apart(device):
    graph = FrameGraph(device)
    graph.texture("image", "rgba32float", (21, 13))
    graph.compute("image", MODULE, entry="gradient", bind={"gradient_image": "image"}, groups=(3, 2, 1))
    graph.output("image")
    graph.compile()
    graph.execute()
    early, late = graph.read_async("image"), graph.read_async("image")
    y, x = np.mgrid[:13, :21]
    for got in (late.result(), early.result(), early.result()):
        np.testing.assert_array_equal(got[..., 0], x)
        np.testing.assert_array_equal(got[..., 1], y)


def test_a_sometimes_pass_keeps_its_result_and_demands_persistence(device):
    with pytest.raises(GraphError, match="persistent"):
        counter(device, when=lambda: False)
    graph = FrameGraph(device)
    graph.texture("image", "rgba32float", (8, 8), persistent=True)
    graph.compute(
        "image",
        MODULE,
        entry="gradient",
        bind={"gradient_image": "image"},
        groups=(1, 1, 1),
        when=lambda: False,
    )
    graph.output("image")
    graph.compile()
    graph.execute()
    assert graph.stats()["passes"][0]["ran"] is True, "somebody outside wants it"
    graph.execute()
    assert graph.stats()["passes"][0]["ran"] is False
    assert graph.read("image")[3, 5, 0] == 5


def test_what_lasts_is_made_when_it_is_first_read(device):
    """A chain of two, the second of which nobody reads before the third frame."""
    graph, ran, wanted = FrameGraph(device), [], []
    for name in ("first", "second"):
        graph.buffer(name, 16, persistent=True)
    graph.buffer("result", 16)

    def add(name, reads, writes, when):
        graph.add_pass(name, reads=reads, writes=writes, record=lambda _: ran.append(name), when=when)

    add("first", [], ["first"], lambda: False)
    add("second", ["first"], ["second"], lambda: False)
    add("reader", ["second"], ["result"], lambda: bool(wanted))
    add("always", [], ["result"], None)
    graph.output("result")
    graph.compile()
    graph.execute()
    graph.execute()
    assert ran == ["always"] * 2
    wanted.append(True)
    graph.execute()
    graph.execute()
    assert ran[2:] == ["first", "second", "reader", "always", "reader", "always"]


def test_something_may_be_made_ahead_of_the_frame(device):
    graph, ran = FrameGraph(device), []
    graph.buffer("part", 16)
    graph.buffer("kept", 16, persistent=True)
    graph.buffer("result", 16)

    def add(name, reads, writes, when=None):
        graph.add_pass(name, reads=reads, writes=writes, record=lambda _: ran.append(name), when=when)

    add("part", [], ["part"])
    add("never", ["part"], ["kept"], lambda: False)
    add("keep", ["part"], ["kept"])
    add("after", ["kept", "part"], ["result"])
    graph.output("result")
    graph.compile()
    graph.make("kept")
    assert ran == ["part", "keep"]
    graph.execute()
    assert ran[2:] == ["part", "keep", "after"]


def test_making_ahead_leaves_histories_as_they_are(device):
    graph = counter(device)
    graph.execute()
    graph.make("count")
    graph.execute()
    assert graph.read("count").max() == 2


def test_a_pass_sees_in_its_turn_what_came_before_it(device):
    """Veils one under the other; a look between two of them, and one at the end."""
    graph = FrameGraph(device)
    for name in ("veils", "between", "after"):
        graph.texture(name, "rgba16float", (8, 8))
    for order in (0.0, 2.0):
        graph.fullscreen(f"veil{order}", MODULE, fragment="veil", color=["veils"], blend="under", order=order)
    for name, turn in (("between", ["veils"]), ("after", [])):
        graph.fullscreen(
            name, MODULE, fragment="look", color=[name], bind={"veils": "veils"}, in_turn=turn, order=1.0
        )
    graph.output("between", "after")
    graph.compile()
    graph.execute()
    seen = [np.array(graph.read(name)).view(np.float16).reshape(8, 8, 4) for name in ("between", "after")]
    assert (seen[0] == [0.25, 0.5, 0.0, 0.5]).all()
    assert (seen[1] == [0.375, 0.75, 0.0, 0.75]).all()


def test_equal_pipelines_are_made_once(monkeypatch):
    device, made = Device.open(), []
    make = device.native.create_compute_pipeline
    monkeypatch.setattr(
        device.native, "create_compute_pipeline", lambda **options: made.append(1) or make(**options)
    )
    graph = FrameGraph(device)
    for name in ("a", "b"):
        graph.texture(name, "rgba32float", (8, 8))
        graph.compute(name, MODULE, entry="gradient", bind={"gradient_image": name}, groups=(1, 1, 1))
    graph.output("a", "b")
    graph.compile()
    graph.execute()
    assert len(made) == 1
    np.testing.assert_array_equal(graph.read("a"), graph.read("b"))


def test_uniforms_upload_only_what_changed(device):
    graph = counter(device)
    assert graph.stats()["calls"] < 20
    lonely = FrameGraph(device)
    view = lonely.uniform("view", VIEW)
    assert view.set(time=1.0)
    view.take()
    assert not view.set(time=1.0)
    assert view.set(time=2.0)


def test_a_texture_of_data_is_overwritten(device):
    graph = FrameGraph(device)
    graph.texture_data("given", np.zeros((2, 3), np.float32), "r32float")
    graph.texture("after", "r32float", (3, 2))
    graph.compute(
        "after", MODULE, entry="count", bind={"before": "given", "after": "after"}, groups=(1, 1, 1)
    )
    graph.output("after")
    graph.compile()
    graph.execute()
    np.testing.assert_array_equal(graph.read("after"), 1.0)
    given = np.arange(6, dtype=np.float32).reshape(2, 3)
    graph.upload("given", given)
    graph.execute()
    np.testing.assert_array_equal(graph.read("after").squeeze(), given + 1.0)
    with pytest.raises(GraphError, match="do not fill"):
        graph.upload("given", given[0])


def test_mistakes_are_named(device):
    graph = FrameGraph(device)
    graph.texture("a", "rgba32float", (8, 8))
    with pytest.raises(GraphError, match="declared twice"):
        graph.texture("a", "rgba32float", (8, 8))
    with pytest.raises(GraphError, match="binds nothing to the shader's 'gradient_image'"):
        graph.compute("x", MODULE, entry="gradient", bind={}, groups=(1, 1, 1))
    with pytest.raises(GraphError, match="not declared"):
        graph.compute("x", MODULE, entry="gradient", bind={"gradient_image": "b"}, groups=(1, 1, 1))
    with pytest.raises(GraphError, match="keeps no history"):
        graph.compute("x", MODULE, entry="gradient", bind={"gradient_image": "a@previous"}, groups=(1, 1, 1))
    with pytest.raises(ShaderError, match="no_such"):
        graph.compute("x", "package::gpu::no_such", bind={}, groups=(1, 1, 1))
    graph.output("a")
    with pytest.raises(GraphError, match="written by no pass"):
        graph.compile()


def test_default_limits_are_what_we_get(device):
    limits = device.native.limits
    assert limits["max-bind-groups"] == 4
    assert limits["max-color-attachment-bytes-per-sample"] == 32
    assert limits["max-compute-invocations-per-workgroup"] == 256


def test_without_timestamps_gpu_times_are_absent():
    graph = counter(Device.open(capabilities=()))
    graph.execute()
    stats = graph.stats()
    assert stats["gpu_ms"] is None
    assert stats["passes"][0]["gpu_ms"] is None


def test_memory_is_counted_and_given_back(device):
    import gc

    gc.collect()
    before = device.texture_bytes
    graph = counter(device)
    assert device.texture_bytes - before == 2 * 20 * 10 * 4
    del graph
    gc.collect()
    assert device.texture_bytes == before


def test_of_passes_that_take_turns_only_the_one_that_says_yes_runs_first(device):
    """Else a first frame, or one after a resumption, would differ from the same frame in a sequence."""
    graph = FrameGraph(device)
    graph.texture("image", "rgba32float", (8, 8), persistent=True)
    for name, turn in (("day", True), ("night", False)):
        graph.compute(
            name,
            MODULE,
            entry="gradient",
            bind={"gradient_image": "image"},
            groups=(1, 1, 1),
            when=lambda turn=turn: turn,
        )
    graph.output("image")
    graph.compile()
    graph.execute()
    assert [p["ran"] for p in graph.stats()["passes"]] == [True, False]
