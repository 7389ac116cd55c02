"""Text to tokens.

Comments disappear here. Every token remembers where it stood (line and column, from 1) and the
*gap* to write in front of it again: nothing, one space, or a line break with its indentation. Emitting
``gap + text`` of each token therefore gives back readable source without comments and blank lines,
one output line for each source line that had code.
"""

from __future__ import annotations

import re
from typing import NamedTuple

from .errors import WeslError

NAME, NUMBER, SYMBOL, END = "name", "number", "symbol", "end"


class Token(NamedTuple):
    kind: str
    text: str
    line: int
    column: int
    gap: str


# `>` is always a token of its own: whether `>>` closes two template lists or shifts is not our business,
# since the gaps put the two characters together again. `<` is kept single for the same reason.
_TOKEN = re.compile(
    r"""
      (?P<space>\s+)
    | (?P<line_comment>//[^\n\v\f\r\u0085\u2028\u2029]*)
    | (?P<block_comment>/\*)
    | (?P<name>[^\W\d]\w*)
    | (?P<number>
          0[xX](?:[0-9a-fA-F]+\.?[0-9a-fA-F]*|\.[0-9a-fA-F]+)(?:[pP][+-]?[0-9]+[fh]?|[iu])?
        | (?:[0-9]+\.[0-9]*|\.[0-9]+|[0-9]+)(?:[eE][+-]?[0-9]+)?(?:[iufh]|l[iuf])?
      )
    | (?P<symbol>::|->|&&|\|\||==|!=|\+\+|--|[-+*/%&|^]=|[-+*/%&|^~!<>=(){}\[\],.;:@])
    """,
    re.VERBOSE,
)
_COMMENT_EDGE = re.compile(r"/\*|\*/")
_LINE_BREAK = re.compile(r"\r\n|[\n\v\f\r\u0085\u2028\u2029]")


def tokenize(text: str, filename: str) -> list[Token]:
    """Split WESL source into tokens, ending with one END token.

    Raises
    ------
    WeslError
        For a character WESL does not know and for a block comment without an end.
    """
    tokens: list[Token] = []
    position, line, line_start, size = 0, 1, 0, len(text)
    broke, spaced = True, False  # what lay between the last token and here
    match_at = _TOKEN.match
    while position < size:
        match = match_at(text, position)
        if match is None:
            raise WeslError(
                f"the character {text[position]!r} means nothing in WESL",
                filename,
                line,
                position - line_start + 1,
            )
        kind, end = match.lastgroup, match.end()
        if kind in (NAME, NUMBER, SYMBOL):
            column = position - line_start + 1
            if broke:
                gap = "\n" + " " * (column - 1)
            else:
                gap = " " if spaced else ""
            tokens.append(Token(kind, match.group(), line, column, gap))
            broke = spaced = False
        elif text[position:end] == " ":
            spaced = True
        else:
            if kind == "block_comment":
                end = _comment_end(text, position, filename, line, position - line_start + 1)
            spaced = True
            for found in _LINE_BREAK.finditer(text, position, end):
                line, line_start, broke = line + 1, found.end(), True
        position = end
    tokens.append(Token(END, "", line, position - line_start + 1, "\n"))
    return tokens


def _comment_end(text: str, start: int, filename: str, line: int, column: int) -> int:
    """Return the offset after the block comment that opens at `start`; such comments nest."""
    depth = 0
    for edge in _COMMENT_EDGE.finditer(text, start):
        depth += 1 if edge.group() == "/*" else -1
        if depth == 0:
            return edge.end()
    raise WeslError("this block comment has no end", filename, line, column)
