"""The fields of the JSON documents, from the classes in `modalkit/output/schemas` that declare them."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from types import NoneType, UnionType
from typing import Any, Literal, NotRequired, Union, get_args, get_origin, get_type_hints, is_typeddict

WORDS = {
    float: ("number", "numbers"),
    int: ("whole number", "whole numbers"),
    str: ("text", "texts"),
    bool: ("true or false", "true or false"),
    NoneType: ("null", "nulls"),
    Any: ("anything", "anything"),
}


@dataclass(frozen=True)
class Field:
    """A field of a document.

    Parameters
    ----------
    path : str
        Where it stands: ``modes[].shape[].re``; ``*`` for any key.
    kind : type
        Its annotation.
    sentence, unit : str
        What it means, and the unit of its numbers; empty for none.
    """

    path: str
    kind: Any
    sentence: str
    unit: str


def document_name(document: type) -> str:
    """Return the schema of a document: ``modalkit.modes/1``."""
    return str(get_args(get_type_hints(document)["schema"])[0])


def fields(document: type) -> Iterator[Field]:
    """Yield the fields of a document, those of an object after it; of a second one like it, where the first stands."""
    yield from _fields(document, "", {})


def _fields(entry: type, at: str, seen: dict[type, str]) -> Iterator[Field]:
    for name, hint in get_type_hints(entry, include_extras=True).items():
        kind, text, *_ = get_args(get_args(hint)[0] if get_origin(hint) is NotRequired else hint)
        found = re.fullmatch(r"(.*?)(?: \[([^\]]+)\])?", text)
        assert found is not None
        path, inner = f"{at}{name}", list(_objects(kind, f"{at}{name}"))
        known = [seen[one] for one, _ in inner if one in seen]
        yield Field(path, kind, found[1] + "".join(f"; as `{other}`" for other in known), found[2] or "")
        for one, place in inner:
            if one not in seen:
                seen[one] = place
                yield from _fields(one, f"{place}.", seen)


def _objects(kind: Any, path: str) -> Iterator[tuple[type, str]]:
    """Yield the objects inside an annotation, with their paths."""
    if is_typeddict(kind):
        yield kind, path
    elif get_origin(kind) is Sequence:
        yield from _objects(get_args(kind)[0], f"{path}[]")
    elif get_origin(kind) is Mapping:
        yield from _objects(get_args(kind)[1], f"{path}.*")
    elif get_origin(kind) in (Union, UnionType):
        for part in get_args(kind):
            yield from _objects(part, path)


def in_words(kind: Any, *, many: bool = False) -> str:
    """Return an annotation in words: ``list of numbers or null``."""
    if get_origin(kind) is Literal:
        return ", ".join(f'`"{word}"`' for word in get_args(kind))
    if get_origin(kind) in (Union, UnionType):
        return " or ".join(in_words(part, many=many and part is not NoneType) for part in get_args(kind))
    if get_origin(kind) is Sequence:
        return f"list{'s' * many} of {in_words(get_args(kind)[0], many=True)}"
    if get_origin(kind) is Mapping:
        return f"object{'s' * many} of {in_words(get_args(kind)[1], many=True)}"
    if is_typeddict(kind):
        return "objects" if many else "object"
    return WORDS[kind][many]


def holds_numbers(kind: Any) -> bool:
    """Say whether an annotation has numbers in it, outside the objects."""
    return kind in (int, float) or (not is_typeddict(kind) and any(holds_numbers(p) for p in get_args(kind)))


def may_be_null(kind: Any) -> bool:
    """Say whether an annotation has null in it, outside the objects."""
    return kind is NoneType or (not is_typeddict(kind) and any(may_be_null(p) for p in get_args(kind)))
