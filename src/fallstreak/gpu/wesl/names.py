"""What declarations are called in the output."""

from __future__ import annotations

from .program import Item, Program
from .words import PREDECLARED


def assign_names(program: Program) -> None:
    """Give every item its name in the output.

    Entry points, overrides and the entry module keep theirs, others carry their module in front. A name
    is refused when it is taken, when WGSL has it already, or when a function that refers to the item by
    another name has a local of that name, which would capture the reference.
    """
    captured = _captured(program)
    taken: dict[str, Item] = {}
    items = [item for item in program.items if item.declaration.name]
    visible = program.heads + [item for item in items if item.declaration.kind == "override"]
    for item in visible:
        item.name = item.declaration.name
        if taken.setdefault(item.name, item) is not item or item.name in captured.get(id(item), ()):
            raise item.error(
                f"the name '{item.name}' is visible from outside and cannot be given up, but something "
                "else in this shader needs it"
            )
    # The entry module first, so that its names stay as they are whatever the libraries are called.
    for item in sorted(items, key=lambda item: item.module is not program.root):
        if item.name:
            continue
        own = item.declaration.name
        if item.module is program.root or item.module.path == ("structs",):
            wish = own
        else:
            wish = "_".join((*(part for part in item.module.path if part != "package"), own))
        refused = captured.get(id(item), ())
        name, count = wish, 1
        while name in taken or name in PREDECLARED or name in refused:
            count += 1
            name = f"{wish}_{count}"
        item.name = name
        taken[name] = item


def _captured(program: Program) -> dict[int, set[str]]:
    """Return, per item, the local names of functions that refer to it under another name."""
    captured: dict[int, set[str]] = {}
    for item in program.items:
        names = item.declaration.locals
        if names:
            for path, target in item.targets.items():
                if target is not None:
                    # Where the source itself writes this very name, its scopes already tell them apart.
                    hidden = names - {path[0]} if len(path) == 1 else names
                    captured.setdefault(id(target), set()).update(hidden)
    return captured
