"""A table of words, and how one is made."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import pandas as pd

from modalkit.blind.scoring.wording import count_text, share_text


@dataclass(frozen=True, eq=False)
class Section:
    """A table of words.

    Parameters
    ----------
    title, note : str
        What it shows, and how to read it.
    table : pandas.DataFrame
        Strings; the first column names the row.
    """

    title: str
    note: str
    table: pd.DataFrame


def words(rows: Iterable[dict[str, Any]]) -> pd.DataFrame:
    """Return rows as a table of strings."""
    return pd.DataFrame(list(rows)).astype(str)


def share_rows(name: str, table: pd.DataFrame) -> list[dict[str, Any]]:
    """Return label, share with interval and count of every row of which something was asked."""
    return [
        {name: str(label), "share (95 %)": share_text(row), "count": count_text(row)}
        for label, row in table.iterrows()
        if row["total"]
    ]
