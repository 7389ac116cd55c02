"""Clouds that pass near the camera move in the picture by their distance: they neither smear nor ghost."""

from dataclasses import replace

import numpy as np

from fallstreak.frame.exposure import add_exposure_buffer
from fallstreak.frame.gbuffer import add_gbuffer
from fallstreak.frame.temporal import Temporal
from fallstreak.gpu import EXPOSURE
from fallstreak.world.state import view_values

from .cloud_stage import coded
from .probes import FLAGS, SIZE, new_graph, state
from .test_resolve import keep_exposure

DISTANCE = 100.0
PIXEL = 2 * np.tan(np.radians(25.0)) / SIZE[1] * DISTANCE  # m at that distance


def flown(device, opacity, frames=20):
    """A bright square of a cloud that the camera passes at 3 pixels a frame, resolved over frames."""
    graph = new_graph(device)
    add_exposure_buffer(graph)
    add_gbuffer(graph, SIZE)
    graph.texture("frame.hdr", "rgba16float", SIZE)
    # the plane of the square faces the camera: farther off aside
    x, y = np.meshgrid(np.arange(SIZE[0]) + 0.5 - SIZE[0] / 2, np.arange(SIZE[1]) + 0.5 - SIZE[1] / 2)
    away = np.sqrt(DISTANCE**2 + (PIXEL * x) ** 2 + (PIXEL * y) ** 2)
    graph.texture_data("clouds.layer", coded(1.0, 1.0, away, np.full(away.shape, opacity)), "rgba16float")

    def clear(context):
        depth = {
            "view": context.resource("gbuffer.depth").create_view(),
            "depth_clear_value": 0.0, "depth_load_op": "clear", "depth_store_op": "store",
        }  # fmt: skip
        context.encoder.begin_render_pass(color_attachments=[], depth_stencil_attachment=depth).end()

    graph.textures["gbuffer.depth"].usage |= 0x10  # an attachment
    graph.add_pass("stage.depth", writes=["gbuffer.depth"], record=clear, order=-1)
    graph.render(
        "pattern",
        "package::probe",
        vertex="near_triangle",
        fragment="mover",
        color=["frame.hdr", "gbuffer.motion"],
        bind={"view": "view"},
        constants={"SQUARE": 24.0},
        flags=dict.fromkeys(FLAGS, False),
    )
    resolve = Temporal(graph, SIZE, clouds=True)
    keep_exposure(graph)
    graph.output("frame.resolved", "frame.hdr")
    graph.compile()
    record = EXPOSURE.pack(scale=1.0, ev100=0.0, luminance=1.0, pre_scale=1.0)
    graph.restore({"frame.exposure": np.frombuffer(record, np.uint8)})
    for index in range(frames):
        now = state(index)
        before = replace(now.camera, position=now.camera.position + np.array([3 * PIXEL, 0.0, 0.0]))
        graph.uniforms["view"].set(**view_values(replace(now, previous_camera=before)))
        resolve.update(reset=index == 0)
        graph.execute()
    return graph.read("frame.resolved")[..., 0].astype(float), graph.read("frame.hdr")[..., 0].astype(float)


def test_near_clouds_stay_sharp_in_flight(device):
    with_distance, sharp = flown(device, 1.0)
    without, _ = flown(device, 0.0)
    inside = (slice(16, 48), slice(50, 110))
    error = np.abs(with_distance - sharp)[inside].mean()
    assert error < 0.2 * np.abs(without - sharp)[inside].mean()
    assert error < 0.02
