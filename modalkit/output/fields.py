"""Documents from results: a field is the attribute of its name, or the one that its annotation states.

A class of :mod:`modalkit.output.schemas` states for each field its type, its meaning, and with :class:`Of` where it
is taken from if the result calls it otherwise. Nothing is renamed anywhere else. Models of pydantic could do the same;
to define 45 of them takes 18 times as long as 45 typed dictionaries, in every command that writes a file.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from types import NoneType, UnionType
from typing import Any, TypeVar, Union, cast, get_args, get_origin, get_type_hints, is_typeddict

import pandas as pd

from modalkit.output.whole import plain

D = TypeVar("D")


@dataclass(frozen=True)
class Of:
    """What a field is taken from where the result does not call it by its name.

    Parameters
    ----------
    source : str
        Attribute of the result, or key or column of a row; empty for the whole result.
    """

    source: str


def fill(document: type[D], result: Any, **given: Any) -> D:
    """Return a result as an object of a document.

    Parameters
    ----------
    document : type
        A class of :mod:`modalkit.output.schemas`.
    result : object
        A record, or a row as a mapping.
    **given
        Fields that are no attribute of the result, as they are to stand there.

    Returns
    -------
    dict
        In the order in which the fields are declared; what is not a number is None.

    Raises
    ------
    TypeError
        If the document has no field of that name.
    AttributeError
        If the result has no such attribute.
    """
    fields = _fields(cast(Any, document))
    if unknown := given.keys() - {name for name, _, _ in fields}:
        raise TypeError(f"{document.__name__} has no field {', '.join(sorted(unknown))}")
    filled = {
        name: given[name] if name in given else convert(_taken(result, source))
        for name, source, convert in fields
    }
    return cast(D, filled)


def _taken(result: Any, source: str) -> Any:
    if not source:
        return result
    return result[source] if isinstance(result, Mapping) else getattr(result, source)


@cache
def _fields(document: Any) -> tuple[tuple[str, str, Callable[[Any], Any]], ...]:
    """Return name, source and conversion of every field."""
    found: list[tuple[str, str, Callable[[Any], Any]]] = []
    for name, hint in get_type_hints(document, include_extras=True).items():
        kind, _, *sources = get_args(hint)
        source = "" if name == "schema" else sources[0].source if sources else name
        found.append((name, source, _constant(kind) if name == "schema" else _conversion(kind)))
    return tuple(found)


def _constant(kind: Any) -> Callable[[Any], Any]:
    (value,) = get_args(kind)
    return lambda _: value


def _conversion(kind: Any) -> Callable[[Any], Any]:
    """Return what takes a value of a result to JSON as it is declared."""
    origin, parts = get_origin(kind), get_args(kind)
    if is_typeddict(kind):
        return lambda value: fill(kind, value)
    if origin in (Union, UnionType):
        inner = [_conversion(part) for part in parts if part is not NoneType]
        one = inner[0] if len(inner) == 1 else plain
        return lambda value: None if value is None else one(value)
    if origin is Sequence:
        of_each = _conversion(parts[0])
        return lambda values: [of_each(value) for value in _rows(values)]
    if origin is Mapping:
        of_value = _conversion(parts[1])
        return lambda values: {str(name): of_value(value) for name, value in values.items()}
    return str if kind is str else plain


def _rows(values: Any) -> Any:
    return values.to_dict("records") if isinstance(values, pd.DataFrame) else values
