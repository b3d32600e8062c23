"""Modal data from a table or a universal file."""

from __future__ import annotations

import difflib
import re
from pathlib import Path

import numpy as np
import pandas as pd

from acquisition.arrays import FloatArray
from acquisition.dof import Dof
from acquisition.errors import InputError
from acquisition.modal_data import ModalData
from acquisition.uff import read_uff

_SHAPE = re.compile(r"(\d{1,18})([+-])(R?[XYZ])$", re.IGNORECASE)
_PASSED = ("mode", "no", "nr", "number", "name", "note", "comment", "description", "remark")
_NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
_AXES = ("X", "Y", "Z", "RX", "RY", "RZ")
_COLUMNS = {
    "frequency": ("frequency", "frequency_hz", "frequency [hz]", "f"),
    "sigma": ("sigma", "frequency_sigma", "frequency_sigma_hz", "sigma [hz]"),
    "damping": ("damping", "damping_ratio", "zeta"),
    "damping_sigma": ("damping_sigma",),
}


def read_modes(path: Path | str) -> ModalData:
    """Read modes from a table (.csv) or from data sets 55 and 2414 of a universal file.

    The table has a header row with the columns ``frequency`` [Hz] and ``sigma`` [Hz]; ``damping`` and
    ``damping_sigma`` [-] are optional, as are shape columns named by degree of freedom, ``3+Z`` (real), and their
    standard deviations, ``sigma 3+Z``. Lines that begin with # are comments.

    Parameters
    ----------
    path : path
        The file.

    Raises
    ------
    InputError
        If the file cannot be read, a column is missing, or an entry is no number.
    """
    path = Path(path)
    if path.suffix.lower() not in (".csv", ".txt"):
        content = read_uff(path)
        modal = content.modal
        broken = [info for info in content.datasets if not info.ok and info.number in (0, 55, 2414)]
        if broken:
            raise InputError(
                f"{path}: data set at line {broken[0].line}: {broken[0].message}; a mode may be lost, export it again"
            )
        if modal is None:
            raise InputError(
                f"{path}: holds no modes; give a table with a column 'frequency' or data sets 55 or 2414"
            )
        return modal
    table = _table(path)
    frequency = _column(table, "frequency", path)
    if frequency is None:
        raise InputError(f"{path}: no column 'frequency' among {', '.join(table.columns)}; name the columns")
    if not np.all(frequency > 0):
        raise InputError(
            f"{path}: a frequency is missing or not positive; give every mode its frequency in Hz"
        )
    _check_names(table, path)
    sigma = _column(table, "sigma", path)
    dofs = {name: dof for name in table.columns if (dof := _dof(name)) is not None}
    shapes = [_numbers(table[name], name, path) for name in dofs]
    if shapes and not np.isfinite(shapes).all():
        raise InputError(f"{path}: a shape has gaps; fill them or leave the column out")
    _once(path, frequency, _column(table, "damping", path), shapes)
    signs = np.array([dof.sign for dof in dofs.values()], dtype=np.float64)
    return ModalData(
        frequency=frequency,
        frequency_sigma=np.full(len(frequency), np.nan) if sigma is None else sigma,
        damping=_column(table, "damping", path),
        damping_sigma=_column(table, "damping_sigma", path),
        dofs=tuple(Dof(dof.node, abs(dof.direction)) for dof in dofs.values()),
        shapes=np.array(shapes, dtype=np.complex128) * signs[:, None] if shapes else None,
        shape_sigma=_shape_sigma(table, list(dofs), path),
    )


def _shape_sigma(table: pd.DataFrame, names: list[str], path: Path) -> FloatArray | None:
    """Return the standard deviations of the shapes; None where there are no such columns."""
    every = [name for name in map(str, table.columns) if name.lower().startswith("sigma ")]
    columns = {name.lower().removeprefix("sigma").strip(): name for name in every}
    given = [columns.get(name.lower()) for name in names]
    if not any(given):
        return None
    missing = [name for name, column in zip(names, given, strict=True) if column is None]
    if missing:
        raise InputError(
            f"{path}: no column 'sigma {missing[0]}' and others of its kind; give one per shape column"
        )
    sigma = np.array([_numbers(table[column], str(column), path) for column in given])
    if not (np.isfinite(sigma).all() and np.all(sigma >= 0)):
        raise InputError(f"{path}: a standard deviation of a shape is missing or below zero")
    return sigma


def _once(path: Path, frequency: FloatArray, damping: FloatArray | None, shapes: list[FloatArray]) -> None:
    """Check that no mode stands twice; without damping and shapes two of one frequency may be two."""
    columns = [frequency, *([] if damping is None else [damping]), *shapes]
    if len(columns) == 1:
        return
    first: dict[tuple[float, ...], int] = {}
    for number, mode in enumerate(zip(*columns, strict=True), start=1):
        if np.isfinite(mode).all() and first.setdefault(mode, number) != number:
            raise InputError(f"{path}: modes {first[mode]} and {number} are the same mode; leave one out")


def _table(path: Path) -> pd.DataFrame:
    try:
        table = pd.read_csv(path, comment="#", skipinitialspace=True, dtype=str)
    except OSError as error:
        raise InputError(f"{path}: cannot be opened ({error.strerror}); check the path") from None
    except (ValueError, pd.errors.ParserError) as error:
        said = " ".join(str(error).split())
        raise InputError(f"{path}: is no table of comma-separated columns ({said})") from None
    if not table.index.equals(pd.RangeIndex(len(table))):
        raise InputError(f"{path}: lines have more values than the header has names; name every column")
    table.columns = [str(name).strip() for name in table.columns]
    if table.empty:
        raise InputError(f"{path}: holds no mode; give a header row and one row per mode")
    return table


def _check_names(table: pd.DataFrame, path: Path) -> None:
    """Refuse a column of a name that means nothing here: what it holds would be lost without a word."""
    known = [*(name for names in _COLUMNS.values() for name in names), *_PASSED]
    for name in table.columns:
        if name.lower() in known or _SHAPE.match(name.lower().removeprefix("sigma").strip()):
            continue
        close = difflib.get_close_matches(name.lower()[:40], known, n=1)
        meant = f", is {close[0]!r} meant" if close else ""
        raise InputError(
            f"{path}: column {name[:40]!r} is none known here{meant}; known are frequency, sigma, damping, "
            "damping_sigma and degrees of freedom as 3+Z: rename it or leave it out"
        )


def _column(table: pd.DataFrame, name: str, path: Path) -> FloatArray | None:
    for column in table.columns:
        if str(column).lower() in _COLUMNS[name]:
            return _numbers(table[column], str(column), path)
    return None


def _numbers(column: pd.Series[str], name: str, path: Path) -> FloatArray:
    words = column.fillna("").str.strip()
    missing = words.str.lower().isin(["nan", ""])
    wrong = words[~missing & ~words.str.fullmatch(_NUMBER)]
    if len(wrong):
        raise InputError(
            f"{path}: {wrong.iloc[0][:40]!r} in column {name!r} is no number (use decimal points)"
        )
    numbers = np.asarray(words.where(~missing, "nan"), dtype=np.float64)
    if np.isinf(numbers).any():
        raise InputError(f"{path}: a number in column {name!r} is beyond all bounds; correct it")
    return numbers


def _dof(name: str) -> Dof | None:
    found = _SHAPE.match(str(name))
    if found is None:
        return None
    direction = _AXES.index(found[3].upper()) + 1
    return Dof(int(found[1]), -direction if found[2] == "-" else direction)
