"""The JSON schema of a scene file, for editors, and a field's range in words."""

from __future__ import annotations

from typing import Any

from pydantic import TypeAdapter
from pydantic.fields import FieldInfo


def schema() -> dict[str, Any]:
    """JSON schema (2020-12) of a scene file: types, units, ranges, defaults and documentation of every key.

    Editors that speak TOML (Taplo, Even Better TOML, Zed) take it by a first line ``#:schema ./scene.schema.json``
    or a key ``"$schema"``.
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
            "description": "The scene this one builds on: a shipped scene's name, or a .toml in this file's folder.",
        },
    }
    result["properties"] = file_only | result["properties"]
    _say_units(result)
    return result


def _say_units(node: Any) -> None:
    """Put the unit at the end of each description too, since editors show descriptions on hover."""
    if isinstance(node, dict):
        unit, text = node.get("unit"), node.get("description")
        if isinstance(unit, str) and isinstance(text, str) and unit != "1" and not text.endswith("]"):
            node["description"] = f"{text} [{unit}]"
        for value in node.values():
            _say_units(value)
    elif isinstance(node, list):
        for value in node:
            _say_units(value)


def describe_field(info: FieldInfo, element: bool = False) -> str:
    """What a field takes, in words, with range and unit; ``element``: one member of its list."""
    node = TypeAdapter(info.rebuild_annotation()).json_schema(mode="validation")
    for key in ("minimum", "maximum", "exclusiveMinimum", "exclusiveMaximum", "maxLength", "maxItems"):
        for meta in info.metadata:
            name = {
                "minimum": "ge",
                "maximum": "le",
                "maxLength": "max_length",
                "maxItems": "max_length",
            }.get(key)
            if name and hasattr(meta, name) and node.get("type") in ("number", "integer", "string", "array"):
                node.setdefault(key, getattr(meta, name))
    words = _words(node, element)
    extra = info.json_schema_extra
    unit = extra.get("unit") if isinstance(extra, dict) else None
    return f"{words} ({unit})" if unit and unit != "1" else words


def _words(node: dict[str, Any], element: bool = False) -> str:
    if "anyOf" in node:
        parts = [_words(part, element) for part in node["anyOf"] if part.get("type") != "null"]
        if element:
            parts = parts[:1]
        auto = ' or "auto"' if any(part.get("type") == "null" for part in node["anyOf"]) else ""
        return " or ".join(dict.fromkeys(parts)) + auto
    if "const" in node:
        return f'"{node["const"]}"'
    if "enum" in node:
        return "one of " + ", ".join(f'"{value}"' for value in node["enum"])
    kind = node.get("type")
    if kind in ("number", "integer"):
        word = "a number" if kind == "number" else "a whole number"
        low, high = node.get("minimum"), node.get("maximum")
        return word if low is None or high is None else f"{word} from {low:g} to {high:g}"
    if kind == "array":
        inner = node["prefixItems"][0] if "prefixItems" in node else node.get("items", {})
        count = node.get("minItems")
        return f"{'three' if count == 3 else 'a list of'} {_words(inner).removeprefix('a ').replace('number', 'numbers', 1)}"
    if kind == "boolean":
        return "true or false"
    if kind == "string":
        if node.get("format") == "date-time":
            return "a date and time with its zone, such as 2025-10-18T18:20:00-04:00"
        longest = node.get("maxLength")
        return f"a string of at most {longest} characters" if longest else "a string"
    return "a table"
