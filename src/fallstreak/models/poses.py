"""Where models are: from metres and degrees to matrices, from a scene's words or from Python each frame.

World space is east-north-up at the anchor (see ``world/state.py``), float64. A model's own axes are glTF's:
x to its left, y up, z forward. "World from model" is the 4 x 4 matrix that takes the one to the other.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from ..world.errors import UserError
from .model import LoadedModel, load_model

if TYPE_CHECKING:
    from ..world import World
    from ..world.models import Model
    from ..world.state import FrameState

KEPT = 128
"""Frames whose transforms are remembered, in case a lost GPU has to draw them again."""


def matrices(
    east: Any,
    north: Any,
    height: Any,
    heading: Any,
    pitch: Any,
    roll: Any,
    scale: Any,
    radius: float,
) -> np.ndarray:
    """World from model, for places on the curved planet.

    Parameters
    ----------
    east, north : array_like
        Map coordinates, m.
    height : array_like
        Above the sea-level sphere, m.
    heading, pitch, roll : array_like
        Radians; clockwise from north, nose up, right wing down.
    scale : array_like
    radius : float
        Of the planet, m.

    Returns
    -------
    (n, 4, 4) float64
    """
    given = (east, north, height, heading, pitch, roll, scale)
    east, north, height, heading, pitch, roll, scale = (
        np.ravel(a).astype(np.float64) for a in np.broadcast_arrays(*given)
    )
    distance = np.hypot(east, north)
    with np.errstate(invalid="ignore", divide="ignore"):
        ux, uy = np.where(distance > 0.0, (east / distance, north / distance), 0.0)
    angle = distance / radius
    s, less = np.sin(angle), -2.0 * np.sin(0.5 * angle) ** 2  # cos(angle) - 1 without cancellation

    def world(e: np.ndarray, n: np.ndarray, u: np.ndarray | float) -> tuple[np.ndarray, ...]:
        """From the place's east, north and up: the anchor's axes, carried along the great circle."""
        along = ux * e + uy * n
        lean = less * along + s * u
        return e + ux * lean, n + uy * lean, u + less * u - s * along

    sh, ch, sp, cp = np.sin(heading), np.cos(heading), np.sin(pitch), np.cos(pitch)
    sr, cr = scale * np.sin(roll), scale * np.cos(roll)
    result = np.zeros((len(east), 4, 4))
    columns = (
        (-ch * cr - sh * sp * sr, sh * cr - ch * sp * sr, cp * sr),  # left
        (ch * sr - sh * sp * cr, -sh * sr - ch * sp * cr, cp * cr),  # up
        (scale * sh * cp, scale * ch * cp, scale * sp),  # forward
    )
    for column, local in enumerate(columns):
        for row, value in enumerate(world(*local)):
            result[:, row, column] = value
    across = (radius + height) * s
    result[:, 0, 3], result[:, 1, 3] = across * ux, across * uy
    result[:, 2, 3] = height + (radius + height) * less
    result[:, 3, 3] = 1.0
    return result


class PlacedModel:
    """A model of the world: where it and its copies are, and the place to say so from Python.

    Attributes
    ----------
    name : str
    loaded : LoadedModel
    capacity : int
        How many copies there may be.
    """

    def __init__(self, model: Model, world: World, label: str):
        self.name = model.called
        self.loaded: LoadedModel = _load(model, label)
        self.capacity = max(model.capacity, len(model.instances))
        self._model, self._world, self._radius = model, world, world.planet.radius
        self._own = lru_cache(4)(self._scene_transforms)
        self._given: np.ndarray | None = None
        self._kept: dict[int, np.ndarray | None] = {}

    # ---- from Python -----------------------------------------------------------------------------------

    @property
    def transform(self) -> np.ndarray | None:
        """World from model, (n, 4, 4) float64, as set from Python; None while the scene decides.

        Set it between frames to one matrix (4, 4) or to (n, 4, 4), one for each copy: metres, world axes,
        no mirroring. It holds until it is set again; None gives the model back to the scene. The next frame
        draws it there, and its motion vectors lead from where it was in the frame before. When the number of
        copies changes, they start without motion.

        Raises
        ------
        ValueError
            For another shape, numbers that are not finite, a mirroring matrix, more copies than `capacity`.
        """
        return self._given

    @transform.setter
    def transform(self, value: Any) -> None:
        self._given = None if value is None else self._checked(np.array(value, np.float64))

    def place(
        self,
        *,
        east: Any = 0.0,
        north: Any = 0.0,
        height: Any = 0.0,
        heading: Any = 0.0,
        pitch: Any = 0.0,
        roll: Any = 0.0,
        scale: Any = 1.0,
        above: str = "ground",
    ) -> np.ndarray:
        """Set `transform` by the words of a scene file: metres and degrees; arrays make many copies.

        Parameters
        ----------
        east, north, height, heading, pitch, roll, scale : float or array_like
            As in ``[[models]]``; arrays broadcast together.
        above : "ground" or "sea"
            What `height` counts from.

        Returns
        -------
        (n, 4, 4) float64
            The new `transform`.
        """
        if above not in ("ground", "sea"):
            raise ValueError(f'above = {above!r} must be "ground" or "sea"')
        made = self._matrices(east, north, height, heading, pitch, roll, scale, above=above)
        self._given = self._checked(made, scale)
        return self._given

    def _checked(self, array: np.ndarray, scale: Any = None) -> np.ndarray:
        """The transforms, read-only from now on; with a `scale`, only rotations need no other look."""
        if array.ndim == 2:
            array = array[None]
        if array.ndim != 3 or array.shape[1:] != (4, 4):
            raise ValueError(f"the transform of {self.name!r} has the shape {array.shape}, not (n, 4, 4)")
        if len(array) > self.capacity:
            raise ValueError(
                f"{len(array):,} copies of {self.name!r} are too many: its capacity is {self.capacity:,}, "
                "and [[models]] capacity = … changes it"
            )
        if scale is None:
            x, y, z = (array[:, :3, i] for i in range(3))
            scale = np.einsum("ni,ni->n", x, np.cross(y, z))
        # A comparison with NaN is false, so this finds what is not finite too.
        if not (np.greater(scale, 0.0).all() and (np.abs(array) < 1e12).all()):
            raise ValueError(f"a transform of {self.name!r} is not finite, flat, or mirrors the model")
        array.flags.writeable = False
        return array

    @property
    def movable(self) -> bool:
        """Whether it goes along keyframes or is placed from Python."""
        return bool(self._model.keyframes) or self._given is not None

    # ---- for the frame ---------------------------------------------------------------------------------

    def latch(self, frame: int, fresh: bool) -> None:
        """Fix what Python has set as frame `frame`'s; `fresh`: nothing is known of the frames before it."""
        if fresh:
            self._kept.clear()
        self._kept[frame] = self._given
        for old in [f for f in self._kept if f <= frame - KEPT]:
            del self._kept[old]

    def at(self, frame: int, seconds: float) -> np.ndarray:
        """World from model in a frame, (n, 4, 4); the same object as long as nothing moves."""
        # Frames before the first one that Python saw (the warm-up) look as that one does.
        given = self._kept[frame if frame in self._kept else min(self._kept)] if self._kept else self._given
        if given is not None:
            return given
        return self._own(seconds if self._model.keyframes else 0.0)

    def transforms(self, state: FrameState) -> tuple[np.ndarray, np.ndarray]:
        """World from model now and in the frame before."""
        now = self.at(state.index, state.seconds)
        if state.previous_seconds == state.seconds:
            return now, now
        before = self.at(state.index - 1, state.previous_seconds)
        return now, before if len(before) == len(now) else now

    def _scene_transforms(self, seconds: float) -> np.ndarray:
        model = self._model
        poses = [model.at(seconds)] if model.keyframes else model.poses()
        columns = [(p.east, p.north, p.height, p.heading, p.pitch, p.roll, p.scale) for p in poses]
        return self._matrices(*np.array(columns).T, above=model.above)

    def _matrices(self, *pose: Any, above: str) -> np.ndarray:
        """From east, north, height, heading, pitch, roll and scale; metres and degrees."""
        east, north, height, heading, pitch, roll, scale = pose
        if above == "ground":
            height = np.asarray(height, np.float64) + self._world.terrain.height(east, north)
        heading, pitch, roll = np.radians(heading), np.radians(pitch), np.radians(roll)
        return matrices(east, north, height, heading, pitch, roll, scale, self._radius)


class PlacedModels(Mapping[str, PlacedModel]):
    """All models of a world by name: ``renderer.models["glider"].place(east=…, height=…)``."""

    def __init__(self, world: World):
        self._models: dict[str, PlacedModel] = {}
        for index, model in enumerate(world.models):
            self._models[model.called] = PlacedModel(model, world, f"models[{index}].file")

    def __getitem__(self, name: str) -> PlacedModel:
        if name not in self._models:
            known = ", ".join(self._models) or "none"
            raise KeyError(f"there is no model {name!r} in this world; there are: {known}")
        return self._models[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._models)

    def __len__(self) -> int:
        return len(self._models)

    def latch(self, frame: int, fresh: bool) -> None:
        """See `PlacedModel.latch`."""
        for model in self._models.values():
            model.latch(frame, fresh)


def _load(model: Model, label: str) -> LoadedModel:
    try:
        return load_model(model.path, model.file)
    except UserError as error:
        raise UserError(f"{label} = {error}") from None
