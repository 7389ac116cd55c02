"""The order of a frame: from declared reads and writes to a list of passes and lifetimes.

Pure Python, no GPU. The rule is short: all writers of a resource run in (order, insertion) order, then its
readers; `name@previous` is last frame's and orders nothing; a pass whose results nobody reads is dropped.
Vocabulary after Filament's frame graph.
"""

from __future__ import annotations

import heapq
import itertools
from collections import defaultdict
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

from .errors import GraphError


@dataclass(frozen=True)
class Ref:
    """A resource as a pass names it: "sky.aerial", "frame.color@previous", "frame.bloom:mip2"."""

    name: str
    mip: int | None = None
    layer: int | None = None
    previous: bool = False

    @classmethod
    def parse(cls, text: str) -> Ref:
        """Read the text form; raises `GraphError` for a suffix that does not exist."""
        head, *suffixes = text.split(":")
        name, _, version = head.partition("@")
        if version not in ("", "previous"):
            raise GraphError(f"resource {text!r}: only @previous exists, not @{version}")
        found: dict[str, int] = {}
        for suffix in suffixes:
            kind = suffix.rstrip("0123456789")
            if kind not in ("mip", "layer") or kind == suffix:
                raise GraphError(f"resource {text!r}: suffix :{suffix} is not :mipN or :layerN")
            found[kind] = int(suffix[len(kind) :])
        return cls(name, found.get("mip"), found.get("layer"), version == "previous")


@dataclass
class PassDecl:
    """One pass as declared."""

    name: str
    reads: list[Ref]
    writes: list[Ref]
    build: Callable[[Any], Any]
    order: float = 0.0
    when: Callable[[], bool] | None = None
    pipeline: Any = None
    """What its pipeline is made from, if it has one."""
    index: int = 0


@dataclass
class Schedule:
    """What `schedule` finds out."""

    passes: list[PassDecl]
    culled: list[str]
    first: dict[str, int] = field(default_factory=dict)
    """Resource -> position of the first pass that touches it."""
    last: dict[str, int] = field(default_factory=dict)


def _keys(ref: Ref, mips: Callable[[str], int]) -> Iterable[tuple[str, int]]:
    if ref.mip is not None:
        return [(ref.name, ref.mip)]
    return [(ref.name, level) for level in range(mips(ref.name))]


def schedule(passes: Sequence[PassDecl], outputs: Iterable[str], mips: Callable[[str], int]) -> Schedule:
    """Cull, order and find lifetimes.

    Parameters
    ----------
    passes : sequence of PassDecl
        In insertion order.
    outputs : iterable of str
        Resources that somebody outside reads.
    mips : callable
        Number of mip levels of a resource; levels are ordered apart from each other.

    Raises
    ------
    GraphError
        When passes wait for each other in a circle; the message names them.
    """
    for i, p in enumerate(passes):
        p.index = i
    alive = _cull(passes, set(outputs))
    kept = [p for p in passes if p.index in alive]

    writers: dict[tuple[str, int], list[PassDecl]] = defaultdict(list)
    readers: dict[tuple[str, int], list[PassDecl]] = defaultdict(list)
    for p in kept:
        written = {key for ref in p.writes for key in _keys(ref, mips)}
        for key in written:
            writers[key].append(p)
        for ref in p.reads:
            if not ref.previous:
                for key in _keys(ref, mips):
                    if key not in written:
                        readers[key].append(p)

    after: dict[int, set[int]] = {p.index: set() for p in kept}
    waits: dict[int, int] = {p.index: 0 for p in kept}

    def edge(a: PassDecl, b: PassDecl) -> None:
        if b.index not in after[a.index]:
            after[a.index].add(b.index)
            waits[b.index] += 1

    for key, chain in writers.items():
        chain.sort(key=lambda p: (p.order, p.index))
        for a, b in itertools.pairwise(chain):
            edge(a, b)
        for reader in readers.get(key, ()):
            for writer in chain:
                edge(writer, reader)

    by_index = {p.index: p for p in kept}
    ready = [(p.order, p.index) for p in kept if waits[p.index] == 0]
    heapq.heapify(ready)
    ordered: list[PassDecl] = []
    while ready:
        _, index = heapq.heappop(ready)
        ordered.append(by_index[index])
        for following in after[index]:
            waits[following] -= 1
            if waits[following] == 0:
                heapq.heappush(ready, (by_index[following].order, following))
    if len(ordered) != len(kept):
        stuck = [p.name for p in kept if waits[p.index] > 0]
        raise GraphError(f"these passes wait for each other in a circle: {', '.join(stuck)}")

    result = Schedule(ordered, [p.name for p in passes if p.index not in alive])
    for position, p in enumerate(ordered):
        for ref in [*p.reads, *p.writes]:
            result.first.setdefault(ref.name, position)
            result.last[ref.name] = position
    return result


def _cull(passes: Sequence[PassDecl], wanted: set[str]) -> set[int]:
    """Indices of the passes that lead to something wanted; histories keep their writers."""
    alive: set[int] = set()
    grew = True
    while grew:
        grew = False
        for p in passes:
            if p.index not in alive and any(ref.name in wanted for ref in p.writes):
                alive.add(p.index)
                wanted.update(ref.name for ref in p.reads)
                grew = True
    return alive


def makers(
    plan: Schedule, outputs: Iterable[str], mips: Callable[[str], int], lasts: Callable[[str], bool]
) -> dict[int, list[int] | None]:
    """Passes that alone make something that lasts, by position, each with the positions of its readers.

    None stands for readers outside. A pass that shares the making with others is none of these: it would
    write over what the right one of them made.
    """
    writers: dict[tuple[str, int], set[int]] = defaultdict(set)
    readers: dict[tuple[str, int], list[int]] = defaultdict(list)
    for position, p in enumerate(plan.passes):
        for ref in p.writes:
            for key in _keys(ref, mips):
                writers[key].add(position)
        for ref in p.reads:
            for key in _keys(ref, mips):
                readers[key].append(position)
    found: dict[int, list[int] | None] = {}
    for key, positions in writers.items():
        if len(positions) == 1 and lasts(key[0]):
            (maker,) = positions
            known = found.get(maker, [])
            if known is None or key[0] in outputs:
                found[maker] = None
            else:
                found[maker] = known + [r for r in readers[key] if r > maker]
    return dict(sorted(found.items()))


def leading(plan: Schedule, name: str) -> set[int]:
    """Positions of the passes that lead to a resource within one frame."""
    wanted, found = {name}, set()
    for position, p in reversed(list(enumerate(plan.passes))):
        if any(ref.name in wanted for ref in p.writes):
            found.add(position)
            wanted.update(ref.name for ref in p.reads if not ref.previous)
    return found


def alias(lifetimes: dict[str, tuple[int, int]], kind: Callable[[str], object]) -> dict[str, int]:
    """Assign transient resources to as few physical ones as their lifetimes allow.

    Parameters
    ----------
    lifetimes : dict
        Name -> (first, last) pass position, both inclusive.
    kind : callable
        Two resources may share memory only if `kind` of both is equal.

    Returns
    -------
    dict
        Name -> number of the physical resource.
    """
    slots: list[tuple[object, int]] = []  # kind, last use
    assigned: dict[str, int] = {}
    for name, (first, last) in sorted(lifetimes.items(), key=lambda item: (item[1], item[0])):
        what = kind(name)
        for i, (other, busy_until) in enumerate(slots):
            if other == what and busy_until < first:
                slots[i] = (what, last)
                assigned[name] = i
                break
        else:
            assigned[name] = len(slots)
            slots.append((what, last))
    return assigned
