"""The renderer end to end: deterministic, resumable, and not to be stopped by a lost GPU."""

from __future__ import annotations

import numpy as np
import pytest

import fallstreak as fs
from fallstreak.gpu import GpuError

SIZE = (96, 54)


@pytest.fixture(scope="module")
def flight():
    """A camera that moves and turns over the shipped land, in the evening."""
    keyframes = [
        {"at": 0, "heading": 250, "height": 300},
        {"at": 1, "heading": 262, "height": 340, "east": 500},
    ]
    return fs.load("jacksboro").updated({"camera.keyframes": keyframes, "time_scale": 60})


@pytest.fixture(scope="module")
def reference(flight):
    """Its first frames, undisturbed."""
    with fs.Renderer(flight, SIZE, "low") as renderer:
        assert renderer.temporal
        return [renderer.render(i).ldr for i in range(8)]


def test_frames_in_flight_equal_frames_awaited(flight, reference):
    with fs.Renderer(flight, SIZE, "low") as renderer:
        pending = [renderer.submit(i) for i in range(4)]
        for want, got in zip(reference, pending, strict=False):
            np.testing.assert_array_equal(got.result().ldr, want)


def test_a_lost_device_leaves_no_trace(flight, reference):
    with fs.Renderer(flight, SIZE, "low") as renderer:
        got = []
        for i in range(8):
            if i == 4:
                renderer.device.destroy()
            got.append(renderer.render(i).ldr)
    np.testing.assert_array_equal(got, reference)


def test_a_device_lost_while_frames_are_in_flight_leaves_no_trace(flight, reference):
    with fs.Renderer(flight, SIZE, "low") as renderer:
        early = [renderer.submit(i) for i in range(3)]
        renderer.device.destroy()
        late = [renderer.submit(i) for i in range(3, 5)]
        got = [p.result().ldr for p in early + late]
    np.testing.assert_array_equal(got, reference[:5])


def test_a_device_lost_after_many_frames_goes_on_from_the_kept_state(flight, monkeypatch):
    import fallstreak.frame.renderer as module

    monkeypatch.setattr(module, "CHECKPOINT_EVERY", 2)
    with fs.Renderer(flight, SIZE, "low") as renderer:
        want = [renderer.render(i).ldr for i in range(8)]
    with fs.Renderer(flight, SIZE, "low") as renderer:
        for i in range(7):
            renderer.render(i)
        assert len(renderer._log) < 7, "old frames need not be replayed"
        renderer.device.destroy()
        np.testing.assert_array_equal(renderer.render(7).ldr, want[7])


def test_a_checkpoint_continues_elsewhere(flight, reference):
    with fs.Renderer(flight, SIZE, "low") as renderer:
        for i in range(4):
            renderer.render(i)
        state = renderer.checkpoint()
    with fs.Renderer(flight, SIZE, "low") as renderer:
        renderer.restore(state)
        for i in range(4, 8):
            np.testing.assert_array_equal(renderer.render(i).ldr, reference[i])


def test_a_jump_begins_anew(flight, reference):
    with fs.Renderer(flight, SIZE, "low") as renderer:
        renderer.render(30)
        np.testing.assert_array_equal(renderer.render(0).ldr, reference[0])


def test_a_still_survives_a_lost_device(flight):
    want = fs.render(flight, SIZE, "low", samples=3)
    with fs.Renderer(flight, SIZE, "low", still=True, samples=3, layers=("hdr",)) as renderer:
        renderer.device.destroy()
        got = renderer.render()
    np.testing.assert_array_equal(got.ldr, want.ldr)
    np.testing.assert_array_equal(got.hdr, want.hdr)


def test_a_closed_renderer_does_not_come_back(flight):
    with fs.Renderer(flight, SIZE, "low") as renderer:
        pass
    with pytest.raises(GpuError, match="closed"):
        renderer.render(0)


def test_layers_are_metric(flight):
    frame = fs.render(flight, SIZE, "low", layers=("hdr", "depth", "normal", "albedo", "motion"))
    land = np.isfinite(frame.depth)
    assert 0.2 < land.mean() < 0.95
    assert frame.depth[land].min() > 1.0
    np.testing.assert_allclose(np.linalg.norm(frame.normal[land], axis=-1), 1.0, atol=1e-3)
    assert not frame.normal[~land].any()
    assert frame.hdr.dtype == np.float32
    assert np.isfinite(frame.hdr).all()
    assert (frame.hdr >= 0).all()
    assert 1.0 < np.median(frame.hdr) < 2e4, "an evening, in cd/m²"
    assert 0.01 < frame.albedo[land].mean() < 0.4


def test_a_frame_holds_light_depth_and_normals_unasked(flight):
    frame = fs.render(flight, SIZE, "low", samples=1)
    assert frame.ldr.shape == frame.hdr.shape == frame.normal.shape == (54, 96, 3)
    assert frame.depth.shape == (54, 96)
    assert frame.stats["passes"]
    assert frame.albedo is None and frame.motion is None


def test_exposure_does_not_touch_the_luminance(flight):
    bright = fs.render(flight.updated({"film.compensation": 2}), SIZE, "low", samples=1)
    dark = fs.render(flight.updated({"film.compensation": -2}), SIZE, "low", samples=1)
    assert bright.ldr.mean() > 1.5 * dark.ldr.mean()
    np.testing.assert_allclose(bright.hdr.mean(), dark.hdr.mean(), rtol=2e-3)


def test_calls_and_stats(flight):
    with fs.Renderer(flight, SIZE, "low") as renderer:
        renderer.render(0)
        stats = renderer.stats()
    assert stats["calls"] < 300
    assert {"frame.lighting", "frame.tonemap"} <= {p["name"] for p in stats["passes"]}
    assert stats["texture_bytes"] > 0


def test_passes_that_share_one_of_the_gpus_draw_the_same(flight):
    """And cost fewer calls; the time of each is only known where none share."""
    pictures, calls, unknown = [], [], []
    for pass_times in (False, True):
        with fs.Renderer(flight, SIZE, "low") as renderer:
            renderer.pass_times = pass_times
            pictures.append(renderer.render(0).ldr)
            stats = renderer.stats()
            calls.append(stats["calls"])
            ran = [p["gpu_ms"] for p in stats["passes"] if p["ran"]]
            unknown.append(ran.count(None))
            if pass_times and stats["gpu_ms"] is not None:
                assert sum(ran) == pytest.approx(stats["gpu_ms"])
    np.testing.assert_array_equal(*pictures)
    assert calls[0] < calls[1]
    assert unknown[0] > 2
    assert unknown[1] in (0, len(ran))  # all of them without timestamps


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"size": (4, 4)}, "16 to 8192"),
        ({"quality": "best"}, "low, medium, high, ultra"),
        ({"layers": ("z",)}, "unknown"),
        ({"samples": 0}, "1 to 65536"),
        ({"fps": 0}, "above 0"),
        ({"bits": 12}, "8 or 16"),
        ({"size": "640x360"}, "two whole numbers"),
        ({"size": (64.5, 36)}, "two whole numbers"),
    ],
)
def test_bad_options_are_refused_in_a_sentence(flight, options, words):
    with pytest.raises(ValueError, match=words):
        fs.Renderer(flight, **options)
