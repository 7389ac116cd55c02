"""Every key of a scene as tables for people, from the same declarations that validate it."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel
from pydantic.fields import FieldInfo
from pydantic_core import PydanticUndefined

from .describe import describe_field
from .errors import shorten
from .explain import submodel


def reference() -> str:
    """Markdown: a table per section of the scene file with key, what it takes, default and meaning."""
    from .world import World

    return "\n".join(_section("", World)).rstrip("\n") + "\n"


def _section(name: str, model: type[BaseModel]) -> list[str]:
    fields = {k: i for k, i in model.model_fields.items() if not submodel(i.annotation)}
    summary = (model.__doc__ or "").partition("\n\n")[0].replace("``", "`")
    many = " (an array of tables)" if name.endswith("keyframes") else ""
    lines = [f"### {f'`[{name}]`{many}' if name else 'At the top'}", "", " ".join(summary.split()), ""]
    lines += ["| key | takes | default | |", "|---|---|---|---|"]
    lines += [
        f"| `{key}` | {describe_field(info)} | {_default(info)} | {info.description} |"
        for key, info in fields.items()
    ]
    lines.append("")
    for key, info in model.model_fields.items():
        inner = submodel(info.annotation)
        if inner:
            lines += _section(f"{name}.{key}".strip("."), inner)
    return lines


def _default(info: FieldInfo) -> str:
    value: Any = info.default
    if value is PydanticUndefined or (value is None and "auto" not in describe_field(info)):
        return ""
    return f"`{shorten('auto' if value is None else value)}`"
