"""Tokens to declarations, and every name to what it may mean.

WESL needs no expression tree: to link a module one must know its imports, where each module-level declaration
begins and ends, and which of the names inside refer to something outside of it. So this is a scanner with a
stack of scopes rather than a parser of expressions. Names after ``.`` are members, names in attributes like
``@builtin(…)`` are words of the attribute, names of parameters and of ``let``/``var``/``const`` hide outer
ones from the end of their statement to the end of their block. What remains is a reference, template
arguments included, hence ``a < b`` against ``array<T, N>`` never has to be decided.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from .errors import WeslError
from .lexer import END, NAME, SYMBOL, Token
from .words import KEYWORDS, WORD_ATTRIBUTES

Path = tuple[str, ...]
DIRECTIVES = ("enable", "requires", "diagnostic")
_KINDS = ("fn", "struct", "const", "override", "var", "alias", "const_assert")
_OPENS, _CLOSES = frozenset("([{"), frozenset(")]}")
STAGES = ("compute", "vertex", "fragment")


@dataclass(slots=True)
class Reference:
    """A name (or ``a::b`` path) in ``tokens[first:last]`` that means something outside the declaration."""

    path: Path
    first: int
    last: int


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
    """Resolve leading ``package`` and ``super`` of `path` inside `module`; None when ``super`` leaves the package.

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

    def _import_tree(self, prefix: Path) -> None:
        """Read ``a::b``, ``a::b as c`` or ``a::{…}`` behind `prefix`."""
        path = prefix
        while True:
            token = self.tokens[self.at]
            if token.text == "{" and path:
                return self._import_list(path)
            if token.kind != NAME or (token.text in KEYWORDS):
                raise self._error(f"an import needs a name here, not '{token.text}'", token)
            if (token.text == "package" and path) or (token.text == "super" and any(p != "super" for p in path)):
                raise self._error(f"'{token.text}' can only begin an import path", token)
            path += (token.text,)
            self.at += 1
            if self.tokens[self.at].text != "::":
                break
            self.at += 1
        name = token
        if self.tokens[self.at].text == "as":
            name = self.tokens[self.at + 1]
            if name.kind != NAME or name.text in KEYWORDS:
                raise self._error("'as' needs a name", name)
            self.at += 2
        if path[-1] in ("super", "package"):
            raise self._error(f"'{path[-1]}' alone cannot be imported", token)
        resolved = absolute(path, self.module.path)
        if resolved is None:
            raise self._error("'super' leaves the package here", token)
        self._claim(name.text, name)
        self.module.imports[name.text] = Import(resolved, token)

    def _import_list(self, prefix: Path) -> None:
        opening = self.tokens[self.at]
        self.at += 1
        while self.tokens[self.at].text != "}":
            self._import_tree(prefix)
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
            if name.kind != NAME or name.text in KEYWORDS:
                raise self._error(f"'{kind}' needs a name here, not '{name.text}'", name)
        if kind in ("fn", "struct"):
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
            if token.kind == END or token.text == ";":
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


class References:
    """Walk one declaration and collect the names that are not its own."""

    def __init__(self, tokens: list[Token], kind: str, name_at: int, filename: str):
        self.tokens, self.kind, self.name_at, self.filename = tokens, kind, name_at, filename
        self.found: list[Reference] = []
        self.scopes: list[set[str]] = []
        self.locals: set[str] = set()

    def collect(self) -> tuple[list[Reference], frozenset[str]]:
        if self.kind == "struct":
            self._struct()
        elif self.kind == "fn":
            self._function()
        else:
            self._plain(0, len(self.tokens), skip=self.name_at)
        return self.found, frozenset(self.locals)

    def _plain(self, first: int, last: int, skip: int = -1) -> None:
        """Collect from tokens that declare nothing."""
        at = first
        while at < last:
            at = at + 1 if at == skip else self._step(at, last)

    def _step(self, at: int, last: int) -> int:
        """Handle one token (or attribute, or path) and return the index behind it."""
        token = self.tokens[at]
        if token.text == "@":
            name = self.tokens[at + 1].text
            after = at + 2
            if name in WORD_ATTRIBUTES and after < last and self.tokens[after].text == "(":
                after = self._behind(after)
            return after
        if token.kind != NAME:
            return at + 1
        if at and self.tokens[at - 1].text == ".":
            return at + 1
        if token.text == "var" and self.tokens[at + 1].text == "<":  # address space and access: words
            at += 1
            while self.tokens[at].text != ">":
                at += 1
            return at + 1
        end = at + 1
        if token.text in KEYWORDS or token.text == "_":
            return end
        while end + 1 < last and self.tokens[end].text == "::":
            if self.tokens[end + 1].kind != NAME:
                raise WeslError(
                    "a name is missing after '::'",
                    self.filename,
                    self.tokens[end].line,
                    self.tokens[end].column,
                )
            end += 2
        path = tuple(self.tokens[index].text for index in range(at, end, 2))
        if len(path) > 1 or not any(token.text in scope for scope in self.scopes):
            self.found.append(Reference(path, at, end))
        return end

    def _behind(self, at: int) -> int:
        """Return the index behind the bracket that closes the one at `at`."""
        depth = 0
        while True:
            depth += (self.tokens[at].text in _OPENS) - (self.tokens[at].text in _CLOSES)
            at += 1
            if depth == 0:
                return at

    def _named_list(self, first: int, last: int) -> set[str]:
        """Collect from ``@attributes name: type, …`` (members, parameters) and return the names."""
        names: set[str] = set()
        at = first
        while at < last:
            token = self.tokens[at]
            # A single ':' occurs nowhere else in such a list.
            if token.kind == NAME and at + 1 < last and self.tokens[at + 1].text == ":":
                if token.text in names:
                    raise WeslError(
                        f"'{token.text}' is declared twice", self.filename, token.line, token.column
                    )
                names.add(token.text)
                at += 2
            else:
                at = self._step(at, last)
        return names

    def _struct(self) -> None:
        self._plain(0, self.name_at)
        self._named_list(self.name_at + 2, len(self.tokens))

    def _function(self) -> None:
        self._plain(0, self.name_at)
        opening = self.name_at + 1
        after = self._behind(opening)
        parameters = self._named_list(opening + 1, after - 1)
        body = after
        depth = 0
        while depth or self.tokens[body].text != "{":
            depth += (self.tokens[body].text == "(") - (self.tokens[body].text == ")")
            body += 1
        self._plain(after, body)
        self.locals |= parameters
        self._body(body, parameters)

    def _body(self, first: int, parameters: set[str]) -> None:
        """Walk a function body with its scopes; parameters live in the scope of the body itself."""
        tokens, last = self.tokens, len(self.tokens)
        pending: set[str] | None = parameters  # names that the next '{' brings into scope
        declared: str | None = None  # a name whose statement has not ended yet
        parens, for_parens = 0, []  # for_parens: depth of each open `for (` header
        for_scopes: list[int] = []  # number of scopes below each `for` whose body is open
        at = first
        while at < last:
            token = tokens[at]
            text = token.text
            if token.kind == SYMBOL:
                if text == "{":
                    self.scopes.append(pending or set())
                    pending = None
                elif text == "}":
                    self.scopes.pop()
                    if for_scopes and for_scopes[-1] == len(self.scopes):
                        for_scopes.pop()
                        self.scopes.pop()
                elif text == "(":
                    parens += 1
                elif text == ")":
                    parens -= 1
                    if for_parens and for_parens[-1] == parens:
                        for_parens.pop()
                        for_scopes.append(len(self.scopes))
                elif text == ";" and declared is not None:
                    self.scopes[-1].add(declared)
                    declared = None
                at = at + 1 if text != "@" else self._step(at, last)
            elif text == "for" and tokens[at + 1].text == "(":
                self.scopes.append(set())
                for_parens.append(parens)
                at += 1
            elif text in ("let", "const", "var"):
                at = self._step(at, last)
                name = tokens[at]
                if name.kind != NAME or name.text in KEYWORDS:
                    raise WeslError(
                        f"'{text}' needs a name here, not '{name.text}'",
                        self.filename,
                        name.line,
                        name.column,
                    )
                declared = name.text
                self.locals.add(declared)
                at += 1
            else:
                at = self._step(at, last)
