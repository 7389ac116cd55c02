"""The linker: from an entry module to one WGSL text."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from .emit import Emitter
from .interface import bindings_of, entry_of
from .library import Library, Resolver
from .linked import Linked
from .names import assign_names
from .program import Program


def link(
    module: str,
    entries: Iterable[str] | None = None,
    resolve: Resolver | None = None,
    flags: Mapping[str, bool] | None = None,
    virtual: Mapping[str, Any] | None = None,
) -> Linked:
    """Link a WESL module and all it needs into one WGSL text.

    Parameters
    ----------
    module : str
        The entry module, as ``"package::sky::transmittance"``.
    entries : iterable of str, optional
        Names of the entry points to keep; all of the module when left out. An entry may also be imported by
        the module, or be written as a full path, ``"package::gpu::fullscreen::vertex_main"``.
    resolve : callable, optional
        From a module path without ``package``, as ``("sky", "air")``, to ``(source, filename)``, or None when
        there is no such module. Default: the ``.wesl`` files of this package.
    flags : mapping, optional
        Values of the flags that ``@if`` may ask for. Asking for one that is not here is an error.
    virtual : mapping, optional
        Virtual packages: ``{"constants": {"STEPS": 40}, "structs": [VIEW, …]}``. A mapping becomes constants,
        a list of objects with ``name``, ``wgsl()`` and ``dependencies`` becomes struct declarations, a string
        is taken as WESL source. A constant may be the path of a module, ``{"KIND": "package::sky::air"}``:
        then ``import constants::KIND::density;`` imports from that module.

    Returns
    -------
    Linked

    Raises
    ------
    WeslError
        With file, line and column, for whatever keeps the module from being linked.
    """
    program = Program(Library(resolve, flags or {}, virtual or {}), tuple(module.split("::")), entries)
    assign_names(program)
    emitter = Emitter()
    emitter.directives(program.modules.values())
    for item in program.ordered():
        emitter.item(item)
    return Linked(
        emitter.code(),
        bindings_of(program),
        {item.name: entry_of(item) for item in program.heads},
        {item.name: "::".join((*item.module.path, item.declaration.name)) for item in program.items},
        emitter.places,
        emitter.parts,
    )
