"""Errors that a person caused and can mend: each says in one sentence where, what, and what is right."""

from __future__ import annotations


class UserError(Exception):
    """Something outside the program is wrong; ``str(error)`` is one sentence, shown without a traceback."""


class WorldError(UserError):
    """A scene, or an override of one, is not valid: the message holds file, key, value and the allowed."""


def shorten(value: object, limit: int = 48) -> str:
    """A value as TOML would show it, cut in the middle so that a hostile one cannot fill the screen."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, dict):
        return "a table"
    if isinstance(value, int) and value.bit_length() > 200:
        return f"an integer of {value.bit_length():,} bits"
    if isinstance(value, str):
        text = '"' + "".join(c if c.isprintable() else "·" for c in value[: limit + 1]) + '"'
        length = len(value) + 2
    elif isinstance(value, (list, tuple)):
        text = (
            "[" + ", ".join(shorten(item, 12) for item in value[:4]) + (", …" if len(value) > 4 else "") + "]"
        )
        length = len(text)
    else:
        text = value.isoformat() if hasattr(value, "isoformat") else repr(value)  # type: ignore[attr-defined]
        length = len(text)
    return text if length <= limit else f"{text[: limit - 1]}… ({length:,} characters)"
