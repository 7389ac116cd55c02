"""From pydantic's errors to one sentence: file, line, key, value, and what is allowed."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from datetime import datetime
from difflib import get_close_matches
from typing import Any

from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo

from .errors import WorldError, shorten
from .trees import Tree, at, holds

Key = tuple[str | int, ...]


@dataclass(frozen=True)
class Layer:
    """One source of values: a scene file (with its text, for line numbers) or an override."""

    label: str
    tree: Tree
    text: str = field(default="", repr=False)


def explain(
    error: ValidationError, model: type[BaseModel], tree: Tree, layers: list[Layer] | None
) -> WorldError:
    """The first of the errors as a sentence; how many others there are is said at its end.

    ``tree`` is what was validated, ``layers`` where it came from.
    """
    errors = error.errors(include_url=False)
    first = errors[0]
    path, value = first["loc"], first["input"]
    if path and isinstance(path[-1], int) and not holds(tree, path):
        # Of three numbers too few were given, or one for all: speak of the whole field, and once.
        path = path[:-1]
        value = at(tree, path)
        errors = [first] + [e for e in errors if e["loc"][: len(path)] != path]
    key = dotted(path)
    info = field_at(model, path)
    kind = first["type"]
    if kind == "extra_forbidden":
        problem = f"{key} is not known{suggestion(model, path)}"
    elif kind == "missing" and not holds(tree, path):
        problem = f"{key} is missing: it must be {allowed(info, model, path)}"
    elif kind == "value_error":
        reason = str(first.get("ctx", {}).get("error", first["msg"]))
        told = key if isinstance(value, (dict, BaseModel)) else f"{key} = {shorten(value)} is not allowed"
        problem = f"{told}: {reason}"
    elif kind == "timezone_aware":
        text = value.isoformat() if isinstance(value, datetime) else str(value)[:32]
        problem = f"{key} = {shorten(value)} has no zone: add one, such as {text}Z or {text}-04:00"
    else:
        problem = f"{key} = {shorten(value)} is not allowed: it must be {allowed(info, model, path)}"
    more = f" (and {len(errors) - 1} more)" if len(errors) > 1 else ""
    return WorldError(f"{origin(path, layers)}{problem}{more}")


def dotted(path: Key) -> str:
    """("camera", "keyframes", 2, "fov") as camera.keyframes[2].fov."""
    text = ""
    for part in path:
        if isinstance(part, int):
            text += f"[{part}]"
        else:
            name = part if re.fullmatch(r"[A-Za-z0-9_-]{1,60}", part) else shorten(part)
            text += ("." if text else "") + name
    return text or "the scene"


def origin(path: Key, layers: list[Layer] | None) -> str:
    """Which file and line, or which override, gave the value: "scene.toml, line 4: "."""
    for end in range(len(path), 0, -1):
        for layer in reversed(layers or []):
            if holds(layer.tree, path[:end]):
                line = find_line(layer.text, path[:end]) if layer.text else None
                return f"{layer.label}, line {line}: " if line else f"{layer.label}: "
    return f"{layers[-1].label}: " if layers else ""


def find_line(text: str, path: Key) -> int | None:
    """The line of a TOML text where a key is set, or the nearest table around it; None when neither is plain.

    A search by table header and name, without regular expressions, which a hostile line could stall.
    """
    names = [part for part in path if isinstance(part, str)]
    # By the number of names before it: the wanted element of an array of tables, and the one we are in.
    wanted = {sum(isinstance(p, str) for p in path[:i]): p for i, p in enumerate(path) if isinstance(p, int)}
    inside = dict.fromkeys(wanted, -1)
    header: list[str] = []
    nearest: int | None = None
    for number, line in enumerate(text.splitlines(), start=1):
        line = line.strip()
        if line.startswith("[") and "]" in line and "=" not in line:
            header = _parts(line.lstrip("[").partition("]")[0])
            if line.startswith("[[") and header == names[: len(header)] and len(header) in inside:
                inside[len(header)] += 1
                inside.update((depth, -1) for depth in inside if depth > len(header))
            full = header
        else:
            full = header + _parts(line.partition("=")[0]) if "=" in line else []
        if not full or any(inside[depth] not in (-1, place) for depth, place in wanted.items()):
            continue
        if full == names:
            return number
        if full == names[: len(full)]:
            nearest = number
    return nearest


def _parts(key: str) -> list[str]:
    return [part.strip(" \t\"'") for part in key.split(".")]


def submodel(annotation: Any) -> type[BaseModel] | None:
    """The model a field holds: itself, or the element of its tuple."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    for part in getattr(annotation, "__args__", ()):
        found = submodel(part)
        if found:
            return found
    return None


def model_at(model: type[BaseModel], path: Key) -> type[BaseModel] | None:
    """The model of the table at a path."""
    found: type[BaseModel] | None = model
    for part in path:
        if isinstance(part, int):
            continue
        info = found.model_fields.get(part) if found else None
        found = submodel(info.annotation) if info else None
    return found


def field_at(model: type[BaseModel], path: Key) -> FieldInfo | None:
    """The declaration of the field at a path."""
    names = tuple(part for part in path if isinstance(part, str))
    parent = model_at(model, names[:-1]) if names else None
    return parent.model_fields.get(names[-1]) if parent else None


def allowed(info: FieldInfo | None, model: type[BaseModel], path: Key) -> str:
    """What a field takes, in words: "a number from 0 to 100 deg"."""
    from .describe import describe_field

    if path and info and isinstance(path[-1], str) and submodel(info.annotation):
        many = "tuple" in str(info.annotation)
        return "an array of tables" if many else "a table"
    if info is None:
        return "a table of sections such as [sky] and [camera]"
    return describe_field(info, element=isinstance(path[-1], int))


def leaves(model: type[BaseModel], prefix: str = "") -> dict[str, str]:
    """Every dotted key of a model with its last part."""
    found: dict[str, str] = {}
    for name, info in model.model_fields.items():
        found[prefix + name] = name
        inner = submodel(info.annotation)
        if inner:
            found.update(leaves(inner, f"{prefix}{name}."))
    return found


def suggestion(model: type[BaseModel], path: Key) -> str:
    """ "; did you mean …?" or the keys there are."""
    name = str(path[-1])[:80]
    parent = model_at(model, path[:-1])
    siblings = list(parent.model_fields) if parent else []
    close = get_close_matches(name, siblings, n=1, cutoff=0.6)
    if close:
        return f"; did you mean {dotted((*path[:-1], close[0]))}?"
    elsewhere = leaves(model)
    exact = [key for key, last in elsewhere.items() if last == name]
    near = exact or get_close_matches(dotted(path)[:80], elsewhere, n=1, cutoff=0.75)
    if near:
        return f"; did you mean {near[0]}?"
    where = dotted(path[:-1]) if len(path) > 1 else "a scene"
    return f"; {where} has {', '.join(siblings)}"
