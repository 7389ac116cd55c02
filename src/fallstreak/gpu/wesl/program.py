"""What a shader consists of: from its entry points along every reference to declarations of other modules."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

from .errors import WeslError, did_you_mean
from .library import Library
from .syntax import Declaration, Import, Module, Path, Reference, absolute
from .words import PREDECLARED


@dataclass(eq=False)
class Item:
    """A declaration in its module, with what each reference in it means (None: a word of WGSL)."""

    module: Module
    declaration: Declaration
    targets: dict[Path, Item | None] = field(default_factory=dict)
    name: str = ""

    def error(self, message: str, at: int | None = None) -> WeslError:
        """Return an error that points at a token of the declaration, its name when left out."""
        token = self.declaration.tokens[self.declaration.name_at if at is None else at]
        return WeslError(message, self.module.filename, token.line, token.column)


class Program:
    """Everything that the entry points of one module need.

    Attributes
    ----------
    root : Module
    heads : list of Item
        The entry points.
    items : list of Item
        All declarations that are reached, entry points included, in the order of discovery.
    modules : dict of path to Module
        The modules they are in, in the order of discovery.
    """

    def __init__(self, library: Library, path: Path, entries: Iterable[str] | None):
        self.library = library
        root = library.module(path)
        if root is None:
            raise WeslError(f"there is no module {'::'.join(path)}{library.suggestion(path)}")
        self.root = root
        self.modules: dict[Path, Module] = {}
        self._items: dict[int, Item] = {}  # by identity of the declaration
        self._enter(root)
        self.heads = self._entries(root, entries)
        self._reach(self.heads)

    @property
    def items(self) -> list[Item]:
        return list(self._items.values())

    def ordered(self) -> list[Item]:
        """Return the items as they are written: libraries before their users, each in its own order."""
        rank = {path: number for number, path in enumerate(reversed(self.modules))}

        def place(item: Item) -> tuple[int, int, int]:
            token = item.declaration.tokens[0]
            return rank[item.module.path], token.line, token.column

        return sorted(self._items.values(), key=place)

    # --- entry points -------------------------------------------------------------------------------------

    def _entries(self, root: Module, entries: Iterable[str] | None) -> list[Item]:
        if entries is None:
            found = [d for d in root.declarations.values() if d.stage]
            if not found:
                raise WeslError(f"{'::'.join(root.path)} has no entry point", root.filename)
            return [self._item(root, declaration) for declaration in found]
        heads: list[Item] = []
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
        if not heads:
            raise WeslError("no entry point is asked for", root.filename)
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
        item = self._items.get(id(declaration))
        if item is None:
            item = self._items[id(declaration)] = Item(module, declaration)
        return item

    def _enter(self, module: Module) -> list[Item]:
        """Take a module into the program: its assertions and directives count from now on."""
        if module.path in self.modules:
            return []
        self.modules[module.path] = module
        for imported in module.imports.values():
            self._check_import(module, imported)
        return [self._item(module, declaration) for declaration in module.asserts]

    def _reach(self, heads: list[Item]) -> None:
        """Follow references from `heads` (and the assertions of every module met) to all that is needed."""
        todo = list(reversed(heads))
        for module in list(self.modules.values()):
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
                hint = self.library.declaring(name) or did_you_mean(name, known)
                raise item.error(f"'{name}' is not declared{hint}", reference.first)
            full = module.imports[name].path
        elif path[0] in module.imports:
            full = module.imports[path[0]].path + path[1:]
        else:
            full = absolute(path, module.path)
            if full is None:
                raise item.error("'super' leaves the package here", reference.first)
        full = self.library.real(full)
        home = self.library.module(full[:-1])
        if home is None:
            raise item.error(self._missing(full), reference.first)
        declaration = home.declarations.get(full[-1])
        if declaration is None:
            raise item.error(self._missing(full), reference.first)
        return self._item(home, declaration)

    def _check_import(self, module: Module, imported: Import) -> None:
        """An import must name a declaration or a module, even if nobody uses it.

        What a virtual package holds differs from pass to pass, so there only what is used must exist.
        """
        path = imported.path
        if (path[0],) in self.library.virtual:
            return
        home = self.library.module(path[:-1])
        declared = home is not None and path[-1] in home.declarations
        if not declared and self.library.module(path) is None and not self.library.folder(path):
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
