"""From WESL modules to pipelines: linked, validated and cached per device."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from .errors import GpuError, ShaderError, translate
from .struct import Struct
from .view import VIEW
from .wesl import Linked, WeslError, link, package_resolver

_PACKAGE = Path(__file__).resolve().parent.parent
_resolve = package_resolver(_PACKAGE)


class Shaders:
    """Links and compiles entry points; asking twice for the same gives the same module."""

    def __init__(self, native: Any, *, software: bool = False):
        self._native = native
        self._software = software
        self._cache: dict[tuple[object, ...], tuple[Any, Linked]] = {}

    def get(
        self,
        module: str,
        entries: Sequence[str],
        *,
        flags: Mapping[str, bool] | None = None,
        constants: Mapping[str, Any] | None = None,
        structs: Sequence[Struct] = (),
    ) -> tuple[Any, Linked]:
        """The wgpu shader module and what the linker knows of it.

        Parameters
        ----------
        module : str
            Path of the WESL module, such as "package::sky::transmittance".
        entries : sequence of str
            Entry points to keep; everything they do not reach is dropped.
        flags, constants, structs
            Values for `@if`, the virtual package `constants` (a string there is the path of a module, whose
            declarations are then imported as `constants::NAME::…`), and the virtual package `structs` (in
            which `View` is always present).

        Raises
        ------
        ShaderError
            With the .wesl file and line.
        """
        flags, constants = dict(flags or {}), dict(constants or {})
        declared = {s.name: s for s in _with_dependencies([VIEW, *structs])}
        key = (
            module,
            tuple(entries),
            tuple(sorted(flags.items())),
            tuple(sorted((k, repr(v)) for k, v in constants.items())),
            tuple((n, id(s)) for n, s in declared.items()),
        )
        if key not in self._cache:
            try:
                linked = link(
                    module,
                    entries=list(entries),
                    resolve=_resolve,
                    flags=flags,
                    virtual={"constants": constants, "structs": list(declared.values())},
                )
            except WeslError as error:
                raise ShaderError(str(error)) from error
            self._cache[key] = (self._compile(module, linked), linked)
        return self._cache[key]

    def _compile(self, module: str, linked: Linked) -> Any:
        import wgpu

        code = linked.code
        if self._software:
            # Mesa's lavapipe takes a uniform that decides a branch or bounds a loop for a constant ("inline
            # uniforms") and compiles the shader anew in every frame: two thirds of a frame's time, and memory
            # that never comes back. What lies in a storage buffer it reads. The layout is the same, see
            # struct.py.
            code = code.replace("var<uniform>", "var<storage, read>")
        try:
            return self._native.create_shader_module(label=module, code=code)
        except wgpu.GPUError as error:
            ours = translate(error, f"compiling {module}")
            if type(ours) is not GpuError:
                raise ours from error
            raise ShaderError(linked.translate_error(str(error))) from error


def _with_dependencies(structs: Sequence[Struct]) -> list[Struct]:
    """The structs with those they contain, each once, dependencies first."""
    ordered: dict[str, Struct] = {}

    def visit(struct: Struct) -> None:
        for inner in struct.dependencies:
            visit(inner)
        ordered.setdefault(struct.name, struct)

    for struct in structs:
        visit(struct)
    return list(ordered.values())
