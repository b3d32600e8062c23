"""Modal data from a table or a universal file."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd

from acquisition.arrays import FloatArray
from acquisition.dof import Dof
from acquisition.errors import InputError
from acquisition.geometry import Geometry
from acquisition.modal_columns import HEADINGS, check_headings, column, dof, numbers, plain
from acquisition.modal_data import ModalData
from acquisition.uff import read_uff

HIGHEST = 1e12
"""Above the frequency of anything that vibrates as a whole [Hz]."""

LARGEST = 1e50
"""Components of shapes whose powers are still numbers [-]."""


def read_modes(path: Path | str) -> ModalData:
    """Read modes from a table (.csv) or from data sets 55 and 2414 of a universal file.

    The table has a header row with the columns ``frequency`` [Hz] and ``sigma`` [Hz]; ``damping`` and
    ``damping_sigma`` [-] are optional, or ``damping_percent`` and ``damping_sigma_percent``, as are shape columns
    named by degree of freedom, ``3+Z`` (real), and their standard deviations, ``sigma 3+Z``. Rows with ``x``, ``y``
    or ``z`` in place of a frequency give the coordinates of the shape columns' points [m]. Lines that begin with #
    are comments.

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
    table, coordinates = _split(_table(path), path)
    check_headings(table, path)
    frequency = column(table, "frequency", path)
    if frequency is None:
        raise InputError(f"{path}: no column 'frequency' among {', '.join(table.columns)}; name the columns")
    if not np.all((frequency > 0) & (frequency < HIGHEST)):
        raise InputError(
            f"{path}: a frequency is missing, not positive or beyond {HIGHEST:g} Hz; give every mode its own in Hz"
        )
    sigma = column(table, "sigma", path)
    if sigma is not None and np.any((sigma < 0) | (sigma >= frequency)):
        wrong = int(np.flatnonzero((sigma < 0) | (sigma >= frequency))[0])
        raise InputError(
            f"{path}: sigma {sigma[wrong]:g} Hz of the mode at {frequency[wrong]:g} Hz is negative or larger than the "
            "frequency; give its standard deviation in Hz, or leave it empty"
        )
    dofs = {name: found for name in table.columns if (found := dof(name)) is not None}
    shapes = [numbers(table[name], name, path) for name in dofs]
    if shapes and not np.isfinite(shapes).all():
        raise InputError(f"{path}: a shape has gaps; fill them or leave the column out")
    if shapes and np.abs(shapes).max() > LARGEST:
        raise InputError(
            f"{path}: a shape reaches {np.abs(shapes).max():g}; scale it to numbers below {LARGEST:g}"
        )
    damping = _ratios(column(table, "damping", path), path)
    _once(path, frequency, damping, shapes)
    signs = np.array([d.sign for d in dofs.values()], dtype=np.float64)
    return ModalData(
        frequency=frequency,
        frequency_sigma=np.full(len(frequency), np.nan) if sigma is None else sigma,
        damping=damping,
        damping_sigma=column(table, "damping_sigma", path),
        dofs=tuple(Dof(d.node, abs(d.direction)) for d in dofs.values()),
        shapes=np.array(shapes, dtype=np.complex128) * signs[:, None] if shapes else None,
        shape_sigma=_shape_sigma(table, list(dofs), path),
        geometry=_geometry(coordinates, dofs, path),
    )


def _shape_sigma(table: pd.DataFrame, names: list[str], path: Path) -> FloatArray | None:
    """Return the standard deviations of the shapes; None where there are no such columns."""
    every = [name for name in map(str, table.columns) if name.lower().startswith("sigma ")]
    columns = {name.lower().removeprefix("sigma").strip(): name for name in every}
    given = [columns.get(name.lower()) for name in names]
    if not any(given):
        return None
    missing = [name for name, found in zip(names, given, strict=True) if found is None]
    if missing:
        raise InputError(
            f"{path}: no column 'sigma {missing[0]}' and others of its kind; give one per shape column"
        )
    sigma = np.array([numbers(table[found], str(found), path) for found in given])
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
    return table[~there], points


def _geometry(points: pd.DataFrame, dofs: dict[str, Dof], path: Path) -> Geometry:
    """Return the nodes of the shape columns, where their coordinates are given; what is left out of y and z is 0."""
    if points.empty:
        return Geometry.empty()
    places: dict[int, tuple[float, ...]] = {}
    for name, point in dofs.items():
        told = numbers(points[name], name, path)
        by_axis = dict(zip(points.index, told.tolist(), strict=True))
        place = tuple(by_axis.get(axis, 0.0) for axis in ("x", "y", "z"))
        if not np.isfinite(place).all():
            raise InputError(f"{path}: column {name!r} lacks a coordinate in the rows x, y, z; give it in m")
        if places.setdefault(point.node, place) != place:
            raise InputError(f"{path}: node {point.node} has two places in the rows x, y, z; give it one")
    return Geometry(tuple(places), np.array(list(places.values()), dtype=np.float64))


def _ratios(damping: FloatArray | None, path: Path) -> FloatArray | None:
    """See that damping ratios are those of something that vibrates."""
    if damping is None:
        return None
    wrong = np.flatnonzero((damping < 0) | (damping >= 1))
    if len(wrong):
        worst = float(damping[wrong[0]])
        advice = (
            "give it a value, or leave it empty"
            if worst < 0
            else "if it is in %, name the column damping_percent"
        )
        raise InputError(
            f"{path}: damping ratio {worst:g} of mode {wrong[0] + 1}: it lies from 0 to 1; {advice}"
        )
    return damping


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
