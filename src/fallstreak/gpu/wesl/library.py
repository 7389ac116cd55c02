"""Where modules come from: files of the package, virtual packages, and the caches in between."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import lru_cache
from pathlib import Path as FilePath
from typing import Any

from .conditional import CONDITIONS, Conditions, uses_conditions
from .errors import WeslError, did_you_mean
from .lexer import NAME, Token, tokenize
from .syntax import Module, Parser, Path

Resolver = Callable[[Path], "tuple[str, str] | None"]


class Source:
    """The text of one module as tokens, with the modules it becomes under each set of flags."""

    def __init__(self, path: Path, filename: str, text: str):
        self.path, self.filename = path, filename
        self.tokens = tokenize(text, filename)
        self.conditional = uses_conditions(self.tokens)
        self.flags = frozenset(_flag_names(self.tokens)) if self.conditional else frozenset()
        self.variants: dict[tuple[tuple[str, bool], ...], Module] = {}

    def module(self, flags: Mapping[str, bool]) -> Module:
        key = tuple((name, bool(flags[name])) for name in sorted(self.flags) if name in flags)
        if key not in self.variants:
            tokens = self.tokens
            try:
                if self.conditional:
                    tokens = Conditions(tokens, flags, self.filename).strip()
                self.variants[key] = Parser(tokens, self.path, self.filename).parse()
            except RecursionError:
                raise WeslError("blocks or conditions are nested too deeply", self.filename) from None
        return self.variants[key]


def _flag_names(tokens: list[Token]) -> Iterable[str]:
    """Yield names inside the parentheses of conditions (a superset of the flags is good enough)."""
    for index, token in enumerate(tokens):
        if token.text == "@" and tokens[index + 1].text in CONDITIONS[:2]:
            depth, at = 0, index + 2
            while at < len(tokens):
                depth += (tokens[at].text == "(") - (tokens[at].text == ")")
                if tokens[at].kind == NAME:
                    yield tokens[at].text
                if depth <= 0:
                    break
                at += 1


# Keyed by the text itself: an edited file is a new source, an unedited one is never read twice.
source = lru_cache(maxsize=1024)(Source)


class Library:
    """All modules one link may see, under its flags."""

    def __init__(self, resolve: Resolver | None, flags: Mapping[str, bool], virtual: Mapping[str, Any]):
        self.resolve = resolve or package_resolver()
        self.flags = flags
        self.virtual = {
            tuple(name.split("::")): virtual_text(name, content) for name, content in virtual.items()
        }
        self.chosen = {
            (*name.split("::"), key): tuple(value.split("::"))
            for name, content in virtual.items()
            if isinstance(content, Mapping)
            for key, value in content.items()
            if _names_module(value)
        }
        self._modules: dict[Path, Module | None] = {}

    def module(self, path: Path) -> Module | None:
        """Return the module at `path` (``("package", "sky", "air")`` or a virtual one), or None."""
        if path not in self._modules:
            self._modules[path] = self._load(path)
        return self._modules[path]

    def _load(self, path: Path) -> Module | None:
        if path in self.virtual:
            return source(path, f"<{'::'.join(path)}>", self.virtual[path]).module(self.flags)
        if len(path) < 2 or path[0] != "package":
            return None
        try:
            found = self.resolve(path[1:])
        except (LookupError, FileNotFoundError):
            return None
        if found is None:
            return None
        text, filename = found
        return source(path, filename, text).module(self.flags)

    def real(self, path: Path) -> Path:
        """Return `path` with a module that a constant names put in the constant's place."""
        for head, module in self.chosen.items():
            if path[: len(head)] == head and len(path) > len(head):
                return module + path[len(head) :]
        return path

    def packages(self) -> list[str]:
        """Return the words an absolute path may begin with."""
        return ["package", "super", *(path[0] for path in self.virtual)]

    def folder(self, path: Path) -> bool:
        """Tell whether modules lie below `path`: a folder counts as an empty module."""
        below = "::".join(path[1:]) + "::"
        return any(name.startswith(below) for name in getattr(self.resolve, "names", list)())

    def suggestion(self, path: Path) -> str:
        """Return a did-you-mean for a module that does not exist, if its neighbours can be listed."""
        names = getattr(self.resolve, "names", None)
        if names is None:
            return ""
        return did_you_mean("::".join(path), ["package::" + name for name in names()])

    def declaring(self, name: str) -> str:
        """Return a hint if another module of the package, or a virtual one, declares `name`."""
        declared = re.compile(
            rf"^[^\n/]*\b(?:fn|struct|const|override|alias)\s+{re.escape(name)}\b", re.MULTILINE
        )
        texts = {"::".join(path): text for path, text in self.virtual.items()}
        for module in getattr(self.resolve, "names", list)():
            found = self.resolve(tuple(module.split("::")))
            texts[f"package::{module}"] = found[0] if found else ""
        homes = [module for module, text in texts.items() if declared.search(text)]
        return f"; {homes[0]} declares it: import {homes[0]}::{name}" if homes else ""


class package_resolver:
    """Finds modules as files: ``("sky", "air")`` is ``root/sky/air.wesl`` (or ``.wgsl``).

    Parameters
    ----------
    root : pathlib.Path, optional
        The folder of the package; that of ``fallstreak`` when left out.
    """

    def __init__(self, root: FilePath | str | None = None):
        self.root = FilePath(root) if root is not None else FilePath(__file__).resolve().parents[2]
        self._texts: dict[FilePath, tuple[int, str]] = {}

    def __call__(self, path: Path) -> tuple[str, str] | None:
        for suffix in (".wesl", ".wgsl"):
            file = self.root.joinpath(*path[:-1], path[-1] + suffix)
            try:
                stamp = file.stat().st_mtime_ns
            except OSError:
                continue
            cached = self._texts.get(file)
            if cached is None or cached[0] != stamp:
                try:
                    cached = self._texts[file] = (stamp, file.read_text(encoding="utf-8"))
                except UnicodeDecodeError:
                    raise WeslError("this file is not UTF-8 text", self._shown(file)) from None
            return cached[1], self._shown(file)
        return None

    def names(self) -> list[str]:
        """List all modules, as ``sky::air``."""
        files = (file for suffix in ("wesl", "wgsl") for file in self.root.rglob(f"*.{suffix}"))
        return sorted("::".join(file.relative_to(self.root).with_suffix("").parts) for file in files)

    def _shown(self, file: FilePath) -> str:
        """Return the file as messages show it: from the package's folder on, the same on every machine."""
        return file.relative_to(self.root.parent).as_posix()


# --- virtual packages --------------------------------------------------------------------------------


def virtual_text(name: str, content: Any) -> str:
    """Return the WESL source of a virtual package: constants, structs, or a text as it is."""
    if isinstance(content, str):
        return content
    if isinstance(content, Mapping):
        values = {key: value for key, value in content.items() if not _names_module(value)}
        return "\n".join(f"const {key} = {_literal(name, key, value)};" for key, value in values.items())
    return "\n".join(_structs(content))


def _names_module(value: Any) -> bool:
    return isinstance(value, str) and value.startswith("package::")


def _structs(structs: Sequence[Any]) -> list[str]:
    """Return the declarations of structs and of those they contain, each name once."""
    texts: dict[str, str] = {}

    def visit(struct: Any) -> None:
        for inner in struct.dependencies:
            visit(inner)
        text = struct.wgsl()
        if texts.setdefault(struct.name, text) != text:
            raise WeslError(f"two different structs are called '{struct.name}'", "<structs>")

    for struct in structs:
        visit(struct)
    return list(texts.values())


def _literal(package: str, key: str, value: Any) -> str:
    """Write a Python value as a WGSL constant expression of abstract type."""
    if not key.isidentifier():
        raise WeslError(f"'{key}' cannot be the name of a constant", f"<{package}>")
    if hasattr(value, "tolist"):  # numpy scalars and arrays
        value = value.tolist()
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int):
        if not -(2**63) <= value < 2**63:
            raise WeslError(f"the constant {key} is {value}; integers have 64 bits", f"<{package}>")
        return str(value)
    if isinstance(value, float):
        if not math.isfinite(value):
            raise WeslError(f"the constant {key} is {value}; WGSL has finite numbers only", f"<{package}>")
        return repr(value)
    if isinstance(value, (tuple, list)) and value:
        parts = [_literal(package, key, part) for part in value]
        return f"{f'vec{len(parts)}' if _is_vector(value) else 'array'}({', '.join(parts)})"
    raise WeslError(
        f"the constant {key} is {value!r}; numbers, booleans and tuples of them are possible", f"<{package}>"
    )


def _is_vector(value: Sequence[Any]) -> bool:
    return 2 <= len(value) <= 4 and not any(isinstance(part, (tuple, list)) for part in value)
