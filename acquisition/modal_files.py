"""Modal data from a table or a universal file."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pandas as pd

from acquisition.arrays import FloatArray
from acquisition.dof import Dof
from acquisition.encoding import not_utf8
from acquisition.errors import InputError
from acquisition.modal_data import ModalData
from acquisition.uff import read_uff

_SHAPE = re.compile(r"(\d+)([+-])(R?[XYZ])$", re.IGNORECASE)
_AXES = ("X", "Y", "Z", "RX", "RY", "RZ")
_COLUMNS = {
    "frequency": ("frequency", "frequency_hz", "frequency [hz]", "f"),
    "sigma": ("sigma", "frequency_sigma", "frequency_sigma_hz", "sigma [hz]"),
    "damping": ("damping", "damping_ratio", "zeta"),
    "damping_sigma": ("damping_sigma",),
}
_SEPARATORS = {";": "semicolons", "\t": "tabulators"}


def read_modes(path: Path | str) -> ModalData:
    """Read modes from a table (.csv) or from data sets 55 and 2414 of a universal file.

    The table has a header row with the columns ``frequency`` [Hz] and ``sigma`` [Hz]; ``damping`` and
    ``damping_sigma`` [-] are optional, as are shape columns named by degree of freedom, ``3+Z`` (real). Lines
    that begin with # are comments.

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
        modal = read_uff(path).modal
        if modal is None:
            raise InputError(
                f"{path}: holds no modes; give a table with a column 'frequency' or data sets 55 or 2414"
            )
        return modal
    table = _table(path)
    frequency = _column(table, "frequency", path)
    if frequency is None:
        raise InputError(_no_frequency(path, [str(name) for name in table.columns]))
    if not np.all(frequency > 0):
        raise InputError(
            f"{path}: a frequency is missing or not positive; give every mode its frequency in Hz"
        )
    sigma = _column(table, "sigma", path)
    dofs = {name: dof for name in table.columns if (dof := _dof(name)) is not None}
    shapes = [_numbers(table[name], name, path) for name in dofs]
    if shapes and not np.isfinite(shapes).all():
        raise InputError(f"{path}: a shape has gaps; fill them or leave the column out")
    signs = np.array([dof.sign for dof in dofs.values()], dtype=np.float64)
    return ModalData(
        frequency=frequency,
        frequency_sigma=np.full(len(frequency), np.nan) if sigma is None else sigma,
        damping=_column(table, "damping", path),
        damping_sigma=_column(table, "damping_sigma", path),
        dofs=tuple(Dof(dof.node, abs(dof.direction)) for dof in dofs.values()),
        shapes=np.array(shapes, dtype=np.complex128) * signs[:, None] if shapes else None,
    )


def _table(path: Path) -> pd.DataFrame:
    try:
        table = pd.read_csv(path, comment="#", skipinitialspace=True, dtype=str)
    except OSError as error:
        raise InputError(f"{path}: cannot be opened ({error.strerror}); check the path") from None
    except UnicodeDecodeError as error:
        said = (
            not_utf8(path, path.read_bytes())
            or f"{path}: binary data, no table of modes; give a .csv of text"
        )
        raise InputError(said) from error
    except (ValueError, pd.errors.ParserError) as error:
        raise InputError(f"{path}: is no table of comma-separated columns ({error})") from None
    table.columns = [str(name).strip() for name in table.columns]
    if table.empty:
        raise InputError(f"{path}: holds no mode; give a header row and one row per mode")
    return table


def _no_frequency(path: Path, names: list[str]) -> str:
    """Return what is wrong with a header without frequencies, and what to type."""
    for mark, word in _SEPARATORS.items():
        if len(names) == 1 and mark in names[0]:
            header = ",".join(part.strip() for part in names[0].split(mark))
            return (
                f"{path}: its columns are separated by {word}, a table of modes has commas, and points in its "
                f"numbers: write the header as {header}, and the rows likewise"
            )
    return (
        f"{path}: no column 'frequency' among {', '.join(names)}; begin the table with a header such as "
        "frequency,sigma,damping"
    )


def _column(table: pd.DataFrame, name: str, path: Path) -> FloatArray | None:
    for column in table.columns:
        if str(column).lower() in _COLUMNS[name]:
            return _numbers(table[column], str(column), path)
    return None


def _numbers(column: pd.Series[str], name: str, path: Path) -> FloatArray:
    numbers = pd.to_numeric(column, errors="coerce")
    wrong = column[numbers.isna() & column.notna() & ~column.str.strip().str.lower().isin(["nan", ""])]
    if len(wrong):
        raise InputError(f"{path}: {wrong.iloc[0]!r} in column {name!r} is no number (use decimal points)")
    return np.asarray(numbers, dtype=np.float64)


def _dof(name: str) -> Dof | None:
    found = _SHAPE.match(str(name))
    if found is None:
        return None
    direction = _AXES.index(found[3].upper()) + 1
    return Dof(int(found[1]), -direction if found[2] == "-" else direction)
