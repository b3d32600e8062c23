"""The layout file: which column of a text file is what, in which unit and at which point."""

from __future__ import annotations

import difflib
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any

import numpy as np

from acquisition.columns.mat_layout import MatLayout, check_axis, mat_layout
from acquisition.columns.rules import FileRule, check_rule
from acquisition.columns.units import QUANTITIES
from acquisition.dof import Dof
from acquisition.encoding import not_utf8
from acquisition.errors import InputError
from acquisition.geometry import Geometry
from acquisition.si_units import si_value

DIRECTIONS = {"x": 1, "y": 2, "z": 3, "rx": 4, "ry": 5, "rz": 6}
UNITS = {"rate": "Hz", "decay": "1/s"}
"""Numbers of a layout that may be written with a unit, and what they are in without one."""

PARTS = ("real", "imag", "magnitude", "phase")


@dataclass(frozen=True)
class Column:
    """What one column holds.

    Parameters
    ----------
    quantity : str
        "force", "acceleration", "velocity" or "displacement"; of FRFs "accelerance", "mobility" or
        "receptance".
    node : int
        Node at which the transducer sits, or the hammer hits.
    direction : str
        "+x", "-z", ...: which way the transducer points.
    index : int or None
        Number of the column, from 0.
    name : str or None
        Heading of the column; instead of ``index``.
    unit : str
        Unit of the numbers; "" for SI, or for what a LabVIEW header states.
    scale : float or None
        Factor by which the numbers are multiplied first [-]; None is 1, where the file states units.
    part : str
        Of FRFs: "real", "imag", "magnitude" or "phase" (in degrees).
    reference_node : int
        Of FRFs: where the force acted.
    reference_direction : str
        Of FRFs: which way the force acted.
    """

    quantity: str
    node: int = 1
    direction: str = "+z"
    index: int | None = None
    name: str | None = None
    unit: str = ""
    scale: float | None = None
    part: str = "real"
    reference_node: int = 1
    reference_direction: str = "+z"

    @property
    def label(self) -> str:
        """Return how messages call the column."""
        return f"column {self.index}" if self.name is None else f"column {self.name!r}"

    @property
    def dof(self) -> Dof:
        """Degree of freedom of the transducer."""
        return dof_of(self.node, self.direction)

    @property
    def reference(self) -> Dof:
        """Degree of freedom of the force of an FRF."""
        return dof_of(self.reference_node, self.reference_direction)


FASTEST = 1e6
"""The fastest decay that can be meant: a record windowed so is over after ten microseconds. Doubling it would take a
few more misprints for windows [1/s]."""


@dataclass(frozen=True)
class Layout:
    """How to read column text.

    Parameters
    ----------
    columns : tuple of Column
        What is in the columns.
    files : tuple of FileRule
        Points that differ from file to file.
    rate : float, str or None
        Sampling rate, or which array of a file of named arrays it is; None to take it from a time column or from the
        file [Hz].
    time_column, frequency_column : int, str or None
        Number or heading of the column of times [s], or frequencies of FRFs [Hz].
    separator : str
        "auto", "tab", "space" or the character itself.
    decimal : str
        "auto", "." or ",".
    skip : int
        Lines before the headings.
    samples : int or None
        Cut every record to this length.
    decay : float
        Decay rate of an exponential window in the records [1/s].
    nodes : Geometry
        Where the nodes are.
    source : str
        Where the layout came from, for messages.
    mat : MatLayout, optional
        Which variable of a MATLAB file is what.
    """

    columns: tuple[Column, ...]
    files: tuple[FileRule, ...] = ()
    rate: float | str | None = None
    time_column: int | str | None = None
    frequency_column: int | str | None = None
    separator: str = "auto"
    decimal: str = "auto"
    skip: int = 0
    samples: int | None = None
    decay: float = 0.0
    nodes: Geometry = field(default_factory=Geometry.empty)
    source: str = "layout"
    mat: MatLayout | None = None

    @property
    def rate_array(self) -> str | None:
        """Which array is the sampling rate, where the layout names one."""
        return self.rate if isinstance(self.rate, str) else None

    @property
    def rate_stated(self) -> float | None:
        """The sampling rate that the layout states [Hz]."""
        return None if isinstance(self.rate, str) else self.rate


def dof_of(node: int, direction: str) -> Dof:
    """Return the degree of freedom of a node and a direction as written, "+z" or "-X".

    Raises
    ------
    InputError
        If the direction is none.
    """
    text = direction.strip().lower()
    code = DIRECTIONS.get(text.lstrip("+-"))
    if code is None or len(text) - len(text.lstrip("+-")) > 1:
        raise InputError(f"direction {direction!r} is invalid; write +x, -x, +y, -y, +z, -z or +rx ... -rz")
    return Dof(int(node), -code if text.startswith("-") else code)


def read_layout(path: Path | str) -> Layout:
    """Read a layout file (TOML); see docs/howto/column_text.md.

    Raises
    ------
    InputError
        If it is not there, is not TOML, or has keys that mean nothing.
    """
    try:
        table = tomllib.loads(Path(path).read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}); give the layout file") from error
    except UnicodeDecodeError as error:
        message = not_utf8(Path(path), Path(path).read_bytes())
        raise InputError(message or f"{path}: not a TOML file but binary data") from error
    except (ValueError, RecursionError) as error:
        raise InputError(f"{path}: not a TOML file: {error}") from error
    return layout_from(table, source=str(path))


def layout_from(table: Mapping[str, Any], *, source: str = "layout") -> Layout:
    """Return the layout that a table (as read from TOML) describes.

    Raises
    ------
    InputError
        If a key is unknown or has a value of the wrong kind.
    """
    if "rate_variable" in table:
        raise InputError(
            f"{source}: the key is rate, not rate_variable; write rate = {table['rate_variable']!r}"
        )
    top = {
        k: v if k == "rate" and _is_name(v) else _in_si(v, UNITS[k], f"{source}: {k}") if k in UNITS else v
        for k, v in table.items()
        if k not in ("column", "file", "nodes", "mat")
    }
    columns = tuple(
        _built(Column, entry, f"{source}: [[column]] {n + 1}")
        for n, entry in enumerate(table.get("column", ()))
    )
    files = tuple(
        _built(FileRule, entry, f"{source}: [[file]] {n + 1}")
        for n, entry in enumerate(table.get("file", ()))
    )
    mat = mat_layout(table["mat"], source) if "mat" in table else None
    parts = {"columns": columns, "files": files, "nodes": _nodes(table.get("nodes", {}), source), "mat": mat}
    layout: Layout = _built(Layout, {**top, **parts, "source": source}, source)
    if not columns and mat is None:
        raise InputError(f"{source}: no [[column]]; add one for the force and one for each response")
    for n, column in enumerate(columns):
        _check_column(column, f"{source}: [[column]] {n + 1}")
    for n, rule in enumerate(files):
        _check_rule(rule, columns, f"{source}: [[file]] {n + 1}")
    if layout.rate_stated is not None and layout.rate_stated <= 0:
        raise InputError(f"{source}: rate = {layout.rate:g}; give the sampling rate in Hz")
    if mat is not None:
        check_axis(mat, layout.rate, source)
    if not 0 <= layout.decay <= FASTEST:
        raise InputError(
            f"{source}: decay = {layout.decay:g}; give the decay rate of the exponential window in 1/s, which is not "
            "negative"
        )
    return layout


def _is_name(value: Any) -> bool:
    """Return whether a text names an array: it does not begin as a quantity does."""
    return isinstance(value, str) and value[:1] not in tuple("+-.0123456789 ")


def _nodes(table: Any, source: str) -> Geometry:
    """Return the geometry of ``[nodes]``: node number = [x, y, z], each in m or with its unit."""
    if not isinstance(table, Mapping):
        raise InputError(f"{source}: nodes = {table!r}; write a table [nodes] with lines 3 = [0.1, 0.0, 0.0]")
    places = []
    for name, given in table.items():
        where = f"{source}: [nodes] {name[:40]}"
        place = [_in_si(c, "m", where) for c in given] if isinstance(given, list) else given
        numbers = isinstance(place, list) and all(type(c) in (int, float) for c in place)
        if (
            not str(name).isdecimal()
            or len(str(name)) > 18
            or not numbers
            or len(place) != 3
            or not np.all(np.isfinite(place))
        ):
            raise InputError(
                f'{where} = {given!r}; give node number = [x, y, z] in m or with units, as 3 = [0.1, 0.0, "80 mm"]'
            )
        places.append(place)
    return Geometry(tuple(int(n) for n in table), np.array(places, dtype=np.float64))


def _in_si(value: Any, unit: str, where: str) -> Any:
    """Return a number that may be written with its unit, as in a study file.

    Raises
    ------
    InputError
        If a text is not a quantity of that kind.
    """
    try:
        return si_value(value, unit)
    except ValueError as error:
        raise InputError(f"{where}: {error}") from None


def _check_column(column: Column, where: str) -> None:
    if (column.index is None) == (column.name is None):
        raise InputError(f"{where}: give either index (from 0) or name (the heading)")
    for key, allowed in (("quantity", tuple(QUANTITIES)), ("part", PARTS)):
        value = getattr(column, key)
        if value not in allowed:
            raise InputError(f"{where}: {key} = {value!r}{_meant(value, allowed)}; use {', '.join(allowed)}")
    try:
        _ = column.dof, column.reference
    except InputError as error:
        raise InputError(f"{where}: {error}") from error


def _check_rule(rule: FileRule, columns: tuple[Column, ...], where: str) -> None:
    """Check that a rule names an existing column, and a direction."""
    known = [c.index if c.name is None else c.name for c in columns]
    if rule.column != "" and rule.column not in known:
        raise InputError(
            f"{where}: there is no [[column]] {rule.column!r}; name one of {', '.join(map(repr, known))}, or leave "
            "column out for the force"
        )
    check_rule(rule, where)
    try:
        dof_of(rule.node or 0, rule.direction or "+z")
    except InputError as error:
        raise InputError(f"{where}: {error}") from error


_KINDS: dict[str, tuple[type, ...]] = {
    "int": (int,),
    "float": (int, float),
    "str": (str,),
    "int | None": (int,),
    "float | None": (int, float),
    "str | None": (str,),
    "float | str | None": (int, float, str),
    "str | int": (int, str),
    "int | str | None": (int, str),
}


def _built(kind: type, entry: Mapping[str, Any], where: str) -> Any:
    known = {f.name: str(f.type) for f in fields(kind)}
    for key, value in entry.items():
        if key not in known:
            names = tuple(k for k in known if k not in ("source", "columns", "files", "mat"))
            raise InputError(f"{where}: unknown key {key!r}{_meant(key, names)}; keys are {', '.join(names)}")
        allowed = _KINDS.get(known[key])
        if allowed and (not isinstance(value, allowed) or isinstance(value, bool)):
            raise InputError(f"{where}: {key} = {value!r} is not of type {known[key].split(' | None')[0]}")
    try:
        return kind(**entry)
    except TypeError as error:
        missing = str(error).split("argument")[-1].lstrip("s: ")
        raise InputError(f"{where}: {missing} is missing") from error


def _meant(word: str, known: tuple[str, ...]) -> str:
    close = difflib.get_close_matches(str(word), known, n=1)
    return f" (is {close[0]!r} meant?)" if close else ""
