"""Whether a document is what its class in `modalkit/output/schemas` declares: no field more, none less."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from types import NoneType, UnionType
from typing import (
    Annotated,
    Any,
    Literal,
    NotRequired,
    Union,
    get_args,
    get_origin,
    get_type_hints,
    is_typeddict,
)


def departures(value: Any, kind: Any, at: str = "") -> list[str]:
    """Return where a value read from JSON is not what is declared."""
    return list(_departures(value, kind, at))


def _departures(value: Any, kind: Any, at: str) -> Iterator[str]:
    origin, parts = get_origin(kind), get_args(kind)
    if origin in (Annotated, NotRequired):
        yield from _departures(value, parts[0], at)
    elif origin in (Union, UnionType):
        found = {part: departures(value, part, at) for part in parts}
        if all(found.values()):
            yield from next(those for part, those in found.items() if part is not NoneType)
    elif is_typeddict(kind):
        yield from _of_object(value, kind, at) if isinstance(value, dict) else (f"{at}: no object",)
    elif origin is Sequence and isinstance(value, list):
        for number, entry in enumerate(value):
            yield from _departures(entry, parts[0], f"{at}[{number}]")
    elif origin is Mapping and isinstance(value, dict):
        for name, entry in value.items():
            yield from _departures(entry, parts[1], f"{at}.{name}")
    elif not _is_plain(value, kind):
        yield f"{at}: {value!r} is no {kind}"


def _of_object(value: dict[str, Any], kind: Any, at: str) -> Iterator[str]:
    hints = get_type_hints(kind, include_extras=True)
    yield from (f"{at}.{name}: is not declared" for name in value.keys() - hints.keys())
    needed = {name for name, hint in hints.items() if get_origin(hint) is not NotRequired}
    yield from (f"{at}.{name}: is not there" for name in needed - value.keys())
    for name in hints.keys() & value.keys():
        yield from _departures(value[name], hints[name], f"{at}.{name}")


def _is_plain(value: Any, kind: Any) -> bool:
    if get_origin(kind) is Literal:
        return value in get_args(kind)
    if kind in (int, float):  # true and false are not numbers in JSON
        return isinstance(value, (int, kind)) and not isinstance(value, bool)
    return kind is Any or (isinstance(kind, type) and isinstance(value, kind))
