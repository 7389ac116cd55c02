"""Uniform and storage structs, declared once in Python, laid out as WGSL demands.

The shader's text (`wgsl`), the bytes (`pack`) and the numpy view (`dtype`) all come from one declaration, so
they cannot drift apart. Layout: WGSL specification, "Alignment and Size", with the stricter rules of the
uniform address space (array strides and nested structs on 16 bytes) applied everywhere.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

_SCALARS = {"f32": np.float32, "i32": np.int32, "u32": np.uint32}
_SUFFIX = {"f": "f32", "i": "i32", "u": "u32"}
_ARRAY = re.compile(r"array<\s*(.+?)\s*,\s*(\d+)\s*>$")


@dataclass(frozen=True)
class _Type:
    """Layout of one WGSL type: alignment and size in bytes, numpy base and shape as stored."""

    align: int
    size: int
    base: np.dtype
    shape: tuple[int, ...] = ()
    columns: int = 0
    """For matrices, the rows that hold values: numpy's matrix is transposed and padded into `shape`."""


def _round_up(value: int, to: int) -> int:
    return -(-value // to) * to


def _type_of(spec: str | Struct) -> _Type:
    if isinstance(spec, Struct):
        return _Type(16, _round_up(spec.size, 16), spec.dtype)
    if spec in _SCALARS:
        return _Type(4, 4, np.dtype(_SCALARS[spec]))
    if match := re.fullmatch(r"vec([234])([fiu])", spec):
        n = int(match[1])
        return _Type(8 if n == 2 else 16, 4 * n, np.dtype(_SCALARS[_SUFFIX[match[2]]]), (n,))
    if match := re.fullmatch(r"mat([34])x([34])f", spec):
        columns, rows = int(match[1]), int(match[2])
        return _Type(16, 16 * columns, np.dtype(np.float32), (columns, 4), rows)
    raise ValueError(
        f"struct field type {spec!r} is unknown: use f32, i32, u32, vec*, mat*, array<T, N> or a Struct"
    )


class Struct:
    """A struct that Python writes and shaders read.

    Parameters
    ----------
    name : str
        Its name in WGSL; shaders import it from the virtual package `structs`.
    fields : sequence of (name, type, documentation)
        `type` is a WGSL type name ("f32", "vec3f", "mat4x4f", "array<vec4f, 9>") or another Struct.

    Examples
    --------
    >>> light = Struct("Light", [("direction", "vec3f", "unit"), ("lux", "f32", "above the air")])
    >>> light.size
    16
    """

    def __init__(self, name: str, fields: Sequence[tuple[str, str | Struct, str]]):
        self.name = name
        self.fields = tuple(fields)
        names: list[str] = []
        formats: list[object] = []
        offsets: list[int] = []
        self._matrices: dict[str, tuple[int, int]] = {}
        self.dependencies: list[Struct] = []
        end = 0
        for field, spec, _ in self.fields:
            count = 0
            inner: str | Struct = spec
            if isinstance(spec, str) and (match := _ARRAY.fullmatch(spec)):
                inner, count = match[1], int(match[2])
            kind = _type_of(inner)
            if isinstance(inner, Struct):
                self.dependencies.append(inner)
            shape = kind.shape
            align, size = kind.align, kind.size
            if count:
                align, stride = max(align, 16), _round_up(size, 16)
                if stride != size:
                    raise ValueError(f"{name}.{field}: elements of {spec} must fill 16 bytes; use vec4f")
                size, shape = stride * count, (count, *shape)
            if kind.columns:
                self._matrices[field] = (shape[-2], kind.columns)
            offset = _round_up(end, align)
            names.append(field)
            formats.append((kind.base, shape))
            offsets.append(offset)
            end = offset + size
        self.size = _round_up(end, 16)
        self.dtype = np.dtype({"names": names, "formats": formats, "offsets": offsets, "itemsize": self.size})

    def wgsl(self) -> str:
        """The declaration as shaders see it."""
        lines = [f"struct {self.name} {{"]
        for field, spec, doc in self.fields:
            kind = spec.name if isinstance(spec, Struct) else spec
            align = "@align(16) " if isinstance(spec, Struct) else ""
            lines.append(f"    {align}{field}: {kind}, // {doc}")
        return "\n".join([*lines, "}"])

    def fill(self, record: np.ndarray, values: dict[str, object]) -> None:
        """Write `values` into a numpy record of this struct's dtype.

        Raises
        ------
        ValueError
            For a field that does not exist or a value of the wrong shape.
        """
        for field, value in values.items():
            if field not in self.dtype.fields:  # type: ignore[operator]
                raise ValueError(
                    f"{self.name} has no field {field!r}; it has {', '.join(self.dtype.names or ())}"
                )
            if field in self._matrices:
                columns, rows = self._matrices[field]
                # WGSL stores columns, numpy rows.
                record[field][..., :columns, :rows] = np.swapaxes(np.asarray(value, np.float32), -1, -2)
            elif isinstance(value, dict):
                nested = next(s for n, s, _ in self.fields if n == field)
                assert isinstance(nested, Struct)
                nested.fill(record[field], value)
            else:
                try:
                    record[field] = value
                except (ValueError, TypeError) as error:
                    raise ValueError(f"{self.name}.{field}: {error}") from None

    def pack(self, **values: object) -> bytes:
        """The bytes of one instance; every field must be given."""
        missing = [n for n, _, _ in self.fields if n not in values]
        if missing:
            raise ValueError(f"{self.name} lacks {', '.join(missing)}")
        record = np.zeros((), self.dtype)
        self.fill(record, values)
        return record.tobytes()

    def __repr__(self) -> str:
        return f"Struct({self.name}, {self.size} bytes)"
