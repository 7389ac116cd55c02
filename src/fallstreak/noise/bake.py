"""Noise baked into textures on the GPU: planes, volumes and cubes, repeating ones too, with their mips.

What is baked is a `BakeSpec`: a size, a format, and for each channel one `Layer` of noise or several that are
laid over each other. `bake` makes it at once, `bake_pass` in the first frame of a frame graph, `sample` gives
the values at a list of points. The shaders are the twins of the CPU's: the same integers, the same values to
rounding.

Cost: per sample and octave as docs/noise.md measures it; memory besides the texture is at most 50 MB, since
large volumes are made in parts, each of its own dispatch.

Limits: 2-D, 3-D and cubes; lacunarities other than whole ones are exact up to 2^19 cells from the origin.
Source of the cloud shapes: Schneider & Vos 2015, "The real-time volumetric cloudscapes of Horizon: Zero
Dawn".
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..gpu import Device, FrameGraph
from ..gpu.formats import texel
from ..gpu.mips import levels
from .arguments import fractal_of, integer, kind_of, name_of, period_of, real, reals

BLENDS = ("set", "add", "multiply", "screen", "min", "max")
_COPY_SRC, _COPY_DST, _TEXTURE_BINDING = 1, 2, 4


@dataclass(frozen=True)
class Layer:
    """One noise of a channel.

    Parameters
    ----------
    kind, fractal : str
        As for `fbm`; see `kinds.KINDS` and `kinds.FRACTALS`. "curl" is curl noise, per cell of the first
        octave: it fills two channels in a plane, else three, and stands alone.
    octaves : int
    frequency : float or one for each axis
        Cells of the first octave from one side to the other; a single number counts those along x, and along
        the other axes as many of the same size as there is room for. Whole, if it shall repeat. On a cube,
        the cells in the radius of the sphere.
    lacunarity, gain, seed
        As for `fbm`.
    warp : float
        Points are moved by fBm of the same octaves times so many cells.
    spacing : bool
        Let octaves fade out that the texels are too far apart for.
    range : (float, float), optional
        The values that become 0 and 1; what lies beyond is cut off. The first may be the larger. Without it
        values stay as they are.
    blend : str
        How it meets the layers before it: "set", "add", "multiply", "screen" (``a + b - a b``), "min", "max".
    """

    kind: str = "perlin"
    fractal: str = "fbm"
    octaves: int = 1
    frequency: float | tuple[float, ...] = 4
    lacunarity: float = 2.0
    gain: float = 0.5
    seed: int = 0
    warp: float = 0.0
    spacing: bool = False
    range: tuple[float, float] | None = None
    blend: str = "set"


@dataclass(frozen=True)
class BakeSpec:
    """A texture of noise.

    Parameters
    ----------
    size : (width, height), (width, height, depth) or int
        Of a plane, of a volume, of a cube's face.
    channels : Layer, or sequence of one Layer, or tuple of Layers, for each channel
        At most as many as the format has components; what is left out is 0.
    format : str
        8-bit unorm, 16- or 32-bit float of 1, 2 or 4 components: "r8unorm", "rgba8unorm", "r16float" …
    tiling : bool
        It repeats from side to side without a seam (planes and volumes).
    mips : bool
        With all levels, each the mean of the one above.

    Raises
    ------
    ValueError
        One sentence that names what is not allowed, its value, and what is.
    """

    size: int | tuple[int, ...]
    channels: Layer | Sequence[Layer | tuple[Layer, ...]] = Layer()
    format: str = "rgba8unorm"
    tiling: bool = False
    mips: bool = True

    def __post_init__(self):
        _, components = texel(self.format)
        if not 1 <= self.components <= components or not all(self.stacks):
            raise ValueError(
                f"channels has {self.components} entries: {self.format} takes 1 to {components}, "
                "of at least one layer each"
            )
        if self.cube and self.tiling:
            raise ValueError("tiling=True is not allowed with a cube: its faces always meet")
        most = 2048 if len(self.shape) == 3 else 8192
        for n in self.shape:
            integer("size", n, 1, most)
        for stack in self.stacks:
            for layer in stack:
                self._check(layer)
                if layer.kind == "curl" and len(stack) > 1:
                    raise ValueError("kind='curl' is not allowed among other layers: it stands alone")

    @property
    def cube(self) -> bool:
        """Whether it is a cube."""
        return isinstance(self.size, int)

    @property
    def shape(self) -> tuple[int, ...]:
        """Sizes along x, y and, in a volume, z."""
        shape = (self.size, self.size) if isinstance(self.size, int) else tuple(self.size)
        if len(shape) not in (2, 3):
            raise ValueError(
                f"size={self.size!r} is not allowed: it must be one size of a cube, or 2 or 3 sizes"
            )
        return shape

    @property
    def texture_size(self) -> tuple[int, int, int]:
        """Width, height, and depth or layers."""
        shape = self.shape
        return shape[0], shape[1], 6 if self.cube else shape[2] if len(shape) == 3 else 1

    @property
    def dimension(self) -> str:
        """Of the texture: "2d", "3d", or "2d-array" for the faces of a cube."""
        return "2d-array" if self.cube else "3d" if len(self.shape) == 3 else "2d"

    @property
    def levels(self) -> int:
        """Mip levels."""
        return levels(self.texture_size, self.dimension) if self.mips else 1

    @property
    def stacks(self) -> list[tuple[Layer, ...]]:
        """The layers of each channel."""
        if isinstance(self.channels, Layer):
            return [(self.channels,)]
        return [(entry,) if isinstance(entry, Layer) else tuple(entry) for entry in self.channels]

    def width(self, stack: tuple[Layer, ...]) -> int:
        """Channels that the layers of a stack fill."""
        if stack and stack[0].kind == "curl":
            return 3 if self.cube else len(self.shape)
        return 1

    @property
    def components(self) -> int:
        """Channels that are filled."""
        return sum(self.width(stack) for stack in self.stacks)

    def frequencies(self, layer: Layer) -> tuple[float, ...]:
        """Cells of a layer along each axis."""
        shape = self.shape
        if isinstance(layer.frequency, (int, float)):
            return tuple(layer.frequency * n / shape[0] for n in shape)
        return tuple(layer.frequency)

    def _check(self, layer: Layer) -> None:
        check(layer, 3 if self.cube else len(self.shape))
        if not isinstance(layer.frequency, (int, float)):
            reals("frequency", layer.frequency, len(self.shape), 1e-6, 65536)
        if self.tiling:
            cells = self.frequencies(layer)
            if any(abs(c - round(c)) > 1e-9 or c < 1 for c in cells):
                raise ValueError(
                    f"frequency={layer.frequency!r} is not allowed with tiling: it makes "
                    f"{' x '.join(f'{c:g}' for c in cells)} cells, which must be whole numbers"
                )
            self.period(layer)

    def period(self, layer: Layer) -> tuple[int, ...] | None:
        """The period of a layer's first octave in cells."""
        if not self.tiling:
            return None
        cells = tuple(round(c) for c in self.frequencies(layer))
        kind = "perlin" if layer.kind == "curl" else layer.kind
        return period_of(cells, kind, len(cells), layer.octaves, float(layer.lacunarity))


def check(layer: Layer, dimensions: int) -> None:
    """Raise ValueError for a layer that cannot be in so many dimensions."""
    if layer.kind != "curl":
        kind_of(layer.kind, dimensions)
    elif layer.fractal != "fbm" or layer.warp != 0.0 or layer.blend != "set":
        raise ValueError(
            "kind='curl' is not allowed with a fractal other than 'fbm', with warp or with blend"
        )
    fractal_of(layer.fractal)
    name_of("blend", layer.blend, BLENDS)
    integer("octaves", layer.octaves, 1, 32)
    integer("seed", layer.seed, 0, 2**32 - 1)
    real("lacunarity", layer.lacunarity, 1.0, 16.0)
    real("gain", layer.gain, 0.0, 4.0)
    real("warp", layer.warp, -1e3, 1e3)
    if isinstance(layer.frequency, (int, float)):
        real("frequency", layer.frequency, 1e-6, 65536)
    if layer.range is not None and layer.range[0] == layer.range[1]:
        raise ValueError(f"range={layer.range!r} is not allowed: its ends must differ")


class Baked:
    """A baked texture.

    Attributes
    ----------
    texture : wgpu texture
        With usages for sampling and copying.
    spec : BakeSpec
    """

    def __init__(self, device: Device, texture: Any, spec: BakeSpec):
        self._device, self.texture, self.spec = device, texture, spec

    def array(self, mip: int = 0) -> np.ndarray:
        """A level as ([depth or faces,] height, width[, components]) in the format's own type."""
        from ..gpu.mips import level_size
        from ..gpu.readback import Readback

        size = level_size(self.spec.texture_size, mip, self.spec.dimension)
        readback = Readback(self._device)
        return readback.now(readback.texture(self.texture, self.spec.format, size, mip)).result()


def bake(device: Device, spec: BakeSpec) -> Baked:
    """Bake a texture now.

    Large ones are made in parts, submitted one by one and waited for, so that a slow adapter can do other
    things between.

    Examples
    --------
    >>> shapes = bake(device, cloud_shapes(128))       # doctest: +SKIP
    >>> shapes.array(mip=2).shape                      # doctest: +SKIP
    (32, 32, 32, 4)
    """
    from .baker import Baker

    usage = _COPY_SRC | _COPY_DST | _TEXTURE_BINDING
    texture = device.texture(
        "baked noise", spec.format, spec.texture_size, usage, dimension=spec.dimension, mips=spec.levels
    )
    Baker.of(device).bake(texture, spec)
    return Baked(device, texture, spec)


def bake_pass(graph: FrameGraph, name: str, spec: BakeSpec) -> str:
    """Declare a texture that is baked in the graph's first frame and kept; returns its name.

    A cube is a 2-D array of six layers, which shaders may bind as a cube.
    """
    from .baker import Baker

    graph.texture(
        name, spec.format, spec.texture_size, dimension=spec.dimension, mips=spec.levels, persistent=True
    )
    graph.textures[name].usage |= _TEXTURE_BINDING
    baker = Baker.of(graph.device)
    graph.add_pass(
        f"{name}.bake",
        writes=[name],
        record=lambda context: baker.record(context.encoder, context.resource(name), spec),
        when=lambda: False,  # but for the first frame, in which what lasts is always made
    )
    return name


def sample(
    device: Device,
    points: np.ndarray,
    layer: Layer,
    *,
    period: int | tuple[int, ...] | None = None,
    spacing: float | None = None,
) -> np.ndarray:
    """The values of a layer at points, computed on the GPU: for comparing with the CPU.

    Parameters
    ----------
    points : (count, D) array
        D is 2, 3 or 4; in the units of which `layer.frequency` cells fit into one.
    period, spacing
        As for `fbm`.

    Returns
    -------
    (count,) float32 array
        NaN where a coordinate is not finite.
    """
    return _at_points(device, points, layer, period, spacing)[0]


def gradient(device: Device, points: np.ndarray, layer: Layer) -> tuple[np.ndarray, np.ndarray]:
    """fBm of "perlin" or "simplex" noise at points and its analytic derivatives, computed on the GPU.

    Returns
    -------
    value : (count,) float32 array
    derivatives : (count, D) float32 array
        Per unit of the points.
    """
    dimensions = np.shape(points)[-1]
    kind_of(layer.kind, dimensions, gradient=True)
    found = _at_points(device, points, layer, None, None, "slopes", dimensions + 1)
    return found[0], found[1:].T * np.float32(_single(layer))


def curl(
    device: Device, points: np.ndarray, layer: Layer, *, period: int | tuple[int, ...] | None = None
) -> np.ndarray:
    """Curl noise at points in 2-D or 3-D, computed on the GPU; the layer's kind is "perlin".

    Returns
    -------
    (count, D) float32 array
        Per unit of the points.
    """
    dimensions = np.shape(points)[-1]
    found = _at_points(device, points, layer, period, None, "flow", dimensions)
    return found.T * np.float32(_single(layer))


def _single(layer: Layer) -> float:
    """The frequency of a layer, which must be the same along all axes."""
    return real("frequency", layer.frequency, 1e-6, 65536)


def _at_points(
    device: Device,
    points: np.ndarray,
    layer: Layer,
    period: int | tuple[int, ...] | None,
    spacing: float | None,
    what: str = "points",
    components: int = 1,
) -> np.ndarray:
    from .baker import Baker

    points = np.asarray(points, np.float64)
    dimensions = points.shape[-1]
    check(layer, dimensions)
    periods = period_of(period, layer.kind, dimensions, layer.octaves, float(layer.lacunarity))
    frequency = _single(layer)
    detail = None if spacing is None else -math.log2(frequency * spacing)
    baker = Baker.of(device)
    return baker.sample(points * frequency, layer, periods, detail, what=what, components=components)


def throughput(
    device: Device,
    kind: str = "perlin",
    *,
    dimensions: int = 3,
    octaves: int = 12,
    count: int = 1 << 20,
    rounds: int = 5,
    what: str = "points",
) -> list[float]:
    """Seconds that fBm at `count` points takes on the GPU, once per round, without what precedes and follows.

    ``count * octaves / min(throughput(device, …))`` are the evaluations in a second.

    Parameters
    ----------
    kind, dimensions, octaves
        Of what is timed.
    what : str
        "points" for values, "slopes" for values with derivatives, "flow" for curl noise.
    """
    from .baker import Baker

    layer = Layer(kind, octaves=octaves)
    check(layer, dimensions)
    u, v = np.meshgrid(np.linspace(0.0, 8.0, 1 << 10), np.linspace(0.0, 8.0, -(-count // (1 << 10))))
    plane = [u, v, 0.3 * u + 0.2 * v + 1.7, 0.1 * u - 0.4 * v + 5.3][:dimensions]
    points = np.stack([axis.ravel()[:count] for axis in plane], -1)
    components = {"points": 1, "slopes": dimensions + 1, "flow": dimensions}[what]
    return Baker.of(device).time(points, layer, rounds, what, components)


def cloud_shapes(size: int = 128, seed: int = 0, frequency: int = 4) -> BakeSpec:
    """The shape volume of clouds: repeating, rgba8unorm.

    Red is Perlin-Worley noise, heaps that hang together: fBm of Perlin noise whose gaps are filled by
    inverted cellular noise. Green, blue and alpha are inverted cellular fBm, 2, 4 and 8 times as fine. There
    are as many octaves as have four texels to a cell.
    """

    def octaves(times: int, most: int) -> int:
        return min(max(int(math.log2(size / (times * frequency))) - 1, 1), most)

    def heaps(times: int, number: int, blend: str = "set") -> Layer:
        return Layer(
            "cellular_f1",
            octaves=octaves(times, 3),
            frequency=times * frequency,
            seed=seed + number,
            range=(1.0, 0.0),
            blend=blend,
        )

    perlin = Layer("perlin", octaves=octaves(1, 7), frequency=frequency, seed=seed, range=(-0.1, 0.9))
    channels = [(perlin, heaps(1, 1, "screen")), heaps(2, 2), heaps(4, 3), heaps(8, 4)]
    return BakeSpec((size, size, size), channels, tiling=True)
