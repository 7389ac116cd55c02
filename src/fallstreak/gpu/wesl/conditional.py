"""`@if`, `@elif`, `@else`: what is compiled at all.

The pass works on tokens: it walks the module once, finds the extent of every decorated node (directive,
import, declaration, struct member, parameter, statement, switch clause) and keeps or drops its tokens. What
comes out is a module without conditions, so that the parser after it never hears of them.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

from .errors import WeslError, did_you_mean
from .lexer import END, NAME, Token

CONDITIONS = ("if", "elif", "else")
_OPENS, _CLOSES = frozenset("([{"), frozenset(")]}")


def uses_conditions(tokens: list[Token]) -> bool:
    """Tell whether any `@if` occurs, so that modules without one skip this pass."""
    return any(
        token.text == "@" and tokens[index + 1].text in CONDITIONS for index, token in enumerate(tokens[:-1])
    )


class Conditions:
    """One walk over one module's tokens under one set of flags."""

    def __init__(self, tokens: list[Token], flags: Mapping[str, bool], filename: str):
        self.tokens, self.flags, self.filename = tokens, flags, filename
        self.at = 0
        self.kept: list[Token] = []

    def strip(self) -> list[Token]:
        """Return the tokens that remain, END included."""
        self._nodes(self._declaration, stop=None)
        self.kept.append(self.tokens[self.at])
        for token, after in zip(self.kept, self.kept[1:], strict=False):
            if token.text == "@" and after.text in CONDITIONS:
                raise self._error("a condition cannot stand here", token)
        return self.kept

    # --- sequences of nodes -------------------------------------------------------------------------------

    def _nodes(self, node: Callable[[], None], stop: str | None) -> None:
        """Walk sibling nodes up to `stop` (or the end), applying the chain of conditions between them."""
        chain: bool | None = None  # None: no chain is open; else: has a branch of it been taken?
        while True:
            token = self.tokens[self.at]
            if token.kind == END or token.text == stop:
                if token.kind == END and stop is not None:
                    raise self._error(f"the file ends where a '{stop}' is missing", token)
                return
            start, keep_from = self.at, len(self.kept)
            condition, where = self._attributes()
            if condition is None:
                chain, alive = None, True
            else:
                alive, chain = self._decide(condition, where, chain)
            if self.tokens[self.at].kind == END or self.tokens[self.at].text == stop:
                raise self._error("this attribute decorates nothing", where or self.tokens[start])
            begin = self.at
            node()
            if self.at == begin:
                token = self.tokens[begin]
                raise self._error(f"'{token.text}' is not expected here", token)
            if where is not None and alive:
                # The node now begins where its condition stood.
                self.kept[keep_from] = self.kept[keep_from]._replace(gap=self.tokens[start].gap)
            if not alive:
                del self.kept[keep_from:]

    def _attributes(self) -> tuple[tuple[str, bool] | None, Token | None]:
        """Consume the attributes in front of a node; keep all but the condition.

        Returns the condition, as ("if" | "elif" | "else", value), and its token.
        """
        condition: tuple[str, bool] | None = None
        where: Token | None = None
        while self.tokens[self.at].text == "@":
            name = self.tokens[self.at + 1]
            if name.kind != NAME:
                raise self._error("an attribute needs a name", self.tokens[self.at])
            if name.text in CONDITIONS:
                if where is not None:
                    raise self._error("a node takes one condition; write @if(a && b)", name)
                where = name
                self.at += 2
                condition = (name.text, name.text == "else" or self._condition(name))
            else:
                self._keep(2)
                if self.tokens[self.at].text == "(":
                    self._balanced()
        return condition, where

    def _decide(
        self, condition: tuple[str, bool], where: Token | None, chain: bool | None
    ) -> tuple[bool, bool | None]:
        """Return (is this node alive, state of the chain after it)."""
        word, value = condition
        if word == "if":
            return value, value
        if chain is None:
            raise self._error(f"@{word} must directly follow a node with @if or @elif", where)
        alive = value and not chain
        return alive, None if word == "else" else chain or value

    # --- nodes --------------------------------------------------------------------------------------------

    def _declaration(self) -> None:
        """Keep one module-level node: import, directive or declaration."""
        word = self.tokens[self.at].text
        if word == "fn":
            self._until("(")
            self._list("(", ")")
            self._until("{")
            self._block()
        elif word == "struct":
            self._until("{")
            self._list("{", "}")
            if self.tokens[self.at].text == ";":
                self._keep(1)
        else:
            self._through_semicolon()

    def _list(self, opening: str, closing: str) -> None:
        """Keep a comma-separated list of members or parameters."""
        self._keep(1)
        self._nodes(self._item, stop=closing)
        self._keep(1)

    def _item(self) -> None:
        """Keep one member or parameter with the comma after it."""
        templates = 0
        while True:
            token = self.tokens[self.at]
            if token.kind == END or token.text in _CLOSES:
                return
            if token.text in _OPENS:
                self._balanced()
                continue
            # A type is no place for comparisons, so every `<` here opens a template list.
            templates += (token.text == "<") - (token.text == ">")
            self._keep(1)
            if token.text == "," and templates == 0:
                return

    def _block(self) -> None:
        self._keep(1)
        self._nodes(self._statement, stop="}")
        self._keep(1)

    def _statement(self) -> None:
        """Keep one statement (or switch clause) with everything inside it."""
        word = self.tokens[self.at].text
        if word == "{":
            self._block()
        elif word in ("for", "while", "loop", "switch", "if", "case", "default", "continuing"):
            self._to_brace()
            self._block()
            while word == "if" and self.tokens[self.at].text == "else":
                self._to_brace()
                self._block()
        else:
            self._through_semicolon()

    # --- tokens -------------------------------------------------------------------------------------------

    def _keep(self, count: int) -> None:
        last = self.tokens[-1]
        if self.at + count >= len(self.tokens):
            raise self._error("the file ends too early", last)
        self.kept.extend(self.tokens[self.at : self.at + count])
        self.at += count

    def _until(self, text: str) -> None:
        start = self.tokens[self.at]
        while self.tokens[self.at].text != text:
            if self.tokens[self.at].kind == END or self.tokens[self.at].text == ";":
                raise self._error(f"'{start.text}' needs a '{text}'", start)
            self._keep(1)

    def _to_brace(self) -> None:
        """Keep the head of a statement (its parentheses may hold semicolons) and attributes before '{'."""
        start = self.tokens[self.at]
        while self.tokens[self.at].text != "{":
            token = self.tokens[self.at]
            if token.kind == END or token.text in ";}":
                raise self._error(f"'{start.text}' needs a '{{'", start)
            if token.text in _OPENS:
                self._balanced()
            else:
                self._keep(1)

    def _through_semicolon(self) -> None:
        start = self.tokens[self.at]
        while self.tokens[self.at].text != ";":
            token = self.tokens[self.at]
            if token.kind == END or token.text in _CLOSES:
                raise self._error("a ';' is missing after this", start)
            if token.text in _OPENS:
                self._balanced()
            else:
                self._keep(1)
        self._keep(1)

    def _balanced(self) -> None:
        """Keep a bracketed group."""
        start, depth = self.tokens[self.at], 0
        while True:
            token = self.tokens[self.at]
            if token.kind == END:
                raise self._error(f"this '{start.text}' is never closed", start)
            depth += (token.text in _OPENS) - (token.text in _CLOSES)
            self._keep(1)
            if depth == 0:
                return

    # --- conditions ---------------------------------------------------------------------------------------

    def _condition(self, where: Token) -> bool:
        """Evaluate ``( expression )`` of an @if; every flag in it must be known."""
        if self.tokens[self.at].text != "(":
            raise self._error(f"@{where.text} needs a condition in parentheses", where)
        self.at += 1
        value = self._either()
        if self.tokens[self.at].text == ",":
            self.at += 1
        self._close(where)
        return value

    def _close(self, where: Token) -> None:
        if self.tokens[self.at].text != ")":
            raise self._error("a condition is made of flags, true, false, !, && , || and parentheses", where)
        self.at += 1

    def _either(self) -> bool:
        value = self._both()
        while self.tokens[self.at].text == "||":
            self.at += 1
            value = self._both() or value
        return value

    def _both(self) -> bool:
        value = self._single()
        while self.tokens[self.at].text == "&&":
            self.at += 1
            value = self._single() and value
        return value

    def _single(self) -> bool:
        token = self.tokens[self.at]
        self.at += 1
        if token.text == "!":
            return not self._single()
        if token.text == "(":
            value = self._either()
            self._close(token)
            return value
        if token.text in ("true", "false"):
            return token.text == "true"
        if token.kind != NAME:
            raise self._error("a condition is made of flags, true, false, !, &&, || and parentheses", token)
        if token.text not in self.flags:
            known = ", ".join(sorted(self.flags)) or "none"
            raise self._error(
                f"the flag '{token.text}' is not set to true or false (flags: {known})"
                + did_you_mean(token.text, self.flags),
                token,
            )
        return bool(self.flags[token.text])

    def _error(self, message: str, token: Token | None) -> WeslError:
        token = token or self.tokens[self.at]
        return WeslError(message, self.filename, token.line, token.column)
