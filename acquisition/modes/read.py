"""Modal data from a table or a universal file."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd

from acquisition.columns.blocks import Style
from acquisition.dof import Dof
from acquisition.encoding import not_utf8
from acquisition.errors import InputError, in_one_line
from acquisition.geometry import Geometry
from acquisition.modal_data import ModalData
from acquisition.modes.checks import check_frequencies, checked
from acquisition.modes.columns import HEADINGS, check_headings, column, components, dof, numbers, plain
from acquisition.modes.json_document import read_modes_json
from acquisition.own_readers import Reader, installed_readers, read_by
from acquisition.uff import read_uff

TABLES = (".csv", ".txt")
"""Endings of tables of modes."""
NAMES = {",": "commas", ";": "semicolons", "\t": "tabulators"}
"""What may separate the columns of a table of modes, in this order, and how messages call it."""


def read_modes(path: Path | str) -> ModalData:
    """Read modes from a table (.csv), a result of our own (.json), or data sets 55 and 2414 of a universal file.

    The table has a header row with the columns ``frequency`` [Hz] and ``sigma`` [Hz]; ``damping`` and
    ``damping_sigma`` [-] are optional, or ``damping_percent`` and ``damping_sigma_percent``, as are shape columns
    named by degree of freedom, ``3+Z`` (real part), ``3+Z imag`` and ``3+Z sigma``, and ``scaled``, 1 where the
    shapes are mass-normalised. Rows with ``x``, ``y`` or ``z`` in place of a frequency give the
    coordinates of the shape columns' points [m]. Columns are separated by commas, or by semicolons or tabulators, and
    then numbers may have decimal commas. Lines that begin with # are comments.

    Parameters
    ----------
    path : path
        The file.

    Raises
    ------
    InputError
        If the file cannot be read, a column is missing, or an entry is not a number.
    """
    path = Path(path)
    own = installed_readers().get(path.suffix.lower())
    if own is not None:
        return checked(_of_own(own, path), path)
    if path.suffix.lower() == ".json":
        return checked(read_modes_json(path), path)
    if path.suffix.lower() not in TABLES:
        return _of_universal_file(path)
    table, coordinates = _split(_table(path), path)
    frequency = column(table, "frequency", path)
    if frequency is None:
        raise InputError(
            f"{path}: no column 'frequency' among {', '.join(table.columns)}; begin the table with a header such as "
            "frequency,sigma,damping"
        )
    check_headings(table, path)
    check_frequencies(frequency, path)
    sigma = column(table, "sigma", path)
    dofs = {name: found for name in table.columns if (found := dof(name)) is not None}
    real, imag, errors = (components(table, list(dofs), part, path) for part in ("", "imag", "sigma"))
    if not np.isfinite([*(() if real is None else real), *(() if imag is None else imag)]).all():
        raise InputError(f"{path}: a shape has gaps; fill them or leave the column out")
    signs = np.array([d.sign for d in dofs.values()], dtype=np.float64)
    scaled = column(table, "scaled", path)
    modal = ModalData(
        frequency=frequency,
        frequency_sigma=np.full(len(frequency), np.nan) if sigma is None else sigma,
        damping=column(table, "damping", path),
        damping_sigma=column(table, "damping_sigma", path),
        dofs=tuple(Dof(d.node, abs(d.direction)) for d in dofs.values()),
        shapes=None if real is None else signs[:, None] * (real + 1j * (0.0 if imag is None else imag)),
        shape_sigma=errors,
        scaled=scaled is not None and bool(np.all(scaled == 1)),
        geometry=_geometry(coordinates, dofs, path),
    )
    return checked(modal, path)


def _of_own(reader: Reader, path: Path) -> ModalData:
    found = read_by(reader, path)
    if not isinstance(found, ModalData):
        raise InputError(
            f"{path}: its reader returned {type(found).__name__}, but modes are needed; name it under files"
        )
    return found


def _of_universal_file(path: Path) -> ModalData:
    content = read_uff(path)
    broken = [info for info in content.datasets if not info.ok and info.number in (0, 55, 2414)]
    if broken:
        raise InputError(
            f"{path}: data set at line {broken[0].line}: {broken[0].message}; a mode may be lost, export it again"
        )
    if content.modal is None:
        raise InputError(
            f"{path}: holds no modes; give a table with a column 'frequency' or data sets 55 or 2414"
        )
    return content.modal


def _split(table: pd.DataFrame, path: Path) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Part the modes of a table from the coordinates of its points; these are indexed by x, y, z."""
    heading = next((n for n in table.columns if plain(n) in HEADINGS["frequency"]), None)
    if heading is None:
        return table, table.iloc[:0]
    axis = table[heading].fillna("").str.strip().str.lower()
    there = axis.isin(["x", "y", "z"])
    points = table[there].set_axis(axis[there], axis=0)
    if points.index.has_duplicates:
        raise InputError(
            f"{path}: two rows of {points.index[points.index.duplicated()][0]} coordinates; give one"
        )
    if there.all():
        raise InputError(f"{path}: holds no mode; give one row per mode beside the coordinates")
    others = points[[name for name in table.columns if name != heading and dof(name) is None]]
    filled = others.fillna("").apply(lambda cells: cells.str.strip()) != ""
    if filled.to_numpy().any():
        name = others.columns[filled.any(axis=0).to_numpy()][0]
        raise InputError(
            f"{path}: the row {points.index[filled[name]][0]} of coordinates has an entry in column {name!r}, which "
            "modes have; leave it empty, or give the mode its frequency"
        )
    return table[~there], points


def _geometry(points: pd.DataFrame, dofs: dict[str, Dof], path: Path) -> Geometry:
    """Return the nodes of the shape columns, where their coordinates are given; what is left out of y and z is 0."""
    if points.empty:
        return Geometry.empty()
    places: dict[int, tuple[float, ...]] = {}
    for name, point in dofs.items():
        stated = numbers(points[name], name, path)
        by_axis = dict(zip(points.index, stated.tolist(), strict=True))
        place = tuple(by_axis.get(axis, 0.0) for axis in ("x", "y", "z"))
        if not np.isfinite(place).all():
            raise InputError(f"{path}: column {name!r} lacks a coordinate in the rows x, y, z; give it in m")
        if places.setdefault(point.node, place) != place:
            raise InputError(f"{path}: node {point.node} has two places in the rows x, y, z; give it one")
    return Geometry(tuple(places), np.array(list(places.values()), dtype=np.float64))


def _table(path: Path) -> pd.DataFrame:
    separator = ","
    try:
        separator = _separator(path)
        table = pd.read_csv(path, sep=separator, comment="#", skipinitialspace=True, dtype=str)
    except OSError as error:
        raise InputError(f"{path}: cannot be opened ({error.strerror}); check the path") from None
    except UnicodeDecodeError as error:
        message = (
            not_utf8(path, path.read_bytes())
            or f"{path}: binary data, not a table of modes; give a .csv of text"
        )
        raise InputError(message) from error
    except (ValueError, pd.errors.ParserError) as error:
        reason = in_one_line(error)
        raise InputError(
            f"{path}: is not a table of columns separated by {NAMES[separator]} ({reason})"
        ) from None
    if not table.index.equals(pd.RangeIndex(len(table))):
        raise InputError(f"{path}: lines have more values than the header has names; name every column")
    nameless = [
        name for name in table.columns if str(name).startswith("Unnamed: ") and table[name].isna().all()
    ]
    table = table.drop(columns=nameless)  # a comma ends every line
    table.columns = [str(name).strip() for name in table.columns]
    if table.empty:
        raise InputError(f"{path}: holds no mode; give a header row and one row per mode")
    return table if separator == "," else _with_points(table, path)


def _separator(path: Path) -> str:
    """Return what separates the names of the header: a comma if there is one, else a semicolon or a tabulator."""
    with path.open(encoding="utf-8") as file:
        header = next((line for line in file if line.strip() and not line.startswith("#")), "")
    return next((mark for mark in NAMES if mark in header), ",")


def _with_points(table: pd.DataFrame, path: Path) -> pd.DataFrame:
    """Return a table without commas between its columns with points in its numbers, where it has commas.

    Raises
    ------
    InputError
        If some numbers have a comma and others a point: one of them may part thousands.
    """
    style = Style(None, ",")
    cells = [str(cell).strip().rstrip("% ") for name in table for cell in table[name].dropna()]
    commas = [cell for cell in cells if "," in cell and style.is_number(cell)]
    points = [cell for cell in cells if "." in cell and Style(None, ".").is_number(cell)]
    if commas and points:
        raise InputError(
            f"{path}: {points[0]!r} has a decimal point and {commas[0]!r} a decimal comma; write all numbers alike"
        )
    return table.apply(lambda cells: cells.str.replace(",", ".", regex=False)) if commas else table
