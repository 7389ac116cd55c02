"""Writing declarations under their new names, and remembering where each line came from."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING

from .errors import WeslError
from .lexer import Token
from .syntax import Declaration, Module, Path

if TYPE_CHECKING:
    from .program import Item

OWN: Path = ()  # stands for the declared name itself among the references


class Pieces:
    """A declaration cut at its names, ``texts[0] + name + texts[1] + …``, and the source of each line."""

    __slots__ = ("lines", "paths", "texts")

    def __init__(self, declaration: Declaration):
        self.texts: list[str] = []
        self.paths: list[Path] = []
        self.lines: list[int] = []
        current: list[str] = []
        for token, gap, path in walk(declaration):
            if gap.startswith("\n"):
                self.lines.append(token.line)
            current.append(gap)
            if path is None:
                current.append(token.text)
            else:
                self.texts.append("".join(current))
                self.paths.append(path)
                current = []
        self.texts.append("".join(current))


def walk(declaration: Declaration) -> Iterator[tuple[Token, str, Path | None]]:
    """Yield each token to write with the gap before it and the path it is a reference of, if any."""
    names = {reference.first: (reference.path, reference.last) for reference in declaration.references}
    if declaration.name:
        names[declaration.name_at] = (OWN, declaration.name_at + 1)
    at, line = 0, 0
    while at < len(declaration.tokens):
        token = declaration.tokens[at]
        # By line and not by gap: a token whose predecessors were dropped by an @if still begins its own line.
        if token.line == line:
            gap = " " if token.gap.startswith("\n") else token.gap
        else:
            gap = token.gap if token.gap.startswith("\n") and line else "\n" + "    " * bool(line)
        line = token.line
        path, at = names.get(at, (None, at + 1))
        yield token, gap, path


class Emitter:
    """Collects the output.

    ``places[n]`` is the (filename, line) of output line n + 1; ``parts`` are (first line, item) of every
    declaration.
    """

    def __init__(self) -> None:
        self.texts: list[str] = []
        self.places: list[tuple[str, int]] = []
        self.parts: list[tuple[int, Item]] = []

    def code(self) -> str:
        return "".join(self.texts)[1:] + "\n"

    def directives(self, modules: Iterable[Module]) -> None:
        """Write the directives of all modules at the top, each once; severities must agree."""
        severities: dict[str, tuple[str, Module, Token]] = {}
        written: set[str] = set()
        for module in modules:
            for tokens in module.directives:
                words = [token.text for token in tokens]
                if words[0] == "diagnostic":
                    severity, rule = words[2], "".join(words[4:-2]).rstrip(",")
                    earlier, *_ = severities.setdefault(rule, (severity, module, tokens[0]))
                    if earlier != severity:
                        raise WeslError(
                            f"the diagnostic {rule} is '{severity}' here and '{earlier}' in "
                            f"{severities[rule][1].filename}",
                            module.filename,
                            tokens[0].line,
                            tokens[0].column,
                        )
                    lines = [f"diagnostic({severity}, {rule});"]
                else:
                    lines = [f"{words[0]} {word};" for word in words[1:-1] if word != ","]
                for text in lines:
                    if text not in written:
                        written.add(text)
                        self.texts.append("\n" + text)
                        self.places.append((module.filename, tokens[0].line))

    def item(self, item: Item) -> None:
        declaration, filename = item.declaration, item.module.filename
        pieces = declaration.pieces
        if pieces is None:
            pieces = declaration.pieces = Pieces(declaration)
        self.parts.append((len(self.places) + 1, item))
        texts = self.texts
        for text, path in zip(pieces.texts, pieces.paths, strict=False):
            texts.append(text)
            texts.append(written(item, path))
        texts.append(pieces.texts[-1])
        self.places += [(filename, line) for line in pieces.lines]


def written(item: Item, path: Path) -> str:
    """Return how the output spells a reference of `item`."""
    if path == OWN:
        return item.name
    target = item.targets[path]
    return path[0] if target is None else target.name


def spell(item: Item, first: int, last: int) -> str:
    """Return tokens `first` to `last` of a declaration as the output spells them, on one line."""
    parts: list[str] = []
    at = first
    starts = {reference.first: reference for reference in item.declaration.references}
    while at < last:
        token = item.declaration.tokens[at]
        if parts and token.gap:
            parts.append(" ")
        if at in starts:
            parts.append(written(item, starts[at].path))
            at = starts[at].last
        else:
            parts.append(token.text)
            at += 1
    return "".join(parts)
