"""The models' GPU passes: one indexed draw a model into the G-buffer, and the upload of what moved."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..gpu import FrameGraph, Struct
from .poses import PlacedModel, PlacedModels

if TYPE_CHECKING:
    from ..world.state import FrameState

MODELS_FRAME = Struct(
    "ModelsFrame",
    [
        ("tile", "vec3i", "256 m, tile of the camera in world axes"),
        ("local", "vec3f", "m, the camera from its tile's corner"),
    ],
)

INSTANCE = np.dtype([("columns", "<f4", (3, 4)), ("tile", "<i4", 4)])
"""64 bytes a copy, as `Instance` in draw.wesl."""

_COLOR = ("gbuffer.albedo", "gbuffer.normal", "gbuffer.surface", "gbuffer.motion")
_TILE = 256.0


def split(position: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """World coordinates as whole tiles (int32) and the rest (float32), (..., 3)."""
    tile = np.floor(position / _TILE)
    return tile.astype(np.int32), (position - tile * _TILE).astype(np.float32)


def pack_instances(transforms: np.ndarray) -> np.ndarray:
    """(n, 4, 4) float64 world from model -> (n,) of `INSTANCE`."""
    packed = np.zeros(len(transforms), INSTANCE)
    packed["columns"][:, :, :3] = transforms[:, :3, :3].transpose(0, 2, 1)
    packed["tile"][:, :3], packed["columns"][:, :, 3] = split(transforms[:, :3, 3])
    return packed


class Models:
    """Declares the models' resources and passes in a graph; nothing where a world has none.

    Parameters
    ----------
    graph : FrameGraph
        Must already hold the G-buffer.
    models : PlacedModels
    """

    def __init__(self, graph: FrameGraph, models: PlacedModels):
        self._draws = [_Draw(graph, model, i) for i, model in enumerate(models.values())] if models else []
        self._frame = graph.uniforms.get("models.frame")

    def update(self, state: FrameState) -> None:
        """Upload what has moved since the last frame."""
        if self._frame is None:
            return
        tile, local = split(state.camera.position)
        self._frame.set(tile=tile, local=local)
        for draw in self._draws:
            draw.update(state)


class _Draw:
    """One model's resources and its pass."""

    def __init__(self, graph: FrameGraph, placed: PlacedModel, number: int):
        if "models.frame" not in graph.uniforms:
            graph.uniform("models.frame", MODELS_FRAME)
        self._graph, self._placed = graph, placed
        self._name = f"models.{number}"
        self._count = 0
        self._uploaded: dict[str, np.ndarray] = {}
        self._packed: tuple[np.ndarray | None, np.ndarray] = (None, np.zeros(0, INSTANCE))
        loaded, name = placed.loaded, self._name
        graph.buffer_data(f"{name}.vertices", loaded.mesh.vertices)
        graph.buffer_data(f"{name}.indices", loaded.mesh.indices, usage=("index",))
        graph.buffer_data(f"{name}.materials", loaded.materials)
        for which in ("now", "before"):
            graph.buffer_data(f"{name}.{which}", np.zeros(placed.capacity, INSTANCE))
        maps = {"color_map": loaded.color, "normal_map": loaded.normal, "surface_map": loaded.surface}
        formats = {"color_map": "rgba8unorm-srgb", "normal_map": "rg8unorm", "surface_map": "rgba8unorm"}
        bind = {v: f"{name}.{v}" for v in ("vertices", "now", "before", "materials")}
        for which, array in maps.items():
            if array is not None:
                graph.texture_data(f"{name}.{which}", array, formats[which], dimension="2d-array", mips=True)
                bind[which] = f"{name}.{which}"
        graph.render(
            "models.gbuffer" if number == 0 else f"models.gbuffer.{number}",
            "package::models::draw",
            color=_COLOR,
            depth="gbuffer.depth",
            bind={"view": "view", "frame": "models.frame", "linear": "sampler:linear-repeat", **bind},
            index=f"{name}.indices",
            indices=len(loaded.mesh.indices),
            instances=lambda: self._count,
            cull="none" if True in loaded.sides else "back",
            structs=[MODELS_FRAME],
            flags={
                "COLOR_MAP": loaded.color is not None,
                "NORMAL_MAP": loaded.normal is not None,
                "SURFACE_MAP": loaded.surface is not None,
                "MASKED": loaded.masked,
                "MIXED_SIDES": len(loaded.sides) > 1,
            },
            order=-1,  # before the plants, which then need not be shaded where they hide them
        )

    def update(self, state: FrameState) -> None:
        """Upload the copies whose places differ from what the GPU holds."""
        now, before = self._placed.transforms(state)
        self._count = len(now)
        # "before" first: it was packed as the last frame's "now".
        for which, transforms in (("before", before), ("now", now)):
            if self._uploaded.get(which) is not transforms:
                if self._packed[0] is not transforms:
                    self._packed = (transforms, pack_instances(transforms))
                self._graph.upload(f"{self._name}.{which}", self._packed[1])
                self._uploaded[which] = transforms
