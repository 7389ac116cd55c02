"""The models' GPU passes: one indexed draw a model into the G-buffer, and the upload of what moved."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
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


@dataclass(frozen=True)
class Bounds:
    """Where all copies of a model are in a frame.

    Attributes
    ----------
    centres : (n, 3) float64
        Middles of the spheres around its copies, world axes, m.
    radius : float
        The largest sphere's, m.
    movable : bool
        Whether it goes along keyframes or is placed from Python: what it throws shadows on may change.
    transforms : (n, 4, 4) float64
        The same object as long as nothing moves.
    """

    centres: np.ndarray
    radius: float
    movable: bool
    transforms: np.ndarray


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

    def __len__(self) -> int:
        return len(self._draws)

    def bounds(self, state: FrameState) -> list[Bounds]:
        """Where the models are in a frame, in their order."""
        return [draw.bounds(state) for draw in self._draws]

    def add_casters(
        self,
        graph: FrameGraph,
        *,
        view: str,
        depth: str,
        chosen: Callable[[int], bool],
        order: float = 0.0,
    ) -> None:
        """Declare the passes that draw models into a map seen along the light.

        Parameters
        ----------
        view : name
            A uniform `View`, whose ``clip_from_world`` is the light's: parallel, depth 1 towards it.
        depth : name
        chosen : callable
            Number of a model -> whether it is drawn now.
        """
        for number, draw in enumerate(self._draws):
            draw.add_caster(graph, view, depth, lambda n=number: chosen(n), order)

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
        self._bounds: Bounds | None = None
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

    def add_caster(
        self, graph: FrameGraph, view: str, depth: str, when: Callable[[], bool], order: float
    ) -> None:
        """Declare its pass into a map of shadows."""
        loaded, name = self._placed.loaded, self._name
        masked = loaded.masked and loaded.color is not None
        bind = {"view": view, "frame": "models.frame", "linear": "sampler:linear-repeat"}
        bind |= {v: f"{name}.{v}" for v in ("vertices", "now", "materials")}
        graph.render(
            f"{depth}.{name}",
            "package::models::caster",
            depth=depth,
            bind=bind | {"color_map": f"{name}.color_map"},
            index=f"{name}.indices",
            indices=len(loaded.mesh.indices),
            instances=lambda: self._count,
            structs=[MODELS_FRAME],
            flags={"MASKED": masked},
            when=when,
            order=order,
        )

    def bounds(self, state: FrameState) -> Bounds:
        """See `Models.bounds`."""
        now, _ = self._placed.transforms(state)
        if self._bounds is None or self._bounds.transforms is not now:
            mesh = self._placed.loaded.mesh
            middle = np.append(0.5 * (mesh.low + mesh.high), 1.0)
            scale = np.linalg.norm(now[:, :3, :3], axis=1).max(initial=0.0)
            radius = 0.5 * float(np.linalg.norm(mesh.high - mesh.low)) * float(scale)
            self._bounds = Bounds((now @ middle)[:, :3], radius, self._placed.movable, now)
        return self._bounds

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
