"""Arguments of the noise functions, checked: what is wrong with one is said in one sentence.

Every check names the argument, the value and what is allowed, and gives the value back in the form that the
loops take.
"""

from __future__ import annotations

import difflib
import math
import operator
import os
from collections.abc import Collection, Mapping
from typing import Any

import numpy as np

from .kinds import FRACTALS, KINDS

MOST_OCTAVES = 32
LARGEST_PERIOD = 2**31 - 1
AXES = "xyzw"


def name_of(argument: str, value: Any, allowed: Collection[str]) -> str:
    """One of a few words."""
    if isinstance(value, str) and value in allowed:
        return value
    close = difflib.get_close_matches(str(value), allowed, 1)
    hint = f" (did you mean {close[0]!r}?)" if close else ""
    raise ValueError(f"{argument}={_shown(value)} is not allowed: it must be {_list(allowed)}{hint}")


def integer(argument: str, value: Any, low: int, high: int) -> int:
    """An integer of any integer type from `low` to `high`; a boolean is none."""
    try:
        number = None if isinstance(value, (bool, np.bool_)) else operator.index(value)
    except TypeError:
        number = None
    if number is None or not low <= number <= high:
        raise ValueError(
            f"{argument}={_shown(value)} is not allowed: it must be an integer from {low} to {high}"
        )
    return number


def real(argument: str, value: Any, low: float, high: float) -> float:
    """A finite number from `low` to `high`."""
    number = _number(value)
    if number is None or not low <= number <= high:
        raise ValueError(
            f"{argument}={_shown(value)} is not allowed: it must be a number from {low:g} to {high:g}"
        )
    return number


def reals(argument: str, value: Any, count: int, low: float, high: float) -> tuple[float, ...]:
    """A number for all axes, or one for each."""
    values = (value,) * count if _number(value) is not None else _sequence(value)
    numbers = tuple(_number(v) for v in values)
    if len(numbers) != count or any(v is None or not low <= v <= high for v in numbers):
        raise ValueError(
            f"{argument}={_shown(value)} is not allowed: it must be a number from {low:g} to {high:g}, "
            f"or {count} of them, one for each axis"
        )
    return numbers  # type: ignore[return-value]


def thread_count(value: Any) -> int:
    """None as all cores that this process may use."""
    if value is None:
        return _cores()
    return min(integer("threads", value, 1, 4096), _cores())


def kind_of(value: Any, dimensions: int, *, gradient: bool = False) -> str:
    """A kind that exists in so many dimensions, and has derivatives if they are wanted."""
    allowed = [name for name, kind in KINDS.items() if kind.gradient] if gradient else KINDS
    name = name_of("kind", value, allowed)
    known = KINDS[name].dimensions
    if dimensions not in known:
        raise ValueError(
            f"kind={name!r} is not allowed with points in {dimensions} dimensions: "
            f"it has {_list([str(d) for d in known])}"
        )
    return name


def fractal_of(value: Any) -> str:
    return name_of("fractal", value, FRACTALS)


def period_of(
    value: Any, kind: str, dimensions: int, octaves: int, lacunarity: float
) -> tuple[int, ...] | None:
    """The period of the first octave along each axis, in cells."""
    if value is None:
        return None
    if dimensions not in KINDS[kind].periodic:
        can = [name for name, each in KINDS.items() if dimensions in each.periodic]
        raise ValueError(
            f"period={_shown(value)} is not allowed with kind={kind!r} in {dimensions} dimensions: "
            f"there only {_list(can, 'and')} repeat{'s' * (len(can) == 1)}"
        )
    single = isinstance(value, (int, np.integer))
    values = (value,) * dimensions if single else _sequence(value)
    if len(values) != dimensions:
        raise ValueError(
            f"period={_shown(value)} is not allowed: it must be an integer, or {dimensions} of them, "
            "one for each axis"
        )
    periods = tuple(integer("period", v, 1, LARGEST_PERIOD) for v in values)
    if kind == "simplex" and dimensions == 2 and periods[1] % 2:
        raise ValueError(
            f"period={_shown(value)} is not allowed with kind='simplex' in 2 dimensions: along y it must be "
            "even, since every other row of the lattice lies half a cell aside"
        )
    if octaves > 1 and not lacunarity.is_integer():
        raise ValueError(
            f"lacunarity={lacunarity:g} is not allowed with a period: it must be an integer, "
            "else the finer octaves do not fit into it"
        )
    if max(periods) * int(lacunarity) ** (octaves - 1) > LARGEST_PERIOD:
        raise ValueError(
            f"period={_shown(value)} is not allowed with octaves={octaves} and lacunarity={lacunarity:g}: "
            f"period · lacunarity^(octaves − 1) must be at most {LARGEST_PERIOD}"
        )
    return periods


def fades_of(spacing: Any, octaves: int, lacunarity: float, frequency: float) -> np.ndarray | None:
    """How much of each octave samples so far apart can show: 1 from 4 samples a wavelength, 0 below 2."""
    if spacing is None:
        return None
    distance = real("spacing", spacing, 1e-300, 1e300)
    samples = 1.0 / (distance * frequency * lacunarity ** np.arange(octaves, dtype=np.float64))
    t = np.clip(np.log2(samples) - 1.0, 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t)


def axes_of(points: Any) -> tuple[tuple[np.ndarray, ...], tuple[int, ...]]:
    """Points as one flat array per axis, all float32 or all float64, and the shape of the result."""
    if isinstance(points, tuple):
        arrays = [_floats(axis, f"points[{i}]") for i, axis in enumerate(points)]
        _check_dimensions(len(arrays), "points is a tuple of")
        shapes = [array.shape for array in arrays]
        if len(set(shapes)) > 1:
            raise ValueError(
                f"points has arrays of shapes {_list([str(s) for s in shapes], 'and')}: they must be equal"
            )
        dtype = np.result_type(*arrays)
        return tuple(array.astype(dtype, copy=False).reshape(-1) for array in arrays), shapes[0]
    array = _floats(points, "points")
    if array.ndim == 0:
        raise ValueError(
            "points is a single number: it must be an array of shape (..., D), or a tuple of D arrays"
        )
    _check_dimensions(array.shape[-1], f"points of shape {array.shape} have")
    flat = array.reshape(-1, array.shape[-1])
    return tuple(flat[:, d] for d in range(array.shape[-1])), array.shape[:-1]


def shape_of(value: Any) -> tuple[int, ...]:
    """The shape of a grid."""
    sizes = _sequence(value)
    if len(sizes) not in (2, 3, 4):
        raise ValueError(
            f"shape={_shown(value)} is not allowed: it must have 2, 3 or 4 sizes, the last along x"
        )
    return tuple(integer("shape", size, 0, 2**31) for size in sizes)


def output(out: Any, shape: tuple[int, ...], inputs: Collection[np.ndarray] = ()) -> np.ndarray:
    """The array to return: a new one, or `out` if it is one that can take the result."""
    if out is None:
        return np.empty(shape, np.float32)
    if not isinstance(out, np.ndarray):
        raise ValueError(f"out={_shown(out)} is not allowed: it must be a numpy array")
    if out.dtype != np.float32 or not out.dtype.isnative or out.shape != shape:
        raise ValueError(f"out is {out.dtype} of shape {out.shape}: it must be float32 of shape {shape}")
    if not out.flags.writeable:
        raise ValueError("out is read-only: it must be a writeable array")
    if any(_overlap(out, array) for array in inputs):
        raise ValueError("out shares memory with points: it must be an array of its own")
    return out


def _overlap(a: np.ndarray, b: np.ndarray) -> bool:
    try:
        return np.shares_memory(a, b, max_work=10_000)  # type: ignore[arg-type]
    except np.exceptions.TooHardError:
        return True


def _check_dimensions(count: int, found: str) -> None:
    if count not in (2, 3, 4):
        raise ValueError(f"{found} {count} coordinate{'s' * (count != 1)}: noise is in 2, 3 or 4 dimensions")


def _floats(value: Any, argument: str) -> np.ndarray:
    """As float32 or float64: integers become float64, which holds them; half floats become float32."""
    try:
        array = np.asarray(value)
    except ValueError:  # ragged lists
        raise ValueError(f"{argument} is not an array: its rows have different lengths") from None
    if array.dtype.kind not in "iuf":
        raise ValueError(
            f"{argument} has dtype {array.dtype}: it must be float32, float64 or an integer type"
        )
    small = array.dtype.kind == "f" and array.dtype.itemsize <= 4
    return array.astype(np.float32 if small else np.float64, copy=False)


def _number(value: Any) -> float | None:
    if isinstance(value, (bool, np.bool_, str, bytes)):
        return None
    try:
        number = float(value)
    except (TypeError, ValueError, OverflowError):
        return None
    return number if math.isfinite(number) else None


def _sequence(value: Any) -> tuple:
    if isinstance(value, (str, bytes, Mapping)):
        return ()
    try:
        return tuple(value)
    except TypeError:
        return ()


def _cores() -> int:
    if hasattr(os, "sched_getaffinity"):
        return max(1, len(os.sched_getaffinity(0)))
    return os.cpu_count() or 1


def _shown(value: Any) -> str:
    text = (
        f"array of {value.dtype} {value.shape}"
        if isinstance(value, np.ndarray) and value.ndim
        else repr(value)
    )
    return text if len(text) <= 60 else f"{text[:57]}…"


def _list(words: Collection[str], last: str = "or") -> str:
    *most, final = words
    return f"{', '.join(most)} {last} {final}" if most else final
