"""How results display themselves: a few lines in a terminal, a table in a notebook."""

from __future__ import annotations

import importlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields
from html import escape
from itertools import pairwise
from numbers import Number
from typing import TYPE_CHECKING, Any

from acquisition.errors import InputError
from acquisition.quantities import decimals
from acquisition.warned import in_order

if TYPE_CHECKING:
    import pandas as pd

LINES, ROWS = 12, 60
"""Rows of a result's table in a terminal and in a notebook; longer ones are cut in the middle."""

WIDTH = 60
"""Characters of a text among other values; longer ones are cut at the end."""

ITEMS = 4
"""So many plain values are listed; of more, only their number is given."""

LONGEST = 400
"""Characters of the line that describes a result."""

_FACE: list[str] = []  # the modules that draw and that answer, none before modalkit is imported


class Displayed:
    """A dataclass that displays itself by what it holds, not by every number in it.

    A subclass describes itself in `_headline` in one line; its ``table()``, where it has one, is shown below. What has
    no headline of its own is described field by field: arrays by their shape, tables and sequences by their length.
    """

    def __init_subclass__(cls, **more: Any) -> None:
        """Give the class its repr before ``@dataclass`` does, which leaves alone what is there."""
        super().__init_subclass__(**more)
        if "__repr__" not in cls.__dict__:
            cls.__repr__ = cls.__repr__  # type: ignore[method-assign]

    def _headline(self) -> str:
        """Return what this is, in one line."""
        return described(self)

    def _frame(self) -> pd.DataFrame | None:
        """Return the table to show, None for none."""
        table = getattr(self, "table", None)
        return table() if callable(table) else table

    def _answer(self) -> Mapping[str, str]:
        """Return what this answers, question by question; nothing for what is no answer."""
        return {}

    def __repr__(self) -> str:
        """Return one line, how many warnings there are with the first of them, and the answer or the table below."""
        line, rows = f"{type(self).__name__}: {_cut(self._headline(), LONGEST)}", self._frame()
        line += _warned(getattr(self, "warnings", ()))
        if answer := self._answer():
            return "\n".join([line, *(f"{f'{name}:':<9}{text}" for name, text in answer.items())])
        if rows is None or not len(rows):
            return line
        own = formats(rows)
        return f"{line}\n{rows.to_string(max_rows=LINES, max_colwidth=WIDTH, float_format=_number, formatters=own)}"

    def _repr_html_(self) -> str:
        """Return what a notebook shows: the line, the answer, the table, and the warnings."""
        line = f"<p><b>{type(self).__name__}</b>: {escape(_cut(self._headline(), LONGEST))}</p>"
        rows = self._frame()
        table = "" if rows is None or not len(rows) else _html(rows)
        lines = "".join(f"<dt><b>{escape(k)}</b></dt><dd>{escape(v)}</dd>" for k, v in self._answer().items())
        answer = f"<dl>{lines}</dl>" if lines else ""
        return f"<div>{line}{answer}{table}{_warnings(getattr(self, 'warnings', ()))}</div>"


class Shown(Displayed):
    """A result that the face draws as a page of its own, in a notebook for instance."""

    def show(self, *sessions: Any) -> Any:
        """Return its drawings with the numbers on them; a notebook shows them.

        Parameters
        ----------
        *sessions : Session
            The studies it rests on, where it rests on some: with them the page has structure, FRFs and shapes.

        Raises
        ------
        InputError
            If ``modalkit``, which draws, was not imported.
        """
        return _face().show(self, *sessions)


class Animated(Displayed):
    """Modes that the face sets in motion."""

    def animate(self, session: Any = None) -> Any:
        """Return the shapes in motion; a notebook shows them.

        Parameters
        ----------
        session : Session, optional
            The study, whose model is drawn beside them.

        Raises
        ------
        InputError
            If there are no shapes, or ``modalkit``, which draws, was not imported.
        """
        return _face().animate(self, session)


def draw_by(module: str, answers: str) -> None:
    """Name the modules that draw results and that put them in words; each is loaded once it is needed."""
    _FACE[:] = [module, answers]


def _face() -> Any:
    if not _FACE:
        raise InputError("results are drawn by modalkit; import modalkit first")
    return importlib.import_module(_FACE[0])


def answers_of(result: Any) -> Mapping[str, str]:
    """Return what a result answers, as the face words it; nothing before it is there."""
    found: Mapping[str, str] = importlib.import_module(_FACE[1]).answers(result) if _FACE else {}
    return found


def described(result: Any) -> str:
    """Return the fields of a dataclass in one line, long ones by their size; what is empty is left out.

    Parameters
    ----------
    result : dataclass
        Any, frozen or not.
    """
    values = {f.name: getattr(result, f.name) for f in fields(result)}
    return ", ".join(f"{name}: {_brief(v)}" for name, v in values.items() if v is not None and not _empty(v))


def counted(count: int, noun: str) -> str:
    """Return a count with its noun, in the plural where it is one: ``3 modes``."""
    return f"{count} {noun}" + ("" if count == 1 else "s")


def with_reasons(reasons: Mapping[str, object]) -> str:
    """Return names with their reasons, those of one reason together: ``E, density (no shapes)``."""
    return "; ".join(f"{', '.join(names)} ({why})" for why, names in grouped(reasons).items())


def grouped(texts: Mapping[str, object]) -> dict[str, list[str]]:
    """Return the names of each text, in the order in which the texts come first."""
    names: dict[str, list[str]] = {}
    for name, text in texts.items():
        names.setdefault(str(text), []).append(name)
    return names


def named_files(paths: Sequence[object]) -> str:
    """Return the names of files for a line: all of a few, of many how many and the first and last."""
    names = [str(path) for path in paths]
    if len(names) <= ITEMS:
        return ", ".join(names)
    return f"{len(names)} files, {names[0]} to {names[-1]}"


def _empty(value: Any) -> bool:
    return isinstance(value, str | tuple | list | Mapping) and not value


def _brief(value: Any) -> str:
    if hasattr(value, "dtype") and hasattr(value, "shape") and value.shape:
        return f"array {'x'.join(str(n) for n in value.shape)}"
    if hasattr(value, "columns") and hasattr(value, "index"):
        return f"table of {counted(len(value), 'row')}"
    if isinstance(value, bool | complex) or not isinstance(value, Number | Mapping | tuple | list):
        return type(value).__name__ if hasattr(value, "__dataclass_fields__") else _cut(str(value), WIDTH)
    if isinstance(value, Number):
        return f"{value:.6g}" if isinstance(value, float) else str(value)
    kinds = {type(v).__name__ for v in value}
    if not isinstance(value, Mapping) and len(value) <= ITEMS and kinds <= {"int", "float", "str"}:
        return f"({', '.join(_brief(v) for v in value)})"
    return f"{len(value)} {kinds.pop() if len(kinds) == 1 else 'entries'}"


def _cut(text: str, length: int) -> str:
    line = " ".join(text.split())
    return line if len(line) <= length else line[: length - 3] + "..."


def _html(rows: pd.DataFrame) -> str:
    """Return a table for a notebook; row numbers without a name are not a column of it."""
    name = rows.index.name
    index = name is not None or rows.index.dtype.kind not in "iu"
    shown = rows.set_axis(rows.index.rename(None), axis=0)
    shown.columns = shown.columns.rename(name)  # beside the headings, not in a row of its own
    options: dict[str, Any] = {"float_format": _number, "formatters": formats(shown)}
    table: str = shown.to_html(max_rows=ROWS, border=0, justify="left", index=index, **options)
    return table.replace("<table ", '<table cellpadding="4" ', 1)


def _number(value: float) -> str:
    return f"{value:.6g}"


def formats(rows: pd.DataFrame) -> dict[str, Callable[[float], str]]:
    """Return how the columns of a table are written that have a standard deviation beside them, and these.

    Such a column is followed by one whose name begins with ``sigma``, in the same unit. All its values have as many
    decimals as the best known of them.
    """
    found: dict[str, Callable[[float], str]] = {}
    names = [str(name) for name in rows.columns]
    for value, sigma in pairwise(names):
        if not sigma.startswith("sigma") or value.rpartition("[")[2] != sigma.rpartition("[")[2]:
            continue
        known = [d for s in rows[sigma] if (d := decimals(float(s))) is not None]
        if known:
            found[value] = f"{{:.{max(known)}f}}".format
            found[sigma] = _short
    return found


def _short(value: float) -> str:
    """Return a standard deviation with two digits."""
    return f"{value:.2g}"


def _warned(warnings: Sequence[str]) -> str:
    """Return a line with the number of warnings and the first of those that matter most; empty where there is none."""
    if not isinstance(warnings, tuple | list) or not warnings:
        return ""
    first = _cut(str(in_order(warnings)[0]), LONGEST)
    return (
        f"\n{counted(len(dict.fromkeys(warnings)), 'warning')}{', the first' * (len(warnings) > 1)}: {first}"
    )


def _warnings(warnings: tuple[str, ...]) -> str:
    if not warnings:
        return ""
    items = "".join(f"<li>{escape(str(w))}</li>" for w in in_order(warnings))
    return f"<details><summary>{counted(len(warnings), 'warning')}</summary><ul>{items}</ul></details>"
