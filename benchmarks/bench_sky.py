"""The air: transmittance against published numbers, what a frame's sky costs, our sky beside another's."""

import json
import os
import time
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path

import numpy as np

from fallstreak.gpu import EXPOSURE, VIEW, Device, FrameGraph
from fallstreak.sky import model, tables
from fallstreak.sky.air import Air
from fallstreak.sky.ephemeris import Ephemeris
from fallstreak.sky.passes import Sky
from fallstreak.world import QUALITY, World
from fallstreak.world.state import CameraState, FrameState, camera_rotation, view_values

NOON = datetime(2024, 6, 21, 12, tzinfo=UTC)
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
SIZE = (640, 360)
STILL = ("sky.transmittance", "sky.multiscattering", "sky.skylight")
TABLES = ("sky.view_table", "sky.aerial_inscatter", "sky.irradiance")


def run(report):
    device = Device.open()
    _transmittance(report, device)
    _cost(report, device)
    _beside_mitsuba(report, device)


def _transmittance(report, device):
    """The table of Bruneton 2017's clear air at 680 and 550 nm, read as the shaders read it."""
    air = Air()
    stage = Stage(device, World(), ("sky.transmittance",), (16, 16))
    stage.graph.uniforms["sky.air"].set(**air.uniform())
    stage.frame()
    table = stage.graph.read("sky.transmittance")[..., :3]
    zenith = np.array([0, 30, 60, 75, 80, 85, 88, 90])
    mu = np.cos(np.radians(zenith))
    found = tables.bilinear(table, *tables.transmittance_from_place(air, np.zeros(len(mu)), mu))
    error = 100 * np.abs(found / model.transmittance(air, 0.0, mu) - 1)[:, :2]
    how = "256x64 half floats, bilinear, ground to space, 680 and 550 nm, against float64 quadrature"
    report.add("transmittance, worst to 85°", error[:6].max(), "%", goal="<= 0.5", how=how)
    report.add("transmittance, worst at 88° and 90°", error[6:].max(), "%", goal="<= 2", how=how)


def _cost(report, device):
    """Wall clock of whole frames with some outputs only: the graph drops the rest."""
    world = World(sky={"stars": False, "moon": False})
    how = f"{SIZE[0]}x{SIZE[1]}, {device.adapter.name}"
    how += ", lower quartile of 60 frames, each waited for"
    parts = {}
    for name, outputs in (
        ("nothing", ("gbuffer.depth",)),  # cleared by the bench for the sky to draw into
        ("view table 192x108", ("sky.view_table", "gbuffer.depth")),
        ("aerial perspective 32x32x32", ("sky.aerial_inscatter", "gbuffer.depth")),
        ("irradiance", ("sky.irradiance", "gbuffer.depth")),
        ("all tables", (*TABLES, "gbuffer.depth")),
        ("all", (*TABLES, "frame.hdr")),
    ):
        parts[name] = _frame_time(Stage(device, world, outputs))
    idle = parts.pop("nothing")
    for name in ("view table 192x108", "aerial perspective 32x32x32", "irradiance"):
        report.add(f"sky: {name}", max(parts[name] - idle, 0.0), "ms", how=how)
    report.add("sky: drawing it", max(parts["all"] - parts["all tables"], 0.0), "ms", how=how)
    report.add("sky: cost per frame", parts["all"] - idle, "ms", goal="<= 11", how=how + ", high")
    if device.adapter.kind == "CPU":
        spent = _processor_time(Stage(device, world, (*TABLES, "frame.hdr")))
        spent -= _processor_time(Stage(device, world, ("gbuffer.depth",)))
        how = f"{SIZE[0]}x{SIZE[1]}, high, best of 8 means of 10 frames; blind to what else the machine does"
        report.add("sky: processor time per frame over cores", spent, "ms", goal="<= 11", how=how)


def _frame_time(stage, count=60):
    stage.frame()
    times = []
    for _ in range(count):
        start = time.perf_counter()
        stage.graph.execute()
        stage.graph.read("frame.exposure")
        times.append(1e3 * (time.perf_counter() - start))
    return sorted(times)[count // 4]


# What of the aerosol by Preetham's formula brings our skies nearest to the emitter's; docs/sky.md says more.
AEROSOL_SHARE, ASYMMETRY, HALO = 0.3, 0.68, 20.0


def _processor_time(stage):
    """CPU time of all threads over the number of cores, ms a frame."""
    stage.frame()
    stage.graph.read("frame.exposure")
    means = []
    for _ in range(8):
        start = time.process_time()
        for _ in range(10):
            stage.graph.execute()
            stage.graph.read("frame.exposure")
        means.append(1e3 * (time.process_time() - start) / 10 / (os.cpu_count() or 1))
    return min(means)


def _beside_mitsuba(report, device):
    """Shape of the dome beside Hosek and Wilkie's fit: ours over theirs, over the median of that."""
    data = json.loads((Path(__file__).parent / "data" / "sunsky.json").read_text())
    mu, azimuth = np.cos(np.radians(data["zenith"]))[:, None], np.radians(data["azimuth_from_sun"])
    for sky in data["skies"]:
        stage = Stage(device, _hazy(sky["turbidity"]), ("sky.view_table",))
        stage.frame(elevation=sky["elevation"])
        ours = stage.luminance(mu + 0 * azimuth, np.cos(azimuth) + 0 * mu) @ LUMINANCE
        ratio = ours / (np.array(sky["luminance"]) @ LUMINANCE)
        mu_sun = np.sin(np.radians(sky["elevation"]))
        nu = mu * mu_sun + np.sqrt((1 - mu**2) * (1 - mu_sun**2)) * np.cos(azimuth)
        far = nu < np.cos(np.radians(HALO))  # the halo is a matter of the aerosol's phase function
        difference = np.where(far, 100 * np.abs(ratio / np.median(ratio[far]) - 1), 0)
        name = f"sky beside Mitsuba's, sun {sky['elevation']:g}°, turbidity {sky['turbidity']:g}"
        how = f"luminance over the dome, 56 directions less those within {HALO:g}° of the sun; {data['how']}"
        report.add(name + ": median difference", float(np.median(difference[far])), "%", how=how)
        worst = np.unravel_index(np.argmax(difference), ratio.shape)
        where = f"at zenith {data['zenith'][worst[0]]:g}°, azimuth {data['azimuth_from_sun'][worst[1]]:g}°"
        how = f"{100 * np.mean(difference[far] > 25):.0f} % of directions differ by more than 25 %; {how}"
        report.add(name + ": largest", float(difference.max()), "%", how=f"{where}; {how}")


def _hazy(turbidity):
    """A world of a turbidity after Preetham et al. 1999: Ångström's β at 1 µm, falling with λ^1.3."""
    depth = AEROSOL_SHARE * (0.04608 * turbidity - 0.04586) * np.array([0.68, 0.55, 0.44]) ** -1.3
    extinction = tuple(float(v) for v in depth / 1200.0)
    return World(
        sky={
            "mie_extinction": extinction,
            "mie_scattering": tuple(0.95 * v for v in extinction),
            "mie_g": (ASYMMETRY,) * 3,
            "phase": "henyey_greenstein",
        }
    )


class Stage:
    """The sky alone in a graph, with some of its results asked for."""

    def __init__(self, device, world, outputs, size=SIZE):
        self.world, self.device, self.size = world, device, size
        self.graph = graph = FrameGraph(device)
        self.view = graph.uniform("view", VIEW)
        graph.texture("frame.hdr", "rgba16float", size)
        graph.texture("gbuffer.depth", "depth32float", size)
        graph.buffer("frame.exposure", EXPOSURE.size, history=True)
        graph.add_pass("bench.depth", writes=["gbuffer.depth"], record=self._clear, order=-1)
        graph.add_pass("bench.exposure", writes=["frame.exposure"], record=self._expose, order=50)
        self.sky = Sky(device, graph, world, QUALITY["high"], size)
        graph.output("frame.exposure", *outputs)
        graph.compile()
        self._heavens = Ephemeris(0.6, 0.0, refraction=False).at(NOON)

    def _clear(self, context):
        attachment = {
            "view": context.resource("gbuffer.depth").create_view(),
            "depth_clear_value": 0.0,
            "depth_load_op": "clear",
            "depth_store_op": "store",
        }
        context.encoder.begin_render_pass(color_attachments=[], depth_stencil_attachment=attachment).end()

    def _expose(self, context):
        data = EXPOSURE.pack(scale=1e-4, ev100=0.0, luminance=1.0, pre_scale=1e-4)
        self.device.queue.write_buffer(context.resource("frame.exposure"), 0, data)

    def frame(self, elevation=30.0):
        """One frame from eye height, looking at the horizon below the sun."""
        e = np.radians(elevation)
        heavens = replace(self._heavens, sun_direction=np.array([0.0, -np.cos(e), np.sin(e)]))
        rotation = camera_rotation(np.pi, np.radians(25.0), 0.0, np.eye(3))
        camera = CameraState(np.array([0.0, 0.0, 1.7]), rotation, np.radians(50.0))
        state = FrameState(0, 0.0, NOON, 0.0, 0, self.size, self.world.planet.radius, camera, camera)
        self.view.set(**view_values(state))
        self.sky.shine(heavens, 1.7)
        self.graph.execute()

    def luminance(self, mu, cos_azimuth):
        """cd/m² of the view table in directions."""
        table = self.graph.read("sky.view_table")[..., :3].astype(float)
        air = Air.of(self.world)
        scale = float(self.graph.uniforms["sky.light"].record["table_scale"])
        u, v = tables.view_from_direction(air, 1.7, mu, cos_azimuth, table.shape[0])
        return tables.bilinear(table, u, v) / scale
