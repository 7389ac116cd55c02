"""Tokens to modules: imports, directives, and where each declaration begins and ends.

WESL needs no expression tree to be linked; what happens inside a declaration is told by `scope`.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from .errors import WeslError
from .lexer import END, NAME, Token
from .scope import Path, Reference, References
from .words import KEYWORDS, WESL_KEYWORDS

DIRECTIVES = ("enable", "requires", "diagnostic")
_KINDS = ("fn", "struct", "const", "override", "var", "alias", "const_assert")
_OPENS, _CLOSES = frozenset("([{"), frozenset(")]}")
STAGES = ("compute", "vertex", "fragment")


@dataclass(slots=True, eq=False)
class Declaration:
    """One module-level declaration: its tokens, its own name at ``tokens[name_at]`` and what it refers to.

    ``locals`` are all names declared inside a function: no outside name may be emitted with one of them.
    """

    kind: str
    name: str
    tokens: list[Token]
    name_at: int
    references: list[Reference]
    locals: frozenset[str]
    attributes: dict[str, list[Token]]
    pieces: Any = None  # how to write it, made by the emitter on first use

    @property
    def stage(self) -> str | None:
        return next((stage for stage in STAGES if stage in self.attributes), None)


@dataclass(slots=True)
class Import:
    """``import a::b as name;``: `path` is absolute but for an external first word."""

    path: Path
    token: Token


@dataclass(slots=True)
class Module:
    """A parsed module under one set of flags."""

    path: Path
    filename: str
    imports: dict[str, Import] = field(default_factory=dict)
    directives: list[list[Token]] = field(default_factory=list)
    declarations: dict[str, Declaration] = field(default_factory=dict)
    asserts: list[Declaration] = field(default_factory=list)


def absolute(path: Path, module: Path) -> Path | None:
    """Resolve the leading ``super`` of `path` inside `module`; None when it leaves the package.

    ``super`` is the folder of the module: in ``package::sky::air`` it means ``package::sky``.
    """
    if path[0] != "super":
        return path
    base, rest = module, path
    while rest and rest[0] == "super":
        base, rest = base[:-1], rest[1:]
        if not base:
            return None
    return base + rest


class Parser:
    def __init__(self, tokens: list[Token], path: Path, filename: str):
        self.tokens, self.at = tokens, 0
        self.module = Module(path, filename)

    # --- modules ------------------------------------------------------------------------------------------

    def parse(self) -> Module:
        """Parse a whole module (conditions must be resolved already)."""
        module = self.module
        while self.tokens[self.at].kind != END:
            word = self.tokens[self.at].text
            if word == ";":
                self.at += 1
            elif word == "import":
                self._import()
            elif word in DIRECTIVES:
                start = self.at
                self._skip_statement()
                module.directives.append(self.tokens[start : self.at])
            else:
                declaration = self._declaration()
                if declaration.kind == "const_assert":
                    module.asserts.append(declaration)
                else:
                    self._claim(declaration.name, declaration.tokens[declaration.name_at])
                    module.declarations[declaration.name] = declaration
        return module

    def _claim(self, name: str, token: Token) -> None:
        """Refuse a second declaration or import of one name."""
        earlier = None
        if name in self.module.declarations:
            old = self.module.declarations[name]
            earlier = old.tokens[old.name_at]
        elif name in self.module.imports:
            earlier = self.module.imports[name].token
        if earlier is not None:
            raise self._error(f"'{name}' is declared twice, first in line {earlier.line}", token)

    # --- imports ------------------------------------------------------------------------------------------

    def _import(self) -> None:
        start = self.tokens[self.at]
        self.at += 1
        self._import_tree(())
        if self.tokens[self.at].text != ";":
            raise self._error("a ';' is missing after this import", start)
        self.at += 1

    def _import_tree(self, prefix: Path, nesting: int = 0) -> None:
        """Read ``a::b``, ``a::b as c`` or ``a::{…}`` behind `prefix`."""
        path = prefix
        while True:
            token = self.tokens[self.at]
            if token.text == "{" and (path or nesting == 0):
                return self._import_list(path, nesting + 1)
            if token.kind != NAME or token.text in KEYWORDS or token.text in ("as", "import", "self"):
                raise self._error(f"an import needs a name here, not '{token.text}'", token)
            misplaced = path or nesting if token.text == "package" else nesting or set(path) - {"super"}
            if token.text in ("package", "super") and misplaced:
                raise self._error(f"'{token.text}' can only begin an import path", token)
            path += (token.text,)
            self.at += 1
            if self.tokens[self.at].text != "::":
                break
            self.at += 1
        name = token
        if self.tokens[self.at].text == "as":
            name = self.tokens[self.at + 1]
            if name.kind != NAME or name.text in KEYWORDS or name.text in WESL_KEYWORDS:
                raise self._error("'as' needs a name", name)
            self.at += 2
        if path[-1] in ("super", "package"):
            raise self._error(f"'{path[-1]}' alone cannot be imported", token)
        resolved = absolute(path, self.module.path)
        if resolved is None:
            raise self._error("'super' leaves the package here", token)
        self._claim(name.text, name)
        self.module.imports[name.text] = Import(resolved, token)

    def _import_list(self, prefix: Path, nesting: int) -> None:
        opening = self.tokens[self.at]
        self.at += 1
        if self.tokens[self.at].text == "}":
            raise self._error("this import list is empty", opening)
        while self.tokens[self.at].text != "}":
            self._import_tree(prefix, nesting)
            if self.tokens[self.at].text == ",":
                self.at += 1
            elif self.tokens[self.at].text != "}":
                raise self._error("the names of this import list are separated by ','", opening)
        self.at += 1

    # --- declarations -------------------------------------------------------------------------------------

    def _declaration(self) -> Declaration:
        start = self.at
        attributes = self._attribute_names()
        token = self.tokens[self.at]
        if token.text not in _KINDS:
            raise self._error(f"a declaration is expected here, not '{token.text}'", token)
        kind = token.text
        self.at += 1
        if kind == "var" and self.tokens[self.at].text == "<":
            self._skip_template()
        if kind == "const_assert":
            name_at = start
        else:
            name_at = self.at
            name = self.tokens[name_at]
            if name.kind != NAME or name.text in KEYWORDS or name.text in WESL_KEYWORDS:
                raise self._error(f"'{kind}' needs a name here, not '{name.text}'", name)
        if kind in ("fn", "struct"):
            after = self.tokens[self.at + 1]
            if after.text != ("(" if kind == "fn" else "{"):
                raise self._error(f"'{after.text}' cannot follow the name of a {kind}", after)
            self._skip_body(token)
        else:
            self._skip_statement()
        tokens = self.tokens[start : self.at]
        scan = References(tokens, kind, name_at - start, self.module.filename)
        references, names = scan.collect()
        own_name = "" if kind == "const_assert" else tokens[name_at - start].text
        return Declaration(kind, own_name, tokens, name_at - start, references, names, attributes)

    def _attribute_names(self) -> dict[str, list[Token]]:
        """Consume attributes; return the argument tokens of each."""
        found: dict[str, list[Token]] = {}
        while self.tokens[self.at].text == "@":
            name = self.tokens[self.at + 1]
            if name.kind != NAME:
                raise self._error("an attribute needs a name", self.tokens[self.at])
            self.at += 2
            arguments: list[Token] = []
            if self.tokens[self.at].text == "(":
                start = self.at
                self._skip_balanced()
                arguments = self.tokens[start + 1 : self.at - 1]
            found[name.text] = arguments
        return found

    def _skip_body(self, start: Token) -> None:
        """Go behind the closing brace of a function or struct."""
        while self.tokens[self.at].text != "{":
            token = self.tokens[self.at]
            if token.kind == END or token.text == ";" or token.text in _CLOSES:
                raise self._error(f"this {start.text} needs a body in braces", start)
            if token.text in _OPENS:
                self._skip_balanced()
            else:
                self.at += 1
        self._skip_balanced()

    def _skip_statement(self) -> None:
        start = self.tokens[self.at]
        while self.tokens[self.at].text != ";":
            token = self.tokens[self.at]
            if token.kind == END or token.text in _CLOSES:
                raise self._error("a ';' is missing after this", start)
            if token.text in _OPENS:
                self._skip_balanced()
            else:
                self.at += 1
        self.at += 1

    def _skip_balanced(self) -> None:
        """Go behind the bracket that closes the one at hand, checking that kinds agree."""
        pairs, open_brackets = {"(": ")", "[": "]", "{": "}"}, []
        while True:
            token = self.tokens[self.at]
            if token.kind == END:
                raise self._error(f"this '{open_brackets[-1].text}' is never closed", open_brackets[-1])
            if token.text in _OPENS:
                open_brackets.append(token)
            elif token.text in _CLOSES:
                opening = open_brackets.pop()
                if pairs[opening.text] != token.text:
                    raise self._error(
                        f"'{token.text}' closes the '{opening.text}' of line {opening.line}", token
                    )
            self.at += 1
            if not open_brackets:
                return

    def _skip_template(self) -> None:
        depth, start = 0, self.tokens[self.at]
        while True:
            token = self.tokens[self.at]
            if token.kind == END or token.text == ";":
                raise self._error("this '<' is never closed", start)
            depth += (token.text == "<") - (token.text == ">")
            self.at += 1
            if depth == 0:
                return

    def _error(self, message: str, token: Token) -> WeslError:
        return WeslError(message, self.module.filename, token.line, token.column)
