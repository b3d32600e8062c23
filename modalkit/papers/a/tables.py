"""Tables 1-4 of paper A."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd

from modalkit.papers.a.chain import Walk, Walked, sample_folder, walk_all
from modalkit.papers.a.printed import COLUMN_FACTOR, Column, Printed, PrintedTable
from modalkit.papers.render import PaperTable


def tables_a(walks: Sequence[Walk] | None = None) -> list[PaperTable]:
    """Work out paper A's tables from the sample tests.

    Parameters
    ----------
    walks : sequence of Walk, optional
        The tests, worked out before; left out, those of the samples that come with the package.
    """
    return [_table(one) for one in (walk_all(sample_folder()) if walks is None else walks)]


def _table(one: Walk) -> PaperTable:
    table, both = one.table, list(zip(one.table.models, one.models, strict=True))
    rows = pd.concat([_rows(table, p, w) for p, w in both], ignore_index=True)
    factors = pd.concat([_factors(table, p, w) for p, w in both], ignore_index=True)
    return PaperTable("A", table.number, table.title, rows, factors, table.notes)


def _rows(table: PrintedTable, printed: Printed, walked: Walked) -> pd.DataFrame:
    test, before, after = (walked.pairs[n].to_numpy() for n in ("test_hz", "before_hz", "after_hz"))
    updated = np.array([f is not None for f in printed.after])
    columns: dict[str, object] = {
        "model": printed.program,
        "mode": table.modes,
        "test [Hz]": table.test,
        "test, ours": walked.identified,
        "before [Hz]": _numbers(printed.before),
        "before, ours": before,
        "error before [%]": _numbers(printed.before_error),
        "error before, ours": 100 * (before / test - 1),
        "after [Hz]": _numbers(printed.after),
        "after, ours": np.where(updated, after, np.nan),
        "error after [%]": _numbers(printed.after_error),
        "error after, ours": np.where(updated, 100 * (after / test - 1), np.nan),
    }
    if table.number in COLUMN_FACTOR:
        given = COLUMN_FACTOR[table.number]
        columns[f"after at {given}, ours"] = np.where(updated, before / np.sqrt(given), np.nan)
    if printed.mac:
        columns["MAC [%]"] = _numbers(printed.mac)
        columns["MAC, ours"] = 100 * walked.pairs["mac"].to_numpy()
    columns["erratum"] = [
        _note(printed, mode, row) for mode, row in zip(table.modes, _partners(walked), strict=True)
    ]
    return pd.DataFrame(columns)


def _partners(walked: Walked) -> list[tuple[int, int]]:
    """Return, for each row, its place in the order of the test and its partner in the model."""
    partners = walked.pairs["model_mode"].tolist()
    return [(i + 1, int(p)) for i, p in enumerate(partners)]


def _note(printed: Printed, mode: int, row: tuple[int, int]) -> str:
    """Return the erratum of a row, and say where our pairing is another."""
    place, partner = row
    parts = [printed.errata[mode]] if mode in printed.errata else []
    if place != partner:
        parts.append(f"ours is paired by MAC with FE mode {partner}")
    return "; ".join(parts)


def _factors(table: PrintedTable, printed: Printed, walked: Walked) -> pd.DataFrame:
    ours = walked.result.parameters[0]
    power = (
        2 if table.parameter == "E" else -2
    )  # frequencies go with the root of E, and against that of density
    before, after = (_numbers(column) for column in (printed.before, printed.after))
    columns = {
        "model": [printed.program],
        "parameter": [table.parameter],
        "factor": [printed.factor],
        "factor, ours": [ours.factor],
        "factor of the printed column": [float(np.nanmean((after / before) ** power))],
        "r.m.s. error before, ours [%]": [walked.result.rms_percent("before")],
        "r.m.s. error after, ours [%]": [walked.result.rms_percent("after")],
    }
    return pd.DataFrame(columns)


def _numbers(column: Column) -> np.ndarray:
    return np.array([np.nan if v is None else v for v in column])
