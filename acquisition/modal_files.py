"""Modal data from a table or a universal file."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pandas as pd

from acquisition.arrays import FloatArray
from acquisition.dof import Dof
from acquisition.errors import InputError
from acquisition.modal_data import ModalData
from acquisition.modal_json import read_modes_json
from acquisition.uff import read_uff

_SHAPE = re.compile(r"(\d+)([+-])(R?[XYZ])(?: (imag|sigma))?$", re.IGNORECASE)
TABLES = (".csv", ".txt")
"""Endings of tables of modes."""
_AXES = ("X", "Y", "Z", "RX", "RY", "RZ")
_COLUMNS = {
    "frequency": ("frequency", "frequency_hz", "frequency [hz]", "f"),
    "sigma": ("sigma", "frequency_sigma", "frequency_sigma_hz", "sigma [hz]"),
    "damping": ("damping", "damping_ratio", "zeta"),
    "damping_sigma": ("damping_sigma",),
    "scaled": ("scaled",),
}


def read_modes(path: Path | str) -> ModalData:
    """Read modes from a table (.csv), a result of our own (.json), or data sets 55 and 2414 of a universal file.

    The table has a header row with the columns ``frequency`` [Hz] and ``sigma`` [Hz]; ``damping`` and
    ``damping_sigma`` [-] are optional, as are shape columns named by degree of freedom: ``3+Z`` (real part),
    ``3+Z imag``, ``3+Z sigma``, and ``scaled``, 1 where the shapes are mass-normalised. Lines that begin with # are
    comments.

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
    if path.suffix.lower() == ".json":
        return read_modes_json(path)
    if path.suffix.lower() not in TABLES:
        modal = read_uff(path).modal
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
    sigma = _column(table, "sigma", path)
    dofs = {name: dof for name in table.columns if (dof := _dof(name)) is not None}
    signs = np.array([dof.sign for dof in dofs.values()], dtype=np.float64)
    real = _components(table, list(dofs), "", path)
    imag, errors = (_components(table, list(dofs), part, path) for part in ("imag", "sigma"))
    if not np.isfinite([*(() if real is None else real), *(() if imag is None else imag)]).all():
        raise InputError(f"{path}: a shape has gaps; fill them or leave the column out")
    scaled = _column(table, "scaled", path)
    return ModalData(
        frequency=frequency,
        frequency_sigma=np.full(len(frequency), np.nan) if sigma is None else sigma,
        damping=_column(table, "damping", path),
        damping_sigma=_column(table, "damping_sigma", path),
        dofs=tuple(Dof(dof.node, abs(dof.direction)) for dof in dofs.values()),
        shapes=None if real is None else signs[:, None] * (real + 1j * (0.0 if imag is None else imag)),
        shape_sigma=errors,
        scaled=scaled is not None and bool(np.all(scaled == 1)),
    )


def _components(table: pd.DataFrame, dofs: list[str], part: str, path: Path) -> FloatArray | None:
    """Return one part of all shapes, shape (n_dofs, n_modes); None if no degree of freedom has it.

    Raises
    ------
    InputError
        If some have it and others have not, or it belongs to none.
    """
    names = [
        name for name in table.columns if (found := _SHAPE.match(name)) and (found[4] or "").lower() == part
    ]
    wanted = [f"{dof} {part}".strip() for dof in dofs]
    if names and sorted(names) != sorted(wanted):
        odd = sorted(set(names).symmetric_difference(wanted))[0]
        raise InputError(f"{path}: column {odd!r} stands without its like; give every shape column its own")
    return np.array([_numbers(table[name], name, path) for name in wanted]) if names else None


def _table(path: Path) -> pd.DataFrame:
    try:
        table = pd.read_csv(path, comment="#", skipinitialspace=True, dtype=str)
    except OSError as error:
        raise InputError(f"{path}: cannot be opened ({error.strerror}); check the path") from None
    except (ValueError, pd.errors.ParserError) as error:
        raise InputError(f"{path}: is no table of comma-separated columns ({error})") from None
    table.columns = [str(name).strip() for name in table.columns]
    if table.empty:
        raise InputError(f"{path}: holds no mode; give a header row and one row per mode")
    return table


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
    if found is None or found[4]:
        return None
    direction = _AXES.index(found[3].upper()) + 1
    return Dof(int(found[1]), -direction if found[2] == "-" else direction)
