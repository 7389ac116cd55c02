"""The JSON schema of a scene file, for editors, and a field's range in words."""

from __future__ import annotations

from typing import Any

from pydantic import TypeAdapter
from pydantic.fields import FieldInfo


def schema() -> dict[str, Any]:
    """JSON schema (2020-12) of a scene file: types, units, ranges, defaults and documentation of every key.

    Editors that speak TOML (Taplo, Even Better TOML, Zed) take it by a first line
    ``#:schema ./scene.schema.json`` or a key ``"$schema"``.
    """
    from .world import World

    result = World.model_json_schema(mode="validation")
    result["$schema"] = "https://json-schema.org/draft/2020-12/schema"
    result["title"] = "Fallstreak scene"
    file_only = {
        "$schema": {
            "type": "string",
            "description": "Where an editor finds this schema; not part of the world.",
        },
        "extends": {
            "type": "string",
            "description": "The scene this one builds on: a shipped scene's name, or a .toml in its folder.",
        },
    }
    result["properties"] = file_only | result["properties"]
    for model in [result, *result["$defs"].values()]:
        for node in model["properties"].values():
            _for_editors(node)
    return result


def _for_editors(node: dict[str, Any]) -> None:
    """One property: TOML has no null, and editors show descriptions on hover but not units."""
    node.pop("title", None)
    if "default" in node and node["default"] is None:
        del node["default"]
    kinds = [kind for kind in node.get("anyOf", []) if kind.get("type") != "null"]
    if len(kinds) == 1:
        del node["anyOf"]
        node.update(kinds[0])
    if {"const": "auto", "type": "string"} in kinds:
        node["default"] = "auto"
    if node.get("unit", "1") != "1":
        node["description"] += f" [{node['unit']}]"


def describe_field(info: FieldInfo, element: bool = False) -> str:
    """What a field takes, in words, with range and unit; ``element``: one member of its list."""
    node = TypeAdapter(info.rebuild_annotation()).json_schema(mode="validation")
    words = _words(node, element)
    extra = info.json_schema_extra
    unit = extra.get("unit") if isinstance(extra, dict) else None
    return f"{words} ({unit})" if unit and unit != "1" else words


def _words(node: dict[str, Any], element: bool = False) -> str:
    if "anyOf" in node:
        kinds = [part for part in node["anyOf"] if part.get("type") != "null"]
        parts = [_words(part, element and part.get("type") == "array") for part in kinds]
        return " or ".join(dict.fromkeys(parts[:1] if element else parts))
    if "const" in node:
        return f'"{node["const"]}"'
    if "enum" in node:
        return "one of " + ", ".join(f'"{value}"' for value in node["enum"])
    kind = node.get("type")
    if kind in ("number", "integer"):
        word = "a number" if kind == "number" else "a whole number"
        low, high = node.get("minimum"), node.get("maximum")
        return word if low is None or high is None else f"{word} from {_figure(low)} to {_figure(high)}"
    if "$ref" in node or kind == "object":
        return "a table"
    if kind == "array":
        rows = node.get("prefixItems", [])
        first = rows[0] if rows else node["items"]
        if element:
            return _words(first)
        if not rows:
            return "a list of strings" if first.get("type") == "string" else "a list"
        many = _COUNTS.get(len(rows), str(len(rows)))
        if first.get("type") == "array":
            return f"{many} rows of {_words(first)}"
        return f"{many} {_words(first).removeprefix('a ').replace('number', 'numbers', 1)}"
    if kind == "boolean":
        return "true or false"
    if node.get("format") == "date-time":
        return "a date and time with its zone, such as 2025-10-18T18:28:00-04:00"
    longest = node.get("maxLength")
    return f"a string of at most {longest} characters" if longest else "a string"


_COUNTS = {2: "two", 3: "three", 4: "four", 5: "five"}


def _figure(value: float) -> str:
    return str(int(value)) if value == int(value) and abs(value) < 1e10 else f"{value:g}"
