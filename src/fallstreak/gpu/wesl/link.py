"""The linker: from an entry module to one WGSL text.

Start at the entry points, resolve every reference to a declaration of some module, take what is reached, give
each a name nobody else has, and write it down.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

from .emit import Emitter
from .errors import WeslError, did_you_mean
from .interface import Binding, EntryPoint, binding_of, entry_of
from .library import Library, Resolver, virtual_text
from .linked import Linked
from .syntax import Declaration, Module, Path, Reference, absolute
from .words import PREDECLARED


@dataclass(eq=False)
class Item:
    """A declaration in its module, with what each reference in it means (None: a word of WGSL)."""

    module: Module
    declaration: Declaration
    targets: dict[Path, Item | None] = field(default_factory=dict)
    name: str = ""


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
        is taken as WESL source.

    Returns
    -------
    Linked

    Raises
    ------
    WeslError
        With file, line and column, for whatever keeps the module from being linked.
    """
    return _Linker(resolve, flags or {}, virtual or {}).link(module, entries)


class _Linker:
    def __init__(self, resolve: Resolver | None, flags: Mapping[str, bool], virtual: Mapping[str, Any]):
        texts = {name: virtual_text(name, content) for name, content in virtual.items()}
        self.library = Library(resolve, flags, texts)
        self.items: dict[int, Item] = {}  # by identity of the declaration, in the order of discovery
        self.entered: dict[Path, Module] = {}

    def link(self, path: str, entries: Iterable[str] | None) -> Linked:
        root = self.library.module(tuple(path.split("::")))
        if root is None:
            raise WeslError(f"there is no module {path}{self.library.suggestion(tuple(path.split('::')))}")
        heads = self._entries(root, entries)
        self._reach(heads)
        self._name(root, heads)
        emitter = Emitter()
        emitter.directives(self.entered.values())
        for item in self._ordered():
            emitter.item(item)
        bindings: dict[str, Binding] = {}
        for item in self.items.values():
            if "binding" in item.declaration.attributes:
                key = item.declaration.name if item.declaration.name not in bindings else item.name
                bindings[key] = binding_of(item)
        points: dict[str, EntryPoint] = {item.name: entry_of(item) for item in heads}
        names = {
            item.name: "::".join((*item.module.path, item.declaration.name)) for item in self.items.values()
        }
        return Linked(emitter.code(), bindings, points, names, emitter.places, emitter.parts)

    # --- entry points -------------------------------------------------------------------------------------

    def _entries(self, root: Module, entries: Iterable[str] | None) -> list[Item]:
        self._enter(root)
        if entries is None:
            found = [d for d in root.declarations.values() if d.stage]
            if not found:
                raise WeslError(f"{'::'.join(root.path)} has no entry point", root.filename)
            return [self._item(root, declaration) for declaration in found]
        heads = []
        for name in entries:
            item = self._entry(root, name)
            if item is None:
                known = [d.name for d in root.declarations.values() if d.stage]
                raise WeslError(
                    f"there is no entry point '{name}' (there are: {', '.join(known) or 'none'})",
                    root.filename,
                )
            if item not in heads:
                heads.append(item)
        if len({item.declaration.name for item in heads}) < len(heads):
            raise WeslError("two entry points have one name", root.filename)
        return heads

    def _entry(self, root: Module, name: str) -> Item | None:
        path = tuple(name.split("::"))
        if len(path) == 1 and name in root.imports:
            path = root.imports[name].path
        module = root if len(path) == 1 else self.library.module(path[:-1])
        declaration = module.declarations.get(path[-1]) if module else None
        if module is None or declaration is None or declaration.stage is None:
            return None
        return self._item(module, declaration)

    # --- reachability -------------------------------------------------------------------------------------

    def _item(self, module: Module, declaration: Declaration) -> Item:
        item = self.items.get(id(declaration))
        if item is None:
            item = self.items[id(declaration)] = Item(module, declaration)
        return item

    def _enter(self, module: Module) -> list[Item]:
        """Take a module into the program: its assertions and directives count from now on."""
        if module.path in self.entered:
            return []
        self.entered[module.path] = module
        for imported in module.imports.values():
            self._check_import(module, imported)
        return [self._item(module, declaration) for declaration in module.asserts]

    def _reach(self, heads: list[Item]) -> None:
        """Follow references from `heads` (and the assertions of every module met) to all that is needed."""
        todo = list(reversed(heads))
        for module in list(self.entered.values()):
            todo += [self._item(module, declaration) for declaration in module.asserts]
        done: set[int] = set()
        while todo:
            item = todo.pop()
            if id(item) in done:
                continue
            done.add(id(item))
            todo += self._enter(item.module)
            for reference in item.declaration.references:
                if reference.path not in item.targets:
                    target = item.targets[reference.path] = self._resolve(item, reference)
                    if target is not None:
                        todo.append(target)

    def _resolve(self, item: Item, reference: Reference) -> Item | None:
        """Find the declaration a reference means."""
        module, path = item.module, reference.path
        if len(path) == 1:
            name = path[0]
            if name in module.declarations:
                return self._item(module, module.declarations[name])
            if name not in module.imports:
                if name in PREDECLARED:
                    return None
                known = {*module.declarations, *module.imports, *PREDECLARED, *item.declaration.locals}
                raise self._error(item, reference, f"'{name}' is not declared{did_you_mean(name, known)}")
            full = module.imports[name].path
        elif path[0] in module.imports:
            full = module.imports[path[0]].path + path[1:]
        else:
            full = absolute(path, module.path)
            if full is None:
                raise self._error(item, reference, "'super' leaves the package here")
        home = self.library.module(full[:-1])
        if home is None:
            raise self._error(item, reference, self._missing(full))
        declaration = home.declarations.get(full[-1])
        if declaration is None:
            raise self._error(item, reference, self._missing(full))
        return self._item(home, declaration)

    def _check_import(self, module: Module, imported) -> None:
        """An import must name a declaration or a module, even if nobody uses it."""
        path = imported.path
        home = self.library.module(path[:-1])
        if (home is None or path[-1] not in home.declarations) and self.library.module(path) is None:
            token = imported.token
            raise WeslError(self._missing(path), module.filename, token.line, token.column)

    def _missing(self, path: Path) -> str:
        """Say what is wrong with a path that leads nowhere."""
        home = self.library.module(path[:-1])
        if home is None:
            if self.library.module(path) is not None:
                return f"{'::'.join(path)} is a module, not a declaration"
            word, known = path[0], self.library.packages()
            if word not in known:
                return f"there is no package or import '{word}'{did_you_mean(word, known)}"
            place = path[:-1] if len(path) > 2 else path
            return f"there is no module {'::'.join(place)}{self.library.suggestion(place)}"
        if path[-1] in home.imports:
            origin = "::".join(home.imports[path[-1]].path)
            return f"{'::'.join(path[:-1])} only imports '{path[-1]}'; import {origin} instead"
        return (
            f"{'::'.join(path[:-1])} ({home.filename}) declares no '{path[-1]}'"
            f"{did_you_mean(path[-1], home.declarations)}"
        )

    def _error(self, item: Item, reference: Reference, message: str) -> WeslError:
        token = item.declaration.tokens[reference.first]
        return WeslError(message, item.module.filename, token.line, token.column)

    # --- names --------------------------------------------------------------------------------------------

    def _name(self, root: Module, heads: list[Item]) -> None:
        """Give every item its name in the output.

        Entry points, overrides and the entry module keep theirs, others carry their module in front. A name
        is refused when it is taken, when WGSL has it already, or when a function that refers to the item by
        another name has a local of that name, which would capture the reference.
        """
        captured = self._captured()
        taken: dict[str, Item] = {}
        items = [item for item in self.items.values() if item.declaration.name]
        visible = heads + [item for item in items if item.declaration.kind == "override"]
        for item in visible:
            item.name = item.declaration.name
            if taken.setdefault(item.name, item) is not item or item.name in captured.get(id(item), ()):
                token = item.declaration.tokens[item.declaration.name_at]
                raise WeslError(
                    f"the name '{item.name}' is visible from outside and cannot be given up, but something "
                    "else in this shader needs it",
                    item.module.filename,
                    token.line,
                    token.column,
                )
        # The entry module first, so that its names stay as they are whatever the libraries are called.
        for item in sorted(items, key=lambda item: item.module is not root):
            if item.name:
                continue
            own = item.declaration.name
            if item.module is root or item.module.path == ("structs",):
                wish = own
            else:
                wish = "_".join((*(part for part in item.module.path if part != "package"), own))
            refused = captured.get(id(item), ())
            name, count = wish, 1
            while name in taken or name in PREDECLARED or name in refused:
                count += 1
                name = f"{wish}_{count}"
            item.name = name
            taken[name] = item

    def _captured(self) -> dict[int, set[str]]:
        """Return, per item, the local names of functions that refer to it under another name."""
        captured: dict[int, set[str]] = {}
        for item in self.items.values():
            names = item.declaration.locals
            if names:
                for path, target in item.targets.items():
                    if target is not None:
                        # Where the source itself writes this very name, its scopes already tell them apart.
                        hidden = names - {path[0]} if len(path) == 1 else names
                        captured.setdefault(id(target), set()).update(hidden)
        return captured

    def _ordered(self) -> list[Item]:
        """Libraries before those who use them, each in the order of its source."""
        modules = list(reversed(self.entered))
        rank = {path: index for index, path in enumerate(modules)}
        return sorted(
            self.items.values(),
            key=lambda item: (
                rank[item.module.path],
                item.declaration.tokens[0].line,
                item.declaration.tokens[0].column,
            ),
        )
