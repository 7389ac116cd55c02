"""The GPU passes of the puffs."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ...gpu import VIEW, FrameGraph
from ...world.state import FrameState, map_coordinates
from ..frame import CLOUD_FRAME
from ..grain import grain
from ..order import add_order
from ..shadow import CLOUD_SHADOW
from .levels import FLAT_ROWS, SIZES, Grid, Slab, fineness_of, grid_struct, grid_values, grids, looks, reaches

if TYPE_CHECKING:
    from ..passes import Clouds

MOST_BLOCKS = 32768
MOST_FOUND = 65536
MOST_DRAWN = 30000
MOST_WANTED = 18000  # where clouds are dense, more are in sight
PUFF_BYTES = 272
_VERTICES = 3  # of a puff: a triangle about its disc
_MATTER = "package::clouds::puffs::matter"


class Puffs:
    """Clouds of puffs in a frame graph.

    Parameters
    ----------
    graph : FrameGraph
    clouds : Clouds
        With its field.

    Attributes
    ----------
    grids : list of Grid
        What the last frame looked at.
    """

    def __init__(self, graph: FrameGraph, clouds: Clouds):
        field = clouds.field.field
        slabs = tuple(
            _slab(layer, found.filled) for layer, found in zip(field.layers, field.calibrations, strict=True)
        )
        # puffs along a side of a bucket: their number goes with the square
        number = clouds.quality.cloud_puffs * clouds.world.clouds.puffs.density**2
        self._pieces = PuffPasses(
            graph,
            slabs,
            size=clouds.size,
            number=min(number, MOST_WANTED),
            matter=_MATTER,
            bind=clouds.field.bind,
            structs=clouds.field.structs,
            constants=clouds.field.constants,
            shadow=clouds.shadow is not None,
        )
        self._visibility = float(clouds.world.clouds.visibility)

    @property
    def grids(self) -> list[Grid]:
        return self._pieces.grids

    def update(self, state: FrameState) -> None:
        """Find which sizes of puffs a frame needs."""
        self._pieces.update(state, self._visibility)

    def counts(self) -> dict[str, int]:
        """Of the last frame, see `PuffPasses.counts`."""
        return self._pieces.counts()


def _slab(layer: Any, filled: np.ndarray) -> Slab:
    """What puffs need to know of a layer; `filled` by coverage and height, see `field.Calibration`."""
    genus = layer.genus
    along = np.array([np.cos(layer.towards), np.sin(layer.towards)]) / genus.stretch
    low, high = layer.bounds
    below = filled[len(filled) // 2] / filled[len(filled) // 2, -1]
    core = np.interp([0.02, 0.93], below, np.linspace(low, high, len(below)))
    return Slab(
        low,
        high,
        layer.extinction,
        layer.wind,
        layer.seed & 0xFFFFFFFF,
        core=(float(core[0]), float(core[1])),
        soft=max(layer.base_spread, 0.5 * layer.soft),
        cover=layer.coverage,
        look=genus.look,
        body=layer.body,
        across=_across(layer),
        along=(float(along[0]), float(along[1])),
    )


def _across(layer: Any) -> float:
    """Mean half width of the boxes of a layer's clouds, m."""
    radius = 0.5 * (layer.radius[0] + layer.radius[1])
    shares = [float(m.boxes["half"][:, :2].mean()) / m.radius for m in layer.models]
    return radius * sum(shares) / len(shares)


class PuffPasses:
    """The passes over whichever matter: `Puffs` gives them the field, tests what they know the answer of.

    Parameters
    ----------
    graph : FrameGraph
        Holds ``view``, ``clouds.frame``, ``clouds.layer`` and ``gbuffer.depth``.
    slabs : tuple of Slab
        The layers.
    size : (int, int)
        Of ``clouds.layer``.
    number : float
        Of puffs to be in sight, about.
    matter : str
        WESL module with `layer_mean_extinction`.
    bind, structs, constants
        What that module needs.
    shadow : bool
        Whether there is a map of the clouds' shadows.
    everywhere : bool
        Also what is out of sight, to count what buckets save.
    """

    def __init__(
        self,
        graph: FrameGraph,
        slabs: tuple[Slab, ...],
        *,
        size: tuple[int, int],
        number: float,
        matter: str,
        bind: dict[str, str] | None = None,
        structs: Any = (),
        constants: dict[str, Any] | None = None,
        shadow: bool = False,
        everywhere: bool = False,
    ):
        self._graph = graph
        self.slabs = slabs
        self.grids: list[Grid] = []
        self._number = number
        self._count = len(slabs) * len(SIZES)
        struct = grid_struct(self._count)
        self._uniform = graph.uniform("clouds.puffs.grids", struct)
        structs = [VIEW, CLOUD_FRAME, CLOUD_SHADOW, struct, *structs]
        constants = {
            "FLAT_ROWS": FLAT_ROWS,
            "MOST_BLOCKS": MOST_BLOCKS,
            "MOST_FOUND": MOST_FOUND,
            "MOST_DRAWN": MOST_DRAWN,
            "VERTICES": _VERTICES,
            "LAYER_SIZE": size,
            "MATTER": matter,
            "GRAINS": float(2 * len(slabs)),
            **(constants or {}),
        }
        common: dict[str, Any] = {"structs": structs, "constants": constants}
        lattice = {"view": "view", "frame": "clouds.frame", "grids": "clouds.puffs.grids"}
        counts = {
            "block_count": "clouds.puffs.block_count",
            "found": "clouds.puffs.found",
            "draw": "clouds.puffs.arguments",
        }
        graph.buffer("clouds.puffs.block_count", 32, usage=("indirect",), persistent=True)
        graph.buffer("clouds.puffs.arguments", 32, usage=("indirect",), persistent=True)
        graph.buffer("clouds.puffs.blocks", 16 * MOST_BLOCKS)
        graph.buffer("clouds.puffs.found", 16 + 32 * MOST_FOUND, usage=("indirect",), persistent=True)
        graph.buffer("clouds.puffs.puffs", PUFF_BYTES * MOST_FOUND)
        graph.texture_data("clouds.puffs.grain", grain(looks(slabs)), "rgba8unorm", dimension="3d")
        graph.buffer("clouds.puffs.keys", 8 * MOST_FOUND)

        def add(name: str, **options: Any) -> None:
            graph.compute(f"clouds.puffs.{name}", f"package::clouds::puffs::{name}", **common, **options)

        add("begin", bind=counts, groups=(1, 1, 1), order=-1.0)
        add(
            "buckets",
            bind={
                **lattice,
                **(bind or {}),
                "blocks": "clouds.puffs.blocks",
                "block_count": counts["block_count"],
            },
            groups=lambda: (27, len(self.grids), 1),
            flags={"EVERYWHERE": everywhere},
        )
        add(
            "cells",
            bind={
                **lattice,
                **(bind or {}),
                "blocks": "clouds.puffs.blocks",
                "found": counts["found"],
            },
            groups=counts["block_count"],
            flags={"EVERYWHERE": everywhere},
        )
        add(
            "lit",
            bind={
                **lattice,
                **(bind or {}),
                "found": counts["found"],
                "puffs": "clouds.puffs.puffs",
                "keys": "clouds.puffs.keys",
                "draw": counts["draw"],
                "shadow": "clouds.shadow_frame",
                "shadow_map": "clouds.shadow",
                "linear": "sampler:linear-clamp",
            },
            groups=counts["found"],
            flags={"SHADOW": shadow},
        )
        order = add_order(
            graph,
            "clouds.puffs",
            keys="clouds.puffs.keys",
            count=counts["draw"],
            word=4,
            capacity=MOST_FOUND,
        )
        graph.render(
            "clouds.puffs.draw",
            "package::clouds::puffs::draw",
            color=["clouds.layer"],
            blend="over",
            bind={
                "view": "view",
                "puffs": "clouds.puffs.puffs",
                "order": order,
                "grain": "clouds.puffs.grain",
                "repeat": "sampler:linear-repeat",
                "scene": "gbuffer.depth",
            },
            indirect=counts["draw"],
            **common,
        )

    def counts(self) -> dict[str, int]:
        """What the last frame did; waits for the GPU.

        Returns
        -------
        dict
            ``buckets``: all of them; ``buckets_in_sight``; ``evaluated``: cells that were looked at;
            ``found``: puffs in these; ``drawn``: those that others do not hide, the nearest `MOST_DRAWN` of
            them; ``found`` of each size.
        """

        def words(name: str) -> np.ndarray:
            return np.asarray(self._graph.read(name)).view(np.uint32).ravel()

        blocks, found = words("clouds.puffs.block_count"), words("clouds.puffs.found")
        sizes = [SIZES[grid.level] for grid in self.grids]
        grid_of = found[4 : 4 + 8 * int(found[3])].reshape(-1, 8)[:, 5]
        by_grid = np.bincount(grid_of, minlength=len(sizes))
        each = {f"{size:.3g} m": 0 for size in sorted(set(sizes))}
        for size, number in zip(sizes, by_grid, strict=True):
            each[f"{size:.3g} m"] += int(number)
        return {
            "buckets": 27 * len(self.grids),
            "buckets_in_sight": int(blocks[3]),
            "evaluated": 64 * int(blocks[0]),
            "found": int(found[3]),
            "drawn": int(words("clouds.puffs.arguments")[0]) // _VERTICES,
            **each,
        }

    def update(self, state: FrameState, visibility: float) -> None:
        """Find which sizes of puffs a frame needs.

        Parameters
        ----------
        visibility : float
            m
        """
        # from high above, clouds are seen to the horizon
        farthest = max(visibility, 6.0 * state.altitude)
        height, radius = state.altitude, state.planet_radius
        fineness = fineness_of(self.slabs, self._number, height, farthest, radius)
        self.grids = grids(self.slabs, reaches(fineness), height, farthest)
        values = grid_values(
            self.slabs,
            self.grids,
            self._count,
            camera_map=map_coordinates(state.camera.position, state.planet_radius),
            camera=np.asarray(state.camera.position, np.float64),
            height=state.altitude,
            time=state.time,
            radius=state.planet_radius,
        )
        self._uniform.set(**values)
