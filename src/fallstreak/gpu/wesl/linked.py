"""The result of linking, and the way back from the compiler's messages to the source."""

from __future__ import annotations

import re
from bisect import bisect_right
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from .emit import walk, written
from .interface import Binding, EntryPoint

if TYPE_CHECKING:
    from .program import Item

_HEADER = re.compile(r"^(?P<indent> *)┌─ (?P<label>.*):(?P<line>\d+):(?P<column>\d+)\s*$")
_GUTTER = re.compile(r"^(?P<indent> *)(?P<line>\d+)(?P<rest> │.*)$")
_CARETS = re.compile(r"^ *[│|][ │╭╰]* (?P<carets>\^+)")
_OWNER = re.compile(r"Entry point (\w+) at|Function \[\d+\] '(\w+)'")
_SENTENCE = re.compile(r"(?:parsing|validation) error: *(.+)")


@dataclass(frozen=True)
class Linked:
    """One linked shader.

    Attributes
    ----------
    code : str
        WGSL.
    bindings : dict of str to Binding
        By the variable's own name in its module.
    entries : dict of str to EntryPoint
    names : dict of str to str
        From names in `code` to what they are called in the source, ``sky_air_density`` to
        ``package::sky::air::density``.
    """

    code: str
    bindings: dict[str, Binding]
    entries: dict[str, EntryPoint]
    names: dict[str, str]
    _places: list[tuple[str, int]] = field(repr=False)
    _parts: list[tuple[int, Item]] = field(repr=False)

    def locate(self, line: int) -> tuple[str, int]:
        """Return the ``.wesl`` file and line that a line of `code` (from 1) came from."""
        return self._places[min(max(line, 1), len(self._places)) - 1]

    def position(self, line: int, column: int) -> tuple[str, int, int]:
        """Return file, line and column in the source for a place in `code` (all from 1)."""
        filename, source_line = self.locate(line)
        index = bisect_right(self._parts, line, key=lambda part: part[0]) - 1
        if index < 0:
            return filename, source_line, column
        current, item = self._parts[index]
        current -= 1
        at, best = 1, 1
        for token, gap, path in walk(item.declaration):
            if gap.startswith("\n"):
                current, at = current + 1, 1
                gap = gap[1:]
            if current > line:
                break
            at += len(gap)
            if current == line:
                if at > column:
                    break
                best = token.column + (column - at if path is None else 0)
            at += len(token.text if path is None else written(item, path))
        return filename, source_line, best

    def translate_error(self, message: str) -> str:
        """Rewrite a message of the WGSL compiler to speak of the ``.wesl`` source.

        The first line becomes ``file:line:column: sentence``; the excerpts below it keep the generated
        code but show file and line numbers of the source.
        """
        lines = message.strip().splitlines()
        place = self._place(lines)
        if place is None:
            return self._plain(message.strip())
        sentence = next((found.group(1) for found in map(_SENTENCE.search, lines) if found), "")
        reason = [line.strip()[2:] for line in lines if line.strip().startswith("= ")]
        body = self._excerpts(lines)
        if "is invalid" in sentence and reason:
            # The first line only says which function; without an excerpt that is worth keeping.
            sentence = reason[-1] if body else f"{sentence}: {reason[-1]}"
        filename, line, column = place
        return "\n".join([f"{filename}:{line}:{column}: {self._plain(sentence)}", *body])

    def _place(self, lines: list[str]) -> tuple[str, int, int] | None:
        """Return the place a message points at: the carets of its first excerpt, else its header."""
        header = None
        for number, text in enumerate(lines):
            if header is None and (found := _HEADER.match(text)):
                header = int(found["line"]), int(found["column"])
            if (found := _GUTTER.match(text)) and number + 1 < len(lines):
                carets = _CARETS.match(lines[number + 1])
                if carets:
                    # The excerpt begins behind the gutter "NN │ " (and "│ " for a span of many lines).
                    shift = len(found["indent"]) + len(found["line"]) + 3
                    column = carets.start("carets") - shift + 1
                    if "╭" in "".join(lines[:number]):
                        column -= 2
                    return self.position(int(found["line"]), max(column, 1))
        if header is not None:
            return self.position(*header)
        owner = _OWNER.search("\n".join(lines))
        for _, item in self._parts:
            if owner and item.name in owner.groups():
                token = item.declaration.tokens[item.declaration.name_at]
                return item.module.filename, token.line, token.column
        return None

    def _excerpts(self, lines: list[str]) -> list[str]:
        """Return the excerpt part of a message with source places in headers and gutters."""
        start = next((n for n, text in enumerate(lines) if _HEADER.match(text)), len(lines))
        result: list[str] = []
        numbers = [int(found["line"]) for text in lines[start:] if (found := _GUTTER.match(text))]
        width = max((len(str(self.locate(number)[1])) for number in numbers), default=1)
        current = ""
        for text in lines[start:]:
            header, gutter = _HEADER.match(text), _GUTTER.match(text)
            if header:
                current, line, column = self.position(int(header["line"]), int(header["column"]))
                result.append(f"{' ' * width} ┌─ {current}:{line}:{column}")
            elif gutter:
                filename, line = self.locate(int(gutter["line"]))
                if filename != current:
                    current = filename
                    result.append(f"{' ' * width} ├─ {filename}:{line}")
                result.append(f"{line:>{width}}{gutter['rest']}")
            elif text.lstrip().startswith("│"):
                result.append(f"{' ' * width} {text.lstrip()}")
            elif text.strip() and not any(text.strip() in earlier for earlier in result):
                # The compiler says its reasons twice, once as notes and once as a chain of causes.
                result.append(f"{' ' * width} {self._plain(text.strip())}")
        return result

    def _plain(self, text: str) -> str:
        """Replace generated names by those of the source."""

        def original(match: re.Match[str]) -> str:
            path = self.names.get(match.group(), match.group())
            return match.group() if path.endswith("::" + match.group()) else path

        return re.sub(r"[^\W\d]\w*", original, text)
