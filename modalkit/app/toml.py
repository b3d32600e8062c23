"""A study's tables as the text of a TOML file, numbers to the last digit."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from typing import Any

_BARE = re.compile(r"[A-Za-z0-9_-]+")


def toml_text(content: Mapping[str, Any]) -> str:
    """Return tables as TOML that is read back as the same.

    Parameters
    ----------
    content : mapping
        Texts, numbers, lists, and mappings of these; what is None is left out.
    """
    lines: list[str] = []
    _table(content, (), lines)
    return "\n".join(lines).strip() + "\n"


def _table(content: Mapping[str, Any], path: tuple[str, ...], lines: list[str]) -> None:
    """Add a table: its own keys, then its tables, then its lists of tables."""
    for key, value in content.items():
        if value is not None and not _of_tables(value):
            lines.append(f"{_key(key)} = {_value(value)}")
    for key, value in content.items():
        name = ".".join(_key(part) for part in (*path, key))
        if isinstance(value, Mapping):
            lines += ["", f"[{name}]"]
            _table(value, (*path, key), lines)
        elif _of_tables(value):
            for entry in value:
                lines += ["", f"[[{name}]]"]
                _table(entry, (*path, key), lines)


def _of_tables(value: Any) -> bool:
    """Return whether a value has a header of its own."""
    if isinstance(value, Mapping):
        return True
    return isinstance(value, list) and bool(value) and all(isinstance(v, Mapping) for v in value)


def _key(name: str) -> str:
    return name if _BARE.fullmatch(name) else _text(name)


def _text(value: str) -> str:
    """Return a text in quotes; JSON's escapes are those of TOML, but for one character."""
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")


def _value(value: Any) -> str:
    if isinstance(value, str):
        return _text(value)
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(_value(v) for v in value) + "]"
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{_key(k)} = {_value(v)}" for k, v in value.items()) + " }"
    return repr(value)
