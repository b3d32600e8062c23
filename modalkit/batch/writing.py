"""Write the tables of a batch as Parquet or CSV, all of them or none."""

from __future__ import annotations

import importlib.util
import tempfile
from collections.abc import Mapping
from pathlib import Path

import pandas as pd

from acquisition.errors import InputError
from modalkit.batch.tables import COLUMNS
from modalkit.output.destinations import Kind, check_output, table_of

FORMATS = (".csv", ".parquet")


def table_places(path: Path) -> list[tuple[Path, Kind]]:
    """Return where the tables of a batch go, and their kinds.

    Parameters
    ----------
    path : Path
        The main table; the others stand beside it.

    Raises
    ------
    InputError
        If the ending is not that of a table, or the extra for it is missing.
    """
    if path.suffix.lower() not in FORMATS:
        raise InputError(f"{path}: a table ends in {' or '.join(FORMATS)}")
    if path.suffix.lower() == ".parquet" and importlib.util.find_spec("pyarrow") is None:
        raise InputError(
            f"{path}: Parquet needs an extra: pip install 'modalkit-ema[parquet]'; .csv needs none"
        )
    return [(place_of(path, name), _kind(path, name)) for name in COLUMNS]


def _kind(path: Path, name: str) -> Kind:
    return table_of(list(COLUMNS[name]), path.suffix, name or "table")


def place_of(path: Path, name: str) -> Path:
    """Return where a table of a batch goes: ``TABLE.csv``, ``TABLE_modes.csv``."""
    return path.with_name(f"{path.stem}_{name}{path.suffix}") if name else path


def write_tables(path: Path, tables: Mapping[str, pd.DataFrame]) -> list[Path]:
    """Write the tables; what stood there before stays until all are complete.

    Parameters
    ----------
    path : Path
        The main table; the others stand beside it.
    tables : mapping
        As :func:`modalkit.batch.tables` returns them.

    Returns
    -------
    list of Path
        What was written; a table without rows is not, and an older one in its place is removed.

    Raises
    ------
    InputError
        If they cannot be written, or something else than such a table stands in the place of one.
    """
    for name in tables:
        check_output(place_of(path, name), _kind(path, name))
    written = []
    try:
        with tempfile.TemporaryDirectory(dir=path.parent, prefix=f".{path.name}.") as folder:
            ready = [(Path(folder) / place_of(path, name).name, name) for name in tables]
            for draft, name in ready:
                _write(draft, tables[name])
            for draft, name in ready:
                place = place_of(path, name)
                if len(tables[name]) or not name:
                    draft.replace(place)
                    written.append(place)
                else:
                    place.unlink(missing_ok=True)
    except OSError as error:
        raise InputError(f"{path}: cannot be written ({error.strerror or error})") from error
    return written


def _write(path: Path, table: pd.DataFrame) -> None:
    if path.suffix.lower() == ".csv":
        table.to_csv(path, index=False)
    else:
        table.to_parquet(path, index=False, engine="pyarrow")
