"""Many frames become one: exactly their mean for stills, nearly it and without ghosts for moving pictures."""

import numpy as np
import pytest

from fallstreak.frame import bloom
from fallstreak.frame.accumulate import Accumulate, still_jitter
from fallstreak.frame.exposure import add_exposure_buffer
from fallstreak.frame.gbuffer import add_gbuffer
from fallstreak.frame.temporal import Temporal, sequence_jitter
from fallstreak.gpu import EXPOSURE
from fallstreak.world.film import Film
from fallstreak.world.quality import QUALITY

from .probes import FLAGS, SIZE, new_graph, picture, set_view


class Stage:
    """A drawn pattern, resolved over frames."""

    def __init__(self, device, pattern, resolve, **options):
        self.graph = new_graph(device)
        add_exposure_buffer(self.graph)
        add_gbuffer(self.graph, SIZE)
        self.graph.texture("frame.hdr", "rgba16float", SIZE)
        self.graph.render(
            "pattern",
            "package::probe",
            vertex="near_triangle",
            fragment=pattern,
            color=["frame.hdr", "gbuffer.motion"],
            depth="gbuffer.depth",
            bind={"view": "view"},
            constants={"SQUARE": 24.0},
            flags=dict.fromkeys(FLAGS, False),
        )
        self.resolve = resolve(self.graph, SIZE, **options)
        self.graph.buffer("exposure.source", EXPOSURE.size)
        self.graph.output("frame.resolved", "frame.hdr")
        keep_exposure(self.graph)
        self.graph.compile()
        record = EXPOSURE.pack(scale=1.0, ev100=0.0, luminance=1.0, pre_scale=1.0)
        self.graph.restore({"frame.exposure": np.frombuffer(record, np.uint8)})

    def frame(self, index, jitter, seed=1, **update):
        set_view(self.graph, index=index, jitter=jitter, seed=seed)
        self.resolve.update(**update)
        self.graph.execute()
        return self.graph.read("frame.resolved")[..., 0].astype(float)


def keep_exposure(graph):
    """Last frame's exposure is also this one's."""

    def copy(ctx):
        ctx.encoder.copy_buffer_to_buffer(
            ctx.resource("frame.exposure@previous"), 0, ctx.resource("frame.exposure"), 0, EXPOSURE.size
        )

    graph.add_pass("exposure.keep", reads=["frame.exposure@previous"], writes=["frame.exposure"], record=copy)
    graph.output("frame.exposure")


def supersampled(device, pattern, index=0, n=144):
    stage = Stage(device, pattern, Accumulate)
    side = int(n**0.5)
    for i in range(n):
        shift = ((i % side + 0.5) / side - 0.5, (i // side + 0.5) / side - 0.5)
        got = stage.frame(index, shift, sample=i)
    return got


def test_accumulation_is_the_mean(device):
    stage = Stage(device, "checker", Accumulate)
    seen = []
    for i in range(7):
        resolved = stage.frame(0, still_jitter(i, 7), sample=i)
        seen.append(stage.graph.read("frame.hdr")[..., 0].astype(float))
    mean = np.mean(seen, 0)
    assert np.abs(resolved - mean).max() < 1e-3  # half floats
    exact = stage.graph.read("frame.accumulation")[..., 0]
    assert np.abs(exact - mean).max() < 1e-6
    # sample 0 begins anew
    assert np.array_equal(
        stage.frame(0, (0.0, 0.0), sample=0), stage.graph.read("frame.hdr")[..., 0].astype(float)
    )


def test_jitters_are_spread_and_centred():
    for points in (
        np.array([still_jitter(i, 64) for i in range(64)]),
        np.array([sequence_jitter(i) for i in range(16)]),
    ):
        assert np.abs(points.mean(0)).max() < 0.04
        assert np.abs(points).max() < 0.8
        assert len({(x > 0, y > 0) for x, y in points}) == 4
    assert still_jitter(0, 1) == (0.0, 0.0)
    assert sequence_jitter(-3) == sequence_jitter(13)


@pytest.mark.parametrize("fast", [True, False])
def test_temporal_comes_to_the_supersampled_picture(device, fast):
    reference = supersampled(device, "checker")
    stage = Stage(device, "checker", Temporal, fast=fast)
    aliased = stage.frame(0, (0.0, 0.0), reset=True)
    for i in range(48):
        resolved = stage.frame(i + 1, sequence_jitter(i))
    before = np.sqrt(np.mean((aliased - reference) ** 2))
    after = np.sqrt(np.mean((resolved - reference) ** 2))
    assert after < 0.35 * before
    # and stays there: no flicker between frames
    following = stage.frame(50, sequence_jitter(48))
    assert np.abs(following - resolved).mean() < 0.01


@pytest.mark.parametrize("fast", [True, False])
def test_temporal_leaves_no_ghost(device, fast):
    stage = Stage(device, "mover", Temporal, fast=fast)
    for i in range(20):
        resolved = stage.frame(i, sequence_jitter(i), reset=i == 0)
    reference = supersampled(device, "mover", index=19)
    edge = 8 + 3 * 19
    # where the bright square has been and gone, more than its own soft edge away
    trail = resolved[22:42, : edge - 2]
    assert np.abs(trail - 0.05).max() < 0.02
    ahead = resolved[22:42, edge + 24 + 3 :]
    assert np.abs(ahead - 0.05).max() < 0.02
    inside = resolved[24:40, edge + 2 : edge + 22]
    assert np.abs(inside - 4.0).max() < 0.1
    assert np.sqrt(np.mean((resolved - reference) ** 2)) < 0.2


def test_temporal_runs_alike(device):
    def run():
        stage = Stage(device, "mover", Temporal)
        return [stage.frame(i, sequence_jitter(i), reset=i == 0) for i in range(6)][-1]

    assert np.array_equal(run(), run())


def test_temporal_follows_a_change_of_exposure(device):
    """History was written under another exposure than the one it is read under."""
    stage = Stage(device, "checker", Temporal)
    for i in range(12):
        resolved = stage.frame(i, sequence_jitter(i), reset=i == 0)
    record = EXPOSURE.pack(scale=3.0, ev100=0.0, luminance=1.0, pre_scale=1.0)
    stage.graph.restore({"frame.exposure": np.frombuffer(record, np.uint8)})
    brighter = stage.frame(12, sequence_jitter(12), seed=3)
    # a tenth of it is new samples of the edges
    assert np.abs(brighter / 3 - resolved).mean() < 0.01
    assert np.abs(brighter / 3 - resolved).max() < 0.25


@pytest.mark.parametrize("quality", ["high", "low"])
def test_bloom_spreads_but_keeps_the_light(device, quality):
    data = np.full((72, 128, 3), 0.01)
    data[34:38, 62:66] = 8.0
    graph = new_graph(device)
    size = picture(graph, data, "frame.resolved")
    name = bloom.add_bloom(graph, Film(bloom=0.1), QUALITY[quality], size)
    graph.output(name)
    graph.compile()
    graph.execute()
    spread = graph.read(name)[..., :3].astype(float)
    first = QUALITY[quality].bloom_first
    assert spread.shape[:2] == (72 >> first, 128 >> first)
    spread = np.kron(spread, np.ones((first, first, 1)))  # as fine as a half of the picture
    # but for the damping of very bright taps
    assert spread.mean() == pytest.approx(data.mean(), rel=0.05 * first)
    row = spread[17, :, 0]
    assert row[32] > row[40 if first == 1 else 36] > 0.0101
    # about as far up as across
    assert spread[17 + 8, 32, 0] == pytest.approx(spread[17, 31 + 8, 0], rel=0.25)


def test_no_bloom_costs_nothing(device):
    graph = new_graph(device)
    assert bloom.add_bloom(graph, Film(bloom=0.0), QUALITY["low"], SIZE) is None
