"""A small evaluator for whole-number constants, as ``@workgroup_size(TILE * 2, 8u)`` needs them."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from .lexer import NAME, NUMBER, Token

if TYPE_CHECKING:
    from .program import Item

_INTEGER = re.compile(r"(0[xX][0-9a-fA-F]+|0|[1-9][0-9]*)[iu]?")
_LEVELS = (("|",), ("^",), ("&",), ("+", "-"), ("*", "/", "%"))


class _Unknown(Exception):
    """The expression is beyond this evaluator (an override, a float, a function)."""


def evaluate(item: Item, tokens: list[Token], depth: int = 0) -> int | None:
    """Return the value of an integer expression inside `item`, or None when it cannot be told here."""
    try:
        return _Evaluator(item, tokens, depth).value()
    except _Unknown:
        return None


class _Evaluator:
    def __init__(self, item: Item, tokens: list[Token], depth: int):
        self.item, self.tokens, self.depth = item, tokens, depth
        self.at = 0

    def value(self) -> int:
        value = self._level(0)
        if self.at != len(self.tokens):
            raise _Unknown
        return value

    def _peek(self) -> str:
        return self.tokens[self.at].text if self.at < len(self.tokens) else ""

    def _level(self, level: int) -> int:
        if level == len(_LEVELS):
            return self._unary()
        value = self._level(level + 1)
        while self._peek() in _LEVELS[level]:
            operator = self._peek()
            self.at += 1
            value = _apply(operator, value, self._level(level + 1))
        return value

    def _unary(self) -> int:
        if self.at >= len(self.tokens):
            raise _Unknown
        token = self.tokens[self.at]
        self.at += 1
        if token.text == "-":
            return -self._unary()
        if token.text == "(":
            value = self._level(0)
            if self._peek() != ")":
                raise _Unknown
            self.at += 1
            return value
        if token.kind == NUMBER:
            match = _INTEGER.fullmatch(token.text)
            if match is None:
                raise _Unknown
            return int(match.group(1), 0)
        if token.kind == NAME:
            return self._name(token)
        raise _Unknown

    def _name(self, token: Token) -> int:
        path = [token.text]
        while self._peek() == "::":
            path.append(self.tokens[self.at + 1].text)
            self.at += 2
        if path in (["u32"], ["i32"]) and self._peek() == "(":
            return self._unary()
        target = self.item.targets.get(tuple(path))
        if target is None or target.declaration.kind != "const" or self.depth > 32:
            raise _Unknown
        tokens = target.declaration.tokens
        start = next((index for index, t in enumerate(tokens) if t.text == "="), None)
        if start is None:
            raise _Unknown
        value = evaluate(target, tokens[start + 1 : -1], self.depth + 1)
        if value is None:
            raise _Unknown
        return value


def _apply(operator: str, left: int, right: int) -> int:
    if operator in "/%":
        if right == 0:
            raise _Unknown
        quotient = abs(left) // abs(right) * (1 if (left < 0) == (right < 0) else -1)  # towards zero
        return quotient if operator == "/" else left - quotient * right
    return {
        "+": left + right,
        "-": left - right,
        "*": left * right,
        "&": left & right,
        "|": left | right,
        "^": left ^ right,
    }[operator]
