"""Which names inside a declaration mean something outside of it.

A scanner with a stack of scopes rather than a parser of expressions. Names after ``.`` are members, names in
attributes like ``@builtin(…)`` are words of the attribute, names of parameters and of ``let``, ``var`` and
``const`` hide outer ones from the end of their statement to the end of their block. What remains is a
reference, template arguments included, hence ``a < b`` against ``array<T, N>`` never has to be decided.
"""

from __future__ import annotations

from dataclasses import dataclass

from .errors import WeslError
from .lexer import NAME, SYMBOL, Token
from .words import KEYWORDS, WORD_ATTRIBUTES

Path = tuple[str, ...]
_OPENS, _CLOSES = frozenset("([{"), frozenset(")]}")


@dataclass(slots=True)
class Reference:
    """A name (or ``a::b`` path) in ``tokens[first:last]`` that means something outside the declaration."""

    path: Path
    first: int
    last: int


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
            while at < last and self.tokens[at].text != ">":
                at += 1
            return min(at + 1, last)
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
                name = tokens[min(at, last - 1)]
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
