"""The field on the GPU: the pass that makes the clouds about the camera, what shaders bind to see them."""

from __future__ import annotations

from math import floor
from typing import TYPE_CHECKING, Any

import numpy as np

from ...gpu import FrameGraph
from ...world.state import map_coordinates
from . import volume
from .cells import Age
from .density import noise_axes
from .layers import FINER
from .model import Field
from .uniform import CLOUD_BYTES, CLOUD_FIELD, LAYERS

if TYPE_CHECKING:
    from ...world.quality import Quality
    from ...world.state import FrameState


class FieldPasses:
    """The field's buffers, textures and the pass ``clouds.cells``.

    Declares ``clouds.field`` (uniform), ``clouds.cells``, ``clouds.boxes``, ``clouds.models``,
    ``clouds.profiles`` (buffers), ``clouds.noise``, ``clouds.coverage`` (textures).

    Parameters
    ----------
    graph : FrameGraph
    field : Field
    quality : Quality
        For ``cloud_cells``, the width of each layer's window.
    ends : bool
        Whether nothing is drawn beyond the window, so that clouds must get fewer towards its end.

    Attributes
    ----------
    bind : dict
        The variables of ``resources.wesl`` and what to bind to them; a shader takes those it uses.
    structs, constants
        What modules that import it must be given.
    window : int
    """

    def __init__(self, graph: FrameGraph, field: Field, quality: Quality, *, ends: bool = False):
        self.field = field
        self.window = quality.cloud_cells
        count = len(field.layers)
        graph.buffer("clouds.cells", count * self.window**2 * CLOUD_BYTES)
        graph.buffer_data("clouds.boxes", field.packed.boxes)
        graph.buffer_data("clouds.models", field.packed.models)
        profiles = [np.stack([c.profile, c.filled], -1) for c in field.calibrations]
        outlines = [np.stack([row, row], -1) for row in field.outlines]
        graph.buffer_data(
            "clouds.profiles", np.concatenate([*np.concatenate(profiles), *outlines]).astype(np.float32)
        )
        graph.texture_data("clouds.noise", volume.volume(), "rgba8unorm", dimension="3d")
        plans = [plan.values for plan in field.maps if plan is not None]
        maps = np.stack(plans or [np.ones((1, 1), np.float32)]).astype(np.float32)
        graph.texture_data("clouds.coverage", maps, "r32float", dimension="2d-array")
        self._uniform = graph.uniform("clouds.field", CLOUD_FIELD)
        self._fixed = self._fixed_values()
        self.bind = {
            "field": "clouds.field",
            "clouds": "clouds.cells",
            "boxes": "clouds.boxes",
            "models": "clouds.models",
            "noise": "clouds.noise",
            "repeat": "sampler:linear-repeat",
            "profiles": "clouds.profiles",
            "coverage_maps": "clouds.coverage",
        }
        self.structs = [CLOUD_FIELD]
        self.constants = {"LAYERS": count, "WINDOW": self.window}
        groups = -(-self.window // 8)
        graph.compute(
            "clouds.cells",
            "package::clouds::field::cells_pass",
            bind={
                "made": "clouds.cells",
                "field": "clouds.field",
                "models": "clouds.models",
                "coverage_maps": "clouds.coverage",
            },
            groups=(groups, groups, count),
            structs=self.structs,
            constants={"WINDOW": self.window},
            flags={"ENDS": ends},
        )

    def update(self, state: FrameState) -> None:
        """Tell the shaders of the frame to be rendered."""
        self._uniform.set(**self.values(state))

    def values(self, state: FrameState) -> dict[str, np.ndarray]:
        """All fields of `CLOUD_FIELD` for a frame."""
        camera = np.array(map_coordinates(state.camera.position, state.planet_radius))
        values = {name: table.copy() for name, table in self._fixed.items()}
        for i, layer in enumerate(self.field.layers):
            drifting = camera - np.asarray(layer.wind) * state.time
            cell = np.floor(drifting / layer.cell)
            age = Age.of(layer, state.time)
            values["cells"][i, :2] = cell
            values["place"][i, :2] = drifting - cell * layer.cell
            values["life"][i, 0] = age.part
            values["words"][i] = *age.phases, *age.now
            values["next"][i, :2] = age.next
            along, across = (drifting @ axis for axis in noise_axes(layer))
            values["origin"][i] = [_rest(float(v)) for v in (along, across, FINER * along, FINER * across)]
            plan = self.field.maps[i]
            if plan is not None:
                values["map"][i] = *plan.place(*camera), *plan.per_metre
        return values

    def _fixed_values(self) -> dict[str, np.ndarray]:
        field = self.field
        kinds = {"cells": np.int32, "words": np.uint32, "next": np.uint32}
        out: dict[str, Any] = {
            name: np.zeros((LAYERS, 4), kinds.get(name, np.float64)) for name, _, _ in CLOUD_FIELD.fields
        }
        plans = 0
        for i, layer in enumerate(field.layers):
            genus, knots = layer.genus, field.calibrations[i].knots
            along, across = noise_axes(layer)
            way = np.cos(layer.towards), np.sin(layer.towards)
            out["cells"][i, 2:] = -1, len(layer.models)
            if field.maps[i] is not None:
                out["cells"][i, 2], plans = plans, plans + 1
            out["next"][i, 2:] = field.first[i], layer.seed
            out["place"][i, 2:] = layer.cell, genus.jitter
            out["life"][i, 1:] = layer.lifetime > 0.0, layer.coverage, layer.clustering
            out["size"][i] = *layer.radius, *layer.height
            out["base"][i] = layer.base, layer.base_spread, layer.extinction, layer.towards
            out["bounds"][i] = *layer.bounds, genus.aligned, layer.soft
            out["axes"][i] = *way, np.hypot(*along), np.hypot(*across)
            out["noise"][i] = genus.amplitude, genus.edge, genus.shear, layer.body
            out["look"][i] = genus.look
            out["widening"][i, :2] = layer.gap, 1.0 / np.log2(layer.blobs[1] / layer.blobs[0])
            out["knots_low"][i], out["knots_high"][i] = knots[1:5], knots[5:]
            blobs = field.calibrations[i].blobs
            out["blobs_low"][i], out["blobs_high"][i] = blobs[:4], blobs[4:]
        return out


def _rest(value: float) -> float:
    return value - floor(value)
