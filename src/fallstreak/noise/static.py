"""Compile-time choices as a typed argument, so that Numba compiles only what is called and finds it again.

A closure over compiled functions is never found in Numba's cache on disk (the key holds a new uuid in every
process); a module-level function whose choices arrive in the *type* of an argument is. `Static` is that
argument. Its type carries the choices and a digest of this folder, because Numba itself only looks at the
file of the cached function: an edit of any kind of noise must not find the machine code of yesterday.
"""

from __future__ import annotations

import functools
import hashlib
import pathlib
from dataclasses import dataclass
from typing import Any

from numba.core import types
from numba.core.datamodel import models
from numba.core.imputils import lower_constant
from numba.extending import NativeValue, register_model, typeof_impl, unbox


@dataclass(frozen=True)
class Static:
    """What is fixed when a loop is compiled.

    `kind` and `dimensions` choose the noise, `derivatives` whether these come along, `fractal` how octaves
    add up, `periodic` whether cells wrap, `double` whether points are float64, `width` how many samples go
    side by side.
    """

    kind: str
    dimensions: int
    width: int
    derivatives: bool = False
    fractal: str = "fbm"
    periodic: bool = False
    double: bool = False


@dataclass(frozen=True)
class Table:
    """Constant numbers (floats, or integers as `integer` says) that lanes look up by index: see
    `gradients.lookup`."""

    values: tuple
    integer: bool = False


class StaticType(types.Type):
    """The type of one `Static` or `Table`: two of them are equal when all choices and the source code are."""

    def __init__(self, value: Static | Table, digest: str):
        self.value: Any = value
        self.digest = digest
        super().__init__(name=f"Static({value}, {digest})")

    @property
    def key(self):
        return self.value, self.digest


@functools.cache
def digest() -> str:
    """A short hash of all Python files of this folder."""
    state = hashlib.sha256()
    for path in sorted(pathlib.Path(__file__).parent.glob("*.py")):
        state.update(path.name.encode() + path.read_bytes())
    return state.hexdigest()[:16]


@functools.cache
def _type(value: Static | Table) -> StaticType:
    return StaticType(value, digest())


@typeof_impl.register(Static)
@typeof_impl.register(Table)
def _typeof(value, context):
    return _type(value)


register_model(StaticType)(models.OpaqueModel)


@unbox(StaticType)
def _unbox(typ, value, c):
    return NativeValue(c.context.get_dummy_value())


@lower_constant(StaticType)
def _constant(context, builder, typ, value):
    return context.get_dummy_value()
