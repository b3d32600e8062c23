"""The form of an import: what is guessed of columns, channels or arrays, and the layout that the corrected form is."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from acquisition.columns.guesses import Channel
from acquisition.columns.layout import Layout, layout_from
from acquisition.columns.proposal import propose_layout, source_of
from acquisition.columns.reasons import reasons_in
from acquisition.errors import InputError
from acquisition.recorders import ARRAYS, is_recorded

HITS = ("force", "acceleration", "velocity", "displacement")
FRFS = ("accelerance", "mobility", "receptance")
ROLES = {"": "not read", "time": "time", "frequency": "frequency"} | {name: name for name in (*HITS, *FRFS)}
"""What a column can be, with its name in the form."""

FIRST = 3
"""Numbers of a column that the form shows."""

TOP = ("rate", "samples", "decay", "skip", "separator", "decimal")
"""Keys of a layout that the form has once."""

MAT_LISTS = ("axes", "responses", "references")
"""Keys of FRFs in a MATLAB file that are lists; the form has them with commas."""

MAT = ("frfs", "frequency", "axes", "quantity", "unit", "responses", "references")
"""Keys of FRFs in a MATLAB file that the form has."""

UNKNOWN = "not in the file"
"""How a reason of the proposal begins where nothing states a value."""

LABELS = {"reference_node": "hit at"}
"""Keys of a column that the form calls otherwise."""

Form = dict[str, Any]


def proposed_form(paths: Sequence[Path], written: Mapping[str, Any]) -> Form:
    """Return the form with everything that is guessed.

    Parameters
    ----------
    paths : sequence of Path
        The files of the test.
    written : mapping
        ``skip``, ``separator`` and ``decimal`` as they were typed; each may be left out.

    Returns
    -------
    dict
        ``rows``, one for each column of the first file; the keys of :data:`TOP`; ``match`` and ``match_column``, which
        take nodes from file names; ``why``, by key of the top; ``named``, whether columns are called by headings;
        ``arrays``, whether the file has named arrays, of which one may be the rate; ``mat``, of FRFs in a MATLAB file.

    Raises
    ------
    InputError
        If the first file cannot be read.
    """
    stated = {key: _typed(written[key], key) for key in ("skip", "separator", "decimal") if written.get(key)}
    text = layout_from({**stated, "column": [{"quantity": "force", "index": 0}]}, source="this form")
    source = source_of(paths[0], text)
    try:
        proposal = propose_layout(paths, text=text)
    except InputError as error:
        if len(source.channels) < 2 and not is_recorded(paths[0]):
            raise InputError(f"{error}; set another separator or decimal sign") from error
        raise
    table, reasons = tomllib.loads(proposal), reasons_in(proposal)
    rule: dict[str, str] = next(iter(table.get("file", [])), {})
    mat: dict[str, Any] | None = table.get("mat")
    channels = source.channels if mat is None else ()
    return {
        "named": source.named,
        "arrays": paths[0].suffix.lower() in ARRAYS,
        "mat": None if mat is None else {key: _shown(mat.get(key, "")) for key in MAT},
        "rows": [_row(c, table, reasons, named=source.named) for c in channels],
        **{key: str(table.get(key, "")) for key in TOP},
        "match": rule.get("match", ""),
        "match_column": "",
        "why": reasons["", 0]
        | {"match": reasons.get(("file", 0), {}).get("match", "")}
        | reasons.get(("mat", 0), {}),
    }


def _shown(value: Any) -> str:
    return ", ".join(value) if isinstance(value, list) else str(value)


def _row(channel: Channel, table: Mapping[str, Any], reasons: Mapping[Any, Any], *, named: bool) -> Form:
    """Return a column of the form: what the proposal has of a column of the file."""
    key: str | int = channel.name if named else channel.index
    row = {
        "key": key,
        "name": channel.name or f"column {channel.index}",
        "values": [f"{value:.6g}" for value in channel.values[:FIRST]],
        "role": "",
        "unit": "",
        "scale": "",
        "node": "1",
        "direction": "+z",
        "part": "real",
        "reference_node": "1",
        "reference_direction": "+z",
        "why": [],
    }
    for role in ("time", "frequency"):
        if table.get(f"{role}_column") == key:
            return row | {"role": role, "why": [reasons["", 0].get(f"{role}_column", "")]}
    for number, entry in enumerate(table.get("column", [])):
        if entry.get("name", entry.get("index")) == key:
            found = reasons.get(("column", number), {})
            shown = {k: str(v) for k, v in entry.items() if k in row}
            why = [
                f"{LABELS.get(k, k)}: {_plain(text)}"
                for k, text in found.items()
                if k not in ("index", "name")
            ]
            if found.get("node", "").startswith(UNKNOWN):  # a guess would be taken for what the file states
                shown["node"] = ""
            return row | shown | {"role": entry["quantity"], "name": row["name"], "why": why}
    return row


def _plain(reason: str) -> str:
    """Return a reason without what is found in the file of the layout alone."""
    return reason.replace(", see [[file]]", "")


def layout_of(form: Mapping[str, Any]) -> tuple[dict[str, Any], Layout]:
    """Return the layout that a corrected form is, as the tables of its file and as it is read.

    Parameters
    ----------
    form : mapping
        As :func:`proposed_form` returns it.

    Raises
    ------
    InputError
        If something in it cannot be read, or belongs to nothing.
    """
    rows, arrays = list(form["rows"]), bool(form.get("arrays"))
    table: dict[str, Any] = {
        key: _typed(form[key], key, arrays=arrays) for key in TOP if _is_stated(form, key)
    }
    if form.get("mat"):
        table["mat"] = _mat(form["mat"])
        return _placed(table, form)
    for role in ("time", "frequency"):
        keys = [row["key"] for row in rows if row["role"] == role]
        if len(keys) > 1:
            raise InputError(f"columns {keys[0]!r} and {keys[1]!r} are both {role}; choose one")
        if keys:
            table[f"{role}_column"] = keys[0]
    if "rate" in table and "time_column" in table:
        del table["time_column"]  # a rate that is stated replaces the column of times
    of_frfs = "frequency_column" in table
    read = [row for row in rows if row["role"] not in ("", "time", "frequency")]
    _check_roles(read, of_frfs=of_frfs)
    table["column"] = [_entry(row, of_frfs=of_frfs) for row in read]
    return _placed(table, form)


def _mat(typed: Mapping[str, Any]) -> dict[str, Any]:
    """Return the table ``[mat]``; keys left empty are left out."""
    stated = {key: str(typed.get(key, "")).strip() for key in MAT}
    return {
        key: [part.strip() for part in text.split(",") if part.strip()] if key in MAT_LISTS else text
        for key, text in stated.items()
        if text
    }


def _placed(table: dict[str, Any], form: Mapping[str, Any]) -> tuple[dict[str, Any], Layout]:
    """Add where file names state nodes, and read the layout."""
    if pattern := str(form.get("match", "")).strip():
        column = form.get("match_column", "")
        table["file"] = [{"match": pattern, **({} if column == "" else {"column": column})}]
    return table, layout_from(table, source="this form")


def _is_stated(form: Mapping[str, Any], key: str) -> bool:
    usual = {"separator": "auto", "decimal": "auto", "skip": "0"}
    return str(form.get(key, "")).strip() not in ("", usual.get(key, ""))


def _check_roles(rows: Sequence[Mapping[str, Any]], *, of_frfs: bool) -> None:
    """Refuse columns of which a test of this kind has none."""
    known = FRFS if of_frfs else HITS
    for row in rows:
        if row["role"] not in known:
            kind = (
                "FRFs, with a column of frequencies" if of_frfs else "hits, without a column of frequencies"
            )
            raise InputError(f"column {row['key']!r}: {row['role']} does not belong to {kind}")


def _entry(row: Mapping[str, Any], *, of_frfs: bool) -> dict[str, Any]:
    """Return an entry ``[[column]]``."""
    key = row["key"]
    where = f"column {key!r}"
    entry: dict[str, Any] = {"index" if isinstance(key, int) else "name": key, "quantity": row["role"]}
    if unit := str(row["unit"]).strip():
        entry["unit"] = unit
    if scale := str(row["scale"]).strip():
        entry["scale"] = _number(scale, f"{where}: scale")
    entry["node"] = _point(row["node"], f"{where}: node")
    entry["direction"] = str(row["direction"])
    if of_frfs:
        entry["part"] = str(row["part"])
        entry["reference_node"] = _point(row["reference_node"], f"{where}: node hit")
        entry["reference_direction"] = str(row["reference_direction"])
    return entry


def _typed(value: Any, key: str, *, arrays: bool = False) -> Any:
    """Return what was typed for a key of the top as a layout has it; a rate or decay may have its unit.

    Of named arrays, the rate may be one of these.
    """
    text = str(value).strip()
    if key in ("skip", "samples"):
        return _whole(text, key)
    if key in ("rate", "decay"):
        try:
            return _number(text, key)
        except InputError:
            if not text[:1].isdigit() and not (arrays and key == "rate"):
                raise
    return text


def _number(text: str, where: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise InputError(f"{where}: {text!r} is not a number; write it as 0.01") from None


def _point(value: Any, where: str) -> int:
    """Return the number of a point, which no file may state."""
    if not str(value).strip():
        raise InputError(f"{where}: {UNKNOWN}; type the number of the point where it was")
    return _whole(value, where)


def _whole(value: Any, where: str) -> int:
    text = str(value).strip()
    if not text.isdecimal():
        raise InputError(f"{where}: {text!r} is not a whole number")
    return int(text)
