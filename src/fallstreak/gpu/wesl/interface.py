"""What a linked shader shows to the outside: its bindings and its entry points."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from .constant import evaluate
from .emit import spell
from .lexer import Token

if TYPE_CHECKING:
    from .program import Item, Program


@dataclass(frozen=True, slots=True)
class Binding:
    """One ``@group(…) @binding(…)`` variable.

    Attributes
    ----------
    group, binding : int
    kind : str
        "uniform", "storage", "texture", "depth_texture", "storage_texture", "sampler" or
        "comparison_sampler".
    access : str
        "read", "write" or "read_write".
    type : str
        Its type as the generated WGSL spells it, ``texture_2d<f32>``.
    name : str
        Its name in the generated WGSL.
    """

    group: int
    binding: int
    kind: str
    access: str
    type: str
    name: str


@dataclass(frozen=True, slots=True)
class EntryPoint:
    """An entry point: its stage ("compute", "vertex", "fragment"), its name, and the workgroup size.

    ``workgroup_size`` is None outside of compute shaders and when it depends on an override.
    """

    stage: str
    name: str
    workgroup_size: tuple[int, int, int] | None


def binding_of(item: Item) -> Binding:
    """Describe a global variable with a @binding attribute."""
    declaration = item.declaration
    tokens = declaration.tokens
    at = declaration.name_at + 1
    if tokens[at].text != ":":
        raise item.error(f"'{declaration.name}' needs a type")
    space = _words_before(tokens, declaration.name_at)
    kind, access = _kind(item, at + 1, space)
    group, binding = _number(item, "group"), _number(item, "binding")
    return Binding(group, binding, kind, access, spell(item, at + 1, len(tokens) - 1), item.name)


def _number(item: Item, attribute: str) -> int:
    """Return the value of the @group or @binding of a variable."""
    if attribute not in item.declaration.attributes:
        raise item.error(f"'{item.declaration.name}' has no @{attribute}")
    value = evaluate(item, item.declaration.attributes[attribute])
    if value is None or value < 0:
        raise item.error(f"the @{attribute} of '{item.declaration.name}' must be a whole number")
    return value


def bindings_of(program: Program) -> dict[str, Binding]:
    """Describe all bindings by their own names; no entry point may use one slot twice."""
    bindings: dict[str, Binding] = {}
    slots: dict[tuple[int, int], list[Item]] = {}
    for item in program.items:
        if "binding" in item.declaration.attributes:
            binding = binding_of(item)
            own = item.declaration.name
            bindings[own if own not in bindings else item.name] = binding
            slots.setdefault((binding.group, binding.binding), []).append(item)
    for (group, number), items in slots.items():
        for head in program.heads if len(items) > 1 else ():
            used = [item for item in items if id(item) in _reached(head)]
            if len(used) > 1:
                first, second = sorted(used, key=lambda item: item.declaration.tokens[0].line)[:2]
                raise second.error(
                    f"'{second.declaration.name}' and '{first.declaration.name}' are both at "
                    f"@group({group}) @binding({number}) of the entry point '{head.name}'"
                )
    return bindings


def _reached(head: Item) -> set[int]:
    """Return the identities of all items that `head` needs."""
    seen: set[int] = set()
    todo = [head]
    while todo:
        item = todo.pop()
        if id(item) not in seen:
            seen.add(id(item))
            todo += [target for target in item.targets.values() if target is not None]
    return seen


def entry_of(item: Item) -> EntryPoint:
    """Describe an entry point."""
    arguments = item.declaration.attributes.get("workgroup_size")
    size = None
    if arguments is not None:
        values = [evaluate(item, part) for part in _split(arguments)]
        known = [value for value in values if value is not None]
        if len(known) == len(values) and 1 <= len(values) <= 3:
            x, y, z, *_ = (*known, 1, 1)
            size = (x, y, z)
    return EntryPoint(item.declaration.stage or "", item.name, size)


def _words_before(tokens: list[Token], name_at: int) -> list[str]:
    """Return the template words of ``var<storage, read_write> name``."""
    start = name_at
    while tokens[start].text != "var":
        start -= 1
    return [token.text for token in tokens[start + 1 : name_at] if token.text not in "<>,"]


def _kind(item: Item, at: int, space: list[str]) -> tuple[str, str]:
    if space:
        if space[0] == "uniform":
            return "uniform", "read"
        return "storage", space[1] if len(space) > 1 else "read"
    # An alias hides the type: look through it.
    token = item.declaration.tokens[at]
    target = _target(item, at)
    while target is not None and target.declaration.kind == "alias":
        item, at = target, target.declaration.name_at + 2
        token, target = item.declaration.tokens[at], _target(target, at)
    word = token.text
    if word.startswith("texture_storage_"):
        tokens = item.declaration.tokens
        comma = next(index for index in range(at, len(tokens)) if tokens[index].text == ",")
        return "storage_texture", tokens[comma + 1].text
    if word.startswith("texture_depth_"):
        return "depth_texture", "read"
    if word.startswith("texture_"):
        return "texture", "read"
    if word == "sampler":
        return "sampler", "read"
    if word == "sampler_comparison":
        return "comparison_sampler", "read"
    raise item.error(f"'{item.declaration.name}' has the type {word}, which cannot be bound")


def _target(item: Item, at: int) -> Item | None:
    for reference in item.declaration.references:
        if reference.first == at:
            return item.targets[reference.path]
    return None


def _split(tokens: list[Token]) -> list[list[Token]]:
    """Split arguments at their outer commas."""
    parts: list[list[Token]] = [[]]
    depth = 0
    for token in tokens:
        depth += (token.text in ("(", "[")) - (token.text in (")", "]"))
        if token.text == "," and depth == 0:
            parts.append([])
        else:
            parts[-1].append(token)
    return [part for part in parts if part]
